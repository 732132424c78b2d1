#include "render/look/box_projection.h"

#include <math.h>

void box_projection_init(projection *p, const float bounds[6], const camera *c) {
    affine world;
    const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    double worst = 0.0;
    affine_init(&world, identity);
    *p = (projection){.centre = {(float)(0.5 * c->middle[0]), (float)(0.5 * c->middle[1])},
                      .scale = 1.0,
                      .unscale = 1.0};
    for (int a = 0; a < 3; a++) {
        const axis_projection axis = projection_axis(&world, c, a);
        const double entries[4] = {axis.x, axis.y, axis.w, axis.far};
        p->eye[a] = c->eye[a];
        for (int i = 0; i < 4; i++)
            p->axis[a][i] = (float)entries[i];
        worst = fmax(worst, (fabs(axis.x) + fabs(axis.y) + axis.far) *
                                fmax(fabs((double)bounds[a] - c->eye[a]),
                                     fabs((double)bounds[a + 3] - c->eye[a])));
    }
    /* Entries are products of two rounded numbers, rounded. */
    projection_set_bounds(p, c, worst, 2.0);
}
