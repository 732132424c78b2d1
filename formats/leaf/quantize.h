/* quantize.h - min/max ranges as 8-bit codes relative to their treelet's own exact range (M08
 * 4.3.2.4).
 *
 * One monotone function g maps [lo, hi] onto [0, 255]; a range is stored as floor(g(min)),
 * ceil(g(max)). Writer, reader and renderer all use these functions, so that rounding can lose no
 * surface: a block whose samples have min < beyond && reach <= max passes quantize_holds() with the
 * limits for reach and beyond. For an isovalue both are that value. Bit-reproducible: only - * /
 * and comparisons in double.
 */
#ifndef FORMATS_LEAF_QUANTIZE_H
#define FORMATS_LEAF_QUANTIZE_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/sample.h"

typedef struct quantizer {
    double lo, hi; /* the treelet's own range; lo > hi: no finite sample */
    double scale;  /* codes per unit of value; 0 when lo == hi */
    bool exact;    /* integers with hi - lo <= 255: codes are value - lo, without loss */
} quantizer;

/* Limits for a node's codes. It may hold the interval only if its lo code <= below and its hi code
 * >= above. */
typedef struct quantized_limits {
    int below, above; /* no node qualifies: below = -1 */
} quantized_limits;

static inline quantizer quantizer_of(float lo, float hi, sample_type type) {
    quantizer q = {.lo = (double)lo, .hi = (double)hi};
    q.exact = type != SAMPLE_F32 && q.hi - q.lo <= 255.0 && q.hi >= q.lo;
    q.scale = q.hi > q.lo ? (q.exact ? 1.0 : 255.0 / (q.hi - q.lo)) : 0.0;
    return q;
}

/* The function g: monotone, 0 at lo, within [0, 255]. */
static inline double quantizer_map(const quantizer *q, double value) {
    const double g = (value - q->lo) * q->scale, up = 0.0 > g ? 0.0 : g;
    return 255.0 < up ? 255.0 : up;
}

static inline uint8_t quantizer_floor(const quantizer *q, double value) {
    return (uint8_t)(int)quantizer_map(q, value);
}

static inline uint8_t quantizer_ceil(const quantizer *q, double value) {
    return (uint8_t)(int)ceil(quantizer_map(q, value));
}

/* quantizer_limits() - the limits for ranges with min < beyond && reach <= max; call it once per
 * treelet and interval. With exact codes the strict side stays strict. An integer compares with a
 * limit as it does with the limit's ceiling. The ceiling's difference to lo is exact, where the
 * limit's may round (lo = -100, reach = 1e-20). */
static inline quantized_limits quantizer_limits(const quantizer *q, double reach, double beyond) {
    quantized_limits c = {-1, 256};
    if (!(q->lo < beyond && reach <= q->hi))
        return c;
    reach = reach > q->lo ? reach : q->lo;
    if (q->exact)
        beyond = ceil(beyond) - 1.0; /* the last integer before it */
    beyond = beyond < q->hi ? beyond : q->hi;
    c.above = quantizer_ceil(q, q->exact ? ceil(reach) : reach);
    c.below = quantizer_floor(q, beyond);
    return c;
}

/* quantizer_iso() - the limits for ranges that hold an isovalue: min < iso && iso <= max. */
static inline quantized_limits quantizer_iso(const quantizer *q, double iso) {
    return quantizer_limits(q, iso, iso);
}

static inline bool quantize_holds(quantized_limits limits, uint8_t lo_code, uint8_t hi_code) {
    return (int)lo_code <= limits.below && (int)hi_code >= limits.above;
}

#endif
