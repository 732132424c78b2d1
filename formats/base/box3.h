/* box3.h - axis-aligned boxes in doubles: box[0] is the lower corner, box[1] the upper one. */
#ifndef FORMATS_BASE_BOX3_H
#define FORMATS_BASE_BOX3_H

#include <math.h>
#include <stdbool.h>

/* box3_begin() - make the box empty.
 * box3_widen() - extend the box by another one.
 * box3_any() - whether the box is not empty. */
static inline void box3_begin(double box[2][3]) {
    for (int a = 0; a < 3; a++) {
        box[0][a] = INFINITY;
        box[1][a] = -INFINITY;
    }
}

static inline void box3_widen(double box[2][3], const double lo[3], const double hi[3]) {
    for (int a = 0; a < 3; a++) {
        box[0][a] = fmin(box[0][a], lo[a]);
        box[1][a] = fmax(box[1][a], hi[a]);
    }
}

static inline bool box3_any(double box[2][3]) {
    return box[0][0] <= box[1][0];
}

/* box3_corner() - corner i, with i = x + 2y + 4z; x, y, z: 0 lower, 1 upper. */
static inline void box3_corner(double box[2][3], int i, double corner[3]) {
    for (int a = 0; a < 3; a++)
        corner[a] = box[i >> a & 1][a];
}

/* box3_share_of() - a box relative to a whole one: 0 at the whole's lower corner, 1 at its upper
 * one. Both boxes are given as lo x y z, hi x y z. */
static inline void box3_share_of(const float bounds[6], const float whole[6], double share[2][3]) {
    for (int i = 0; i < 6; i++) {
        const double begin = (double)whole[i % 3], end = (double)whole[i % 3 + 3];
        share[i / 3][i % 3] = ((double)bounds[i] - begin) / (end - begin);
    }
}

/* box3_of_floats() - convert a box given as lo x y z, hi x y z. */
static inline void box3_of_floats(const float bounds[6], double box[2][3]) {
    for (int i = 0; i < 6; i++)
        box[i / 3][i % 3] = (double)bounds[i];
}

#endif
