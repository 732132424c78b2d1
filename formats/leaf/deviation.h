/* deviation.h - how far a grid's coarse levels are from its finest one (FORMAT.md 8), so that a
 * value seen in a coarse level says between which values the true one is.
 *
 * The deviation of a brick of 8^3 cells of level l > 0 is at least the greatest |f0 - fl| in it,
 * where f0 and fl are the interpolants (trilinear in each cell) of level 0 and of level l, at all
 * points of the volume with a value in both. It is carried from level to level:
 *
 *     |f0 - fl+1| <= |f0 - fl| + |fl - fl+1|                                               (1)
 *
 * The first term is bounded by the deviations of the level-l bricks below, each by its own. The
 * second needs to be known at the nodes of level l alone: planes between coarse cells are planes
 * between fine ones (coarse node i sits on fine node 2i, on rectilinear axes, too, and what lies
 * beyond an odd end is the same in both), so each fine cell lies in one coarse cell. There both
 * interpolants are linear in each coordinate, so is their difference, and such a function takes its
 * greatest and least values at corners: nodes of level l. At these the coarse interpolant is the
 * coarse sample (even place on an axis) or between two (odd place; half way unless rectilinear).
 *
 * A cell that touches NaN or inf has no value. Where a fine or a coarse node of a brick is one,
 * that brick's deviation is unknown, and so is that of every brick above. So a brick whose
 * deviation is known has values at all of its points, in all levels down to 0.
 *
 * A code is the upper half of a positive float, rounded up: 8 bits of it count. 7F80 (infinity):
 * unknown.
 */
#ifndef FORMATS_LEAF_DEVIATION_H
#define FORMATS_LEAF_DEVIATION_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "formats/leaf/leaf_layout.h"

enum {
    DEVIATION_BRICK_LOG2 = 3, /* a brick has 8^3 cells */
    DEVIATION_BRICK = 1 << DEVIATION_BRICK_LOG2,
    DEVIATION_UNKNOWN = 0x7F80
};

/* deviation_code() - the smallest code of at least d >= 0; DEVIATION_UNKNOWN of NaN.
 * deviation_value() - of a code: +inf of DEVIATION_UNKNOWN. */
uint16_t deviation_code(double d);
static inline double deviation_value(uint16_t code) {
    const uint32_t bits = (uint32_t)code << 16;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* ---- Where they are ---- */

/* deviation_side(), deviation_bricks() - bricks of a coarse treelet along an axis, and all. */
static inline uint32_t deviation_side(const leaf_layout *l) {
    return 1u << (l->cells_log2 - DEVIATION_BRICK_LOG2);
}
static inline uint32_t deviation_bricks(const leaf_layout *l) {
    return 1u << 3 * (l->cells_log2 - DEVIATION_BRICK_LOG2);
}

/* deviation_at() - the first brick of coarse treelet t in a set; its bricks follow, x fastest.
 * deviation_count() - of all; 0: there is one level. deviation_bytes() - of the section. */
static inline size_t deviation_at(const leaf_layout *l, uint32_t set, uint32_t t) {
    return ((size_t)l->level[0].first * set + t) * deviation_bricks(l);
}
static inline size_t deviation_count(const leaf_layout *l) {
    return deviation_at(l, l->sets, 0);
}
uint64_t deviation_bytes(const leaf_header *h);

/* deviation_brick() - of a treelet's bricks the one with this cell of the treelet. */
static inline uint32_t deviation_brick(const leaf_layout *l, uint32_t x, uint32_t y, uint32_t z) {
    const uint32_t side = deviation_side(l);
    return (x >> DEVIATION_BRICK_LOG2) +
           side * ((y >> DEVIATION_BRICK_LOG2) + side * (z >> DEVIATION_BRICK_LOG2));
}

/* deviation_has_cells() - whether coarse treelet t has any in this brick of its. */
bool deviation_has_cells(const leaf_layout *l, uint32_t t, uint32_t brick);

/* deviation_sound() - whether all codes are such, and those of bricks without cells 0. False: not
 * that of element *brick. */
bool deviation_sound(const leaf_layout *l, const uint16_t *codes, size_t *brick);

/* deviation_over() - the greatest of level k > 0 where treelet t of level 0 is: *up becomes the
 * treelet there. codes: of all. */
double deviation_over(const leaf_layout *l, const uint16_t *codes, uint32_t set, uint32_t t,
                      uint32_t k, uint32_t *up);

/* ---- Two levels ---- */

/* deviation_weight() - where the fine node in coarse cell i of an axis lies in it, of 1: axis has
 * the nodes of level 0, `last` is the last one's number; fine: the fine level. */
double deviation_weight(const double *axis, uint32_t last, uint32_t fine, uint32_t i);

/* deviation_rounding() - what a deviation at a level may lack for rounding, where values are in
 * range[]; 0 where nothing is rounded: integers on a regular grid. */
double deviation_rounding(sample_type type, bool rectilinear, const double range[2],
                          uint32_t level);

/* A slice of fine nodes beside the coarse ones in front of and behind it. The first row and the
 * first node lie on coarse ones. */
typedef struct deviation_slice {
    sample_type type;
    const void *fine;     /* rows[0] x rows[1] nodes, rows fine_row samples apart */
    uint32_t nodes, rows; /* at most 2 * DEVIATION_BRICK + 1 rows */
    size_t fine_row;
    const void
        *coarse[2]; /* the same one if the fine slice lies on it; as far as fine nodes need */
    size_t coarse_row;
    const double *weight[2]; /* on x and y: of the fine nodes in coarse cells; NULL: 1/2 */
    double weight_z;         /* 0 if the fine slice lies on a coarse one */
} deviation_slice;

/* What has been compared: two rows of fine bricks, one above the other in y. */
typedef struct deviation_band deviation_band;

/* deviation_band_bytes() - of one for rows of so many fine nodes. deviation_band_begin() - nothing
 * compared yet; band: 64-byte aligned. deviation_scratch_bytes() - what comparing works in. */
size_t deviation_band_bytes(uint32_t nodes);
void deviation_band_begin(deviation_band *band, uint32_t nodes);
size_t deviation_scratch_bytes(uint32_t nodes);

/* deviation_compare() - one more slice. deviation_of_brick() - the greatest difference in fine
 * brick x of row y (0, 1) so far; +inf: unknown. */
void deviation_compare(const deviation_slice *s, void *scratch, deviation_band *band);
double deviation_of_brick(const deviation_band *band, uint32_t x, uint32_t y);

#endif
