/* pyramid_rows.h - the filters of pyramid.c along x, y and z, by type and for each ISA. All give
 * the same bits. */
#ifndef PREP_GRID_PYRAMID_ROWS_H
#define PREP_GRID_PYRAMID_ROWS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "formats/base/sample.h"
#include "prep/grid/pyramid.h"

enum { PYRAMID_TAPS = 5, PYRAMID_WHOLE = 16 * 16 * 16 };

/* The mean of five numbers times 16, added from the lowest index up. S: the type to add in. */
#define PYRAMID_WEIGH(S, v0, v1, v2, v3, v4) \
    (((((S)(v0) + (S)4 * (S)(v1)) + (S)6 * (S)(v2)) + (S)4 * (S)(v3)) + (S)(v4))

/* Each for the coarse nodes [first, end) of a row. */
typedef struct pyramid_rows {
    size_t sum_size; /* bytes of a sum over a row or a plane */
    void (*x)(const void *row, uint32_t nodes, void *sums, uint32_t first, uint32_t end);
    void (*y)(const void *const taps[PYRAMID_TAPS], void *sums, uint32_t first, uint32_t end);
    void (*z)(const void *const taps[PYRAMID_TAPS], void *samples, uint32_t first, uint32_t end);
} pyramid_rows;

/* pyramid_rows_for() - the filters of an ISA for samples of sample_stored() types. */
const pyramid_rows *pyramid_rows_for(cpu_isa isa, sample_type type);

/* pyramid_rows_of_colours() - those for colours (colour_field.h), each of their bytes by itself.
 */
const pyramid_rows *pyramid_rows_of_colours(void);

/* pyramid_rows_shorten() - round a finite float to PYRAMID_BITS, half to even; down where the
 * result would be infinite. */
static inline float pyramid_rows_shorten(float value) {
    enum { GONE = 23 - PYRAMID_BITS };
    const uint32_t exponent = 0x7F800000U, low = (1U << GONE) - 1;
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint32_t nearest = (bits + (low >> 1) + (bits >> GONE & 1)) & ~low;
    bits = (nearest & exponent) == exponent ? bits & ~low : nearest;
    memcpy(&value, &bits, sizeof bits);
    return value;
}

#endif
