/* deviation.h - how far a grid's coarse levels are from its finest one (FORMAT.md 8). So a value
 * seen in a coarse level bounds the true one.
 *
 * The deviation of a brick of 8^3 cells of level l > 0 is at least the greatest |f0 - fl| in it. f0
 * and fl are the interpolants (trilinear in each cell) of level 0 and of level l. It counts all
 * points of the volume where both have a value. It is carried from level to level:
 *
 *     |f0 - fl+1| <= |f0 - fl| + |fl - fl+1|                                               (1)
 *
 * The first term is bounded by the deviations of the level-l bricks below, each by its own. The
 * second is needed only at the nodes of level l. Planes between coarse cells are planes between
 * fine ones: coarse node i sits on fine node 2i, on rectilinear axes, too, and both levels are the
 * same beyond an odd end. So each fine cell lies in one coarse cell. There both interpolants are
 * linear in each coordinate, and so is their difference. Such a function takes its greatest and
 * least values at corners: nodes of level l. At these the coarse interpolant is a coarse sample
 * (even place on an axis) or between two (odd place; half way unless rectilinear).
 *
 * A cell that touches NaN or inf has no value. Where a fine or a coarse node of a brick is NaN or
 * inf, that brick's deviation is unknown, and so is that of every brick above. So a brick of known
 * deviation has values at all of its points, in all levels down to 0.
 *
 * A code is the upper half of a positive float's bits, rounded up: 8 significant bits. 7F80
 * (infinity): unknown.
 */
#ifndef FORMATS_LEAF_DEVIATION_H
#define FORMATS_LEAF_DEVIATION_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "formats/leaf/deviation_band.h"
#include "formats/leaf/leaf_layout.h"

enum { DEVIATION_UNKNOWN = 0x7F80 };

/* deviation_code() - the smallest code whose value is at least d >= 0; DEVIATION_UNKNOWN for NaN.
 * deviation_value() - the value of a code; +inf for DEVIATION_UNKNOWN. */
uint16_t deviation_code(double d);
static inline double deviation_value(uint16_t code) {
    const uint32_t bits = (uint32_t)code << 16;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* ---- Where codes are ---- */

/* deviation_side(), deviation_bricks() - the bricks of a coarse treelet: along an axis, and in
 * all. */
static inline uint32_t deviation_side(const leaf_layout *l) {
    return 1u << (l->cells_log2 - DEVIATION_BRICK_LOG2);
}
static inline uint32_t deviation_bricks(const leaf_layout *l) {
    return 1u << 3 * (l->cells_log2 - DEVIATION_BRICK_LOG2);
}

/* deviation_at() - the index of the first brick of coarse treelet t in a set; its other bricks
 * follow, x fastest.
 * deviation_count() - the number of all bricks; 0: no level above 0 has samples.
 * deviation_bytes() - the size of the section. */
static inline size_t deviation_at(const leaf_layout *l, uint32_t set, uint32_t t) {
    return ((size_t)l->level[0].first * set + t) * deviation_bricks(l);
}
static inline size_t deviation_count(const leaf_layout *l) {
    return l->sampled > 1 ? deviation_at(l, l->sets, 0) : 0;
}
uint64_t deviation_bytes(const leaf_header *h);

/* deviation_brick() - which of a treelet's bricks has cell x, y, z of the treelet. */
static inline uint32_t deviation_brick(const leaf_layout *l, uint32_t x, uint32_t y, uint32_t z) {
    const uint32_t side = deviation_side(l);
    return (x >> DEVIATION_BRICK_LOG2) +
           side * ((y >> DEVIATION_BRICK_LOG2) + side * (z >> DEVIATION_BRICK_LOG2));
}

/* deviation_has_cells() - whether this brick of coarse treelet t has any cells. */
bool deviation_has_cells(const leaf_layout *l, uint32_t t, uint32_t brick);

/* deviation_sound() - whether all codes are valid, and 0 for bricks without cells. If not, *brick
 * is a faulty element. */
bool deviation_sound(const leaf_layout *l, const uint16_t *codes, size_t *brick);

/* deviation_over() - the greatest deviation of level k > 0 over the extent of treelet t of level 0.
 * codes: all of them. *up: out, the level-k treelet there. */
double deviation_over(const leaf_layout *l, const uint16_t *codes, uint32_t set, uint32_t t,
                      uint32_t k, uint32_t *up);

/* ---- Two levels ---- */

/* deviation_weight() - the position of the fine node inside coarse cell i of an axis, as a share of
 * the cell. axis: coordinates of level 0's nodes; last: index of the last one; fine: the fine
 * level. */
double deviation_weight(const double *axis, uint32_t last, uint32_t fine, uint32_t i);

/* deviation_rounding() - the most that a deviation at a level may be too small because of rounding,
 * for values in range[]. 0 where nothing is rounded: integers on a regular grid. */
double deviation_rounding(sample_type type, bool rectilinear, const double range[2],
                          uint32_t level);

#endif
