/* active_box.h - boxes that grow: for kind.active_box(). */
#ifndef RENDER_ACTIVE_BOX_H
#define RENDER_ACTIVE_BOX_H

#include <math.h>
#include <stdbool.h>

static inline void box_begin(double box[2][3]) {
    for (int a = 0; a < 3; a++) {
        box[0][a] = INFINITY;
        box[1][a] = -INFINITY;
    }
}

static inline void box_widen(double box[2][3], const double lo[3], const double hi[3]) {
    for (int a = 0; a < 3; a++) {
        box[0][a] = fmin(box[0][a], lo[a]);
        box[1][a] = fmax(box[1][a], hi[a]);
    }
}

static inline bool box_any(double box[2][3]) {
    return box[0][0] <= box[1][0];
}

static inline void box_corner(double box[2][3], int i, double corner[3]) {
    for (int a = 0; a < 3; a++)
        corner[a] = box[i >> a & 1][a];
}

/* Whether values in this range hold one of the isovalues. */
static inline bool range_is_active(const float range[2], const double *isovalues, int count) {
    for (int i = 0; i < count; i++)
        if ((double)range[0] < isovalues[i] && isovalues[i] <= (double)range[1])
            return true;
    return false;
}

#endif
