/* simd_probe.h - every word of formats/base/simd.h, as the ISA's compiler and CPU understand it,
 * and as it is meant.
 */
#ifndef TESTS_SUPPORT_SIMD_PROBE_H
#define TESTS_SUPPORT_SIMD_PROBE_H

#include <stdint.h>

#include "formats/base/cpu.h"

enum { SIMD_PROBE_D = 8, SIMD_PROBE_F = 16 }; /* the widest vectors */

typedef struct simd_probe_input {
    double a[SIMD_PROBE_F], b[SIMD_PROBE_F];
    float x[SIMD_PROBE_F], y[SIMD_PROBE_F];
    unsigned p, q; /* masks */
    uint64_t keep; /* bits */
} simd_probe_input;

enum {
    PROBE_ADD,
    PROBE_SUB,
    PROBE_MUL,
    PROBE_DIV,
    PROBE_MIN,
    PROBE_MAX,
    PROBE_SQRT,
    PROBE_ABS,
    PROBE_SELECT,
    PROBE_SET,
    PROBE_BITS,
    PROBE_CONVERT,
    PROBE_NARROW,
    PROBE_FLOOR,
    PROBE_CEIL,
    PROBE_INT,
    PROBE_ANY,      /* i_any() of one bit or none: lane i has bit i of p, twice as far up */
    PROBE_STREAM,   /* x, past the caches */
    PROBE_TRIPLE_X, /* f_load_triples() from x, at the bits of p */
    PROBE_TRIPLE_Y,
    PROBE_TRIPLE_Z,
    PROBE_FOUR_X, /* f_load_fours() from x, 4 apart, at the bits of p */
    PROBE_FOUR_Y,
    PROBE_FOUR_Z,
    PROBE_FOUR_W,
    PROBE_FOUR_TABLE, /* f_look_up() in x, at two bits of p */
    PROBE_GATHER,     /* d_gather() from a, one behind the bits of p */
    PROBE_BYTES,      /* l_gather() from a, so many bytes on */
    PROBE_REVERSE,    /* of a */
    PROBE_LOW,        /* d_of_low_floats() of the bits of a */
    PROBE_PRODUCT,    /* l_mul() of the bits of a and b */
    PROBE_TABLE,      /* d_look_up() in a, then b, at five bits of p */
    PROBE_HALF,       /* d_look_up_half() in a, at four bits of p */
    PROBE_SHORTS,     /* l_of_shorts() of p, lane i so far up */
    PROBE_PACK,       /* a by d_pack() where q has bits, then 1 */
    PROBE_PACK_INT,   /* p, lane i so far up, by i_pack() where q has bits, then 1 */
    PROBE_GATHER_INT, /* i_gather() from x, seven bytes apart, at the bits of p */
    PROBE_SIXTEEN,    /* i_look_up_16() in the upper half of keep, so far up, at four bits of p */
    PROBE_OF_INTS,    /* f_of_ints() of that, lane i so far up */
    PROBE_WORDS
};
enum {
    PROBE_LT,
    PROBE_LE,
    PROBE_EQ,
    PROBE_GE,
    PROBE_GT,
    PROBE_AND,
    PROBE_OR,
    PROBE_XOR,
    PROBE_AND_NOT,
    PROBE_OF_BITS,
    PROBE_SAME, /* l_eq() of the bits of a and b */
    PROBE_ODD,  /* l_odd() of the bits of a */
    PROBE_MASKS
};

/* What a word says of each lane; 0 where there is no such word for doubles, or for floats. */
typedef struct simd_probe_output {
    double d[PROBE_WORDS][SIMD_PROBE_D];
    _Alignas(64) float f[PROBE_WORDS][SIMD_PROBE_F];
    float reciprocal[SIMD_PROBE_F]; /* f_reciprocal(x) */
    uint32_t d_mask[PROBE_MASKS], f_mask[PROBE_MASKS];
    int doubles, floats; /* how many lanes */
} simd_probe_output;

/* simd_probe_run() - by vectors; *out is all 0 before. isa: not CPU_SCALAR, and this CPU's. */
void simd_probe_run(cpu_isa isa, const simd_probe_input *in, simd_probe_output *out);

/* simd_probe_meant() - one lane after the other, without reciprocals. */
void simd_probe_meant(const simd_probe_input *in, int doubles, int floats, simd_probe_output *out);

#endif
