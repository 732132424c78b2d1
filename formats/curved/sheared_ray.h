/* sheared_ray.h - the space of one ray: its line is the third axis, its t the third coordinate.
 *
 * A shear along the ray's longest axis, and a scale of that axis. A vertex has the same three
 * doubles there, whatever asks: cells that share vertices see the same geometry, which differs from
 * the true one by some roundings of the vertex's way from the ray's origin. What is decided from
 * these doubles exactly is decided alike everywhere.
 */
#ifndef FORMATS_CURVED_SHEARED_RAY_H
#define FORMATS_CURVED_SHEARED_RAY_H

#include <math.h>

typedef struct sheared_ray {
    double o[3]; /* the ray's origin */
    int axis[3]; /* the world's axes in the order of this space's; the last is the longest of d */
    double slope[2]; /* d along the first two per unit of the third */
    double d;        /* d along the third */
    int sense;       /* 1 or -1: whether a right-handed cell is one here, too */
} sheared_ray;

/* sheared_ray_of() - the space of the ray o + t d. */
static inline sheared_ray sheared_ray_of(const double o[3], const double d[3]) {
    int c = 0;
    for (int a = 1; a < 3; a++)
        c = fabs(d[a]) > fabs(d[c]) ? a : c;
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    return (sheared_ray){.o = {o[0], o[1], o[2]},
                         .axis = {a, b, c},
                         .slope = {d[a] / d[c], d[b] / d[c]},
                         .d = d[c],
                         .sense = d[c] > 0.0 ? 1 : -1};
}

/* sheared_ray_place() - a point of the world in the ray's space. */
static inline void sheared_ray_place(const sheared_ray *s, const double p[3], double q[3]) {
    const double along = p[s->axis[2]] - s->o[s->axis[2]];
    for (int k = 0; k < 2; k++)
        q[k] = (p[s->axis[k]] - s->o[s->axis[k]]) - s->slope[k] * along;
    q[2] = along / s->d;
}

#endif
