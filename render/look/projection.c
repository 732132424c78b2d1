#include "render/look/projection.h"

#include <math.h>

#include "formats/base/vec3.h"

axis_projection projection_axis(const affine *space, const camera *c, int a) {
    const double step[3] = {space->to_world[0][a], space->to_world[1][a], space->to_world[2][a]};
    /* right and up are as long as half the picture's height at distance 1. */
    const double half = 0.5 * c->height;
    return (axis_projection){half * vec3_dot(c->right, step) / vec3_dot(c->right, c->right),
                             -half * vec3_dot(c->up, step) / vec3_dot(c->up, c->up),
                             vec3_dot(c->forward, step), vec3_length(step)};
}

double projection_scale(const affine *space) {
    double largest = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            largest = fmax(largest, fabs(space->to_grid[i][j]));
    return scalbn(1.0, -ilogb(largest));
}

/* Each entry is rounded once, and so are two sums. So |error| of x <= 3 u sum |x| and of w <= 3 u
 * sum |w|, u = 2^-24, where sum |x| <= reach sum far and sum |w| <= sum far. The error of x / w is
 * then 3 u (reach + |x / w|) sum far / w, and 2^-21 of the reciprocal; doubled and rounded up.
 * rounded: how many times more roundings entries have. */
void projection_set_bounds(projection *p, const camera *c, double worst, double rounded) {
    const double u = rounded * ldexp(1.0, -24);
    const double shift = fmax(fabs(c->width - c->middle[0]), fabs(c->height - c->middle[1]));
    const double half = 0.5 * (fmax(c->width, c->height) + shift);
    const double reach =
        0.5 * c->height / sqrt(fmin(vec3_dot(c->right, c->right), vec3_dot(c->up, c->up)));
    const double least = ldexp(half, -20) + 1e-4;
    p->margin = (float)(8.0 * u / (double)projection_depth_share * (reach + half) + least);
    p->margin_least = (float)least;
    p->plane_error = (float)(8.0 * u * (reach + half));
    /* The reciprocal needs numbers of ordinary size. */
    p->usable = worst < 1e15 && p->margin < 4.0f;
}

void projection_release(projection *p) {
    if (p->m)
        mem_free(p->m, p->block);
    p->block = NULL;
}
