/* deviation_band.h - how far slices of a level are from the coarser level's (deviation.h), brick by
 * brick.
 */
#ifndef FORMATS_LEAF_DEVIATION_BAND_H
#define FORMATS_LEAF_DEVIATION_BAND_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"

enum {
    DEVIATION_BRICK_LOG2 = 3, /* a brick has 8^3 cells */
    DEVIATION_BRICK = 1 << DEVIATION_BRICK_LOG2
};

/* A slice of fine nodes with the coarse slices in front of and behind it. The first row and the
 * first node lie on coarse ones. */
typedef struct deviation_slice {
    sample_type type;
    const void *fine;     /* rows[0] x rows[1] nodes, rows fine_row samples apart */
    uint32_t nodes, rows; /* at most 2 * DEVIATION_BRICK + 1 rows */
    size_t fine_row;
    const void *coarse[2]; /* the same slice twice if the fine one lies on it; large enough for the
                              fine nodes */
    size_t coarse_row;
    const double *weight[2]; /* on x, y: where fine nodes lie in coarse cells; NULL: 1/2 */
    double weight_z;         /* 0 if the fine slice lies on a coarse one */
} deviation_slice;

/* Differences found so far, in two rows of fine bricks, neighbours in y. */
typedef struct deviation_band deviation_band;

/* deviation_band_bytes() - the size of a band whose rows have so many fine nodes.
 * deviation_band_begin() - reset a band: nothing is compared yet. band: 64-byte aligned.
 * deviation_scratch_bytes() - the size of the scratch room for deviation_compare(). */
size_t deviation_band_bytes(uint32_t nodes);
void deviation_band_begin(deviation_band *band, uint32_t nodes);
size_t deviation_scratch_bytes(uint32_t nodes);

/* deviation_compare() - compare one more slice.
 * deviation_of_brick() - the greatest difference so far in fine brick x of row y (0, 1); +inf:
 * unknown. */
void deviation_compare(const deviation_slice *s, void *scratch, deviation_band *band);
double deviation_of_brick(const deviation_band *band, uint32_t x, uint32_t y);

#endif
