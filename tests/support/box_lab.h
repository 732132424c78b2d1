/* box_lab.h - boxes of samples of all shapes and values, for tests of formats/leaf/box_coder.h.
 * What lies between and around the boxes is watched.
 */
#ifndef TESTS_SUPPORT_BOX_LAB_H
#define TESTS_SUPPORT_BOX_LAB_H

#include <stdbool.h>

#include "formats/leaf/box_coder.h"

enum { BOX_LAB_MAX = 7 };

/* Sizes of boxes in the order in which they are coded. */
typedef struct box_shape {
    uint32_t count, size[BOX_LAB_MAX][3];
} box_shape;

/* How a box lies in memory: x fastest, without gaps; with gaps on each axis; z fastest, then x. */
typedef enum box_lie { BOX_PACKED, BOX_GAPPED, BOX_TURNED, BOX_LIES } box_lie;

typedef struct box_lab {
    sample_type type;
    size_t width, samples; /* bytes of a sample; samples of all boxes */
    uint32_t count;
    coded_box boxes[BOX_LAB_MAX];
    unsigned char *memory; /* all boxes, and what lies around them */
    bool *inside;          /* which bytes are a sample's */
    size_t bytes;
} box_lab;

/* What samples are. The ones from BOX_DECIMALS on are for floats. */
typedef enum box_values {
    BOX_CONSTANT,
    BOX_RAMP,
    BOX_SMOOTH,
    BOX_NOISE,    /* all bits */
    BOX_EXTREMES, /* the least and the greatest value */
    BOX_SPARSE,   /* one value, but for a corner of each box and some single samples */
    BOX_INTEGERS,
    BOX_DECIMALS = BOX_INTEGERS, /* multiples of 10^-detail, some NaN */
    BOX_BINARIES,                /* multiples of 2^-detail, some NaN */
    BOX_STRAY,                   /* multiples, but for the last one */
    BOX_STRANGE,                 /* NaN of all kinds, infinities, -0, denormals among numbers */
    BOX_LIMITS,                  /* about +-2^30 steps of 2^-detail */
    BOX_QUIET,                   /* nothing but NaN */
    BOX_ZEROS,                   /* 0 and -0 */
    BOX_VALUES
} box_values;

/* box_lab_make() - boxes of unknown samples. Release them. */
void box_lab_make(box_lab *b, sample_type type, const box_shape *shape, box_lie lie);
void box_lab_release(box_lab *b);

/* box_lab_fill() - give all samples values.
 * box_lab_wipe() - give all bytes, those around the boxes too, the one that is watched for. */
void box_lab_fill(box_lab *b, box_values what, int detail, uint64_t seed);
void box_lab_wipe(box_lab *b);

/* box_lab_list() - the samples of all boxes, one after the other: samples * width bytes, malloc'ed.
 * box_lab_kept() - whether no byte around the boxes has changed since box_lab_make(). */
unsigned char *box_lab_list(const box_lab *b);
bool box_lab_kept(const box_lab *b);

#endif
