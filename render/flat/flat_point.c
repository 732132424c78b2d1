#include "render/flat/flat_point.h"

#include <float.h>
#include <math.h>

#include "formats/base/vec3.h"
#include "render/surface/shade.h"

static double most(double a, double b) {
    return a > b ? a : b;
}

/* Find the normal from the diagonals, or two edges of a triangle. Returns false if it is 0. */
bool flat_normal(const double p[4][3], flat_across *out) {
    double e[2][3], normal[3], moduli = 0.0;
    vec3_sub(p[2], p[0], e[0]);
    vec3_sub(p[3], p[1], e[1]);
    vec3_cross(e[0], e[1], normal);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        moduli += fabs(e[0][l] * e[1][m]) + fabs(e[0][m] * e[1][l]);
    }
    for (int k = 0; k < 3; k++)
        out->error[k] = 4.0 * DBL_EPSILON * (moduli / vec3_size(normal) + 1.0);
    return isfinite(normal[0] + normal[1] + normal[2]) && vec3_unit(normal, out->direction);
}

void flat_normal_against(const double gradient[3], float normal[3]) {
    if (!shade_normal(gradient, normal))
        normal[0] = normal[1] = normal[2] = 0.0f;
}

/* Compute the difference of f from the isovalue at the ray's point, from a point that has the
 * isovalue. Its error: 11 halves of an epsilon of the coordinates, which are rounded, subtracted
 * and added up. */
surface_point flat_point_at(const flat_facts *f, const ray *r, const hit *h) {
    surface_point point = f->point;
    double away[3], sum = f->slack;
    for (int k = 0; k < 3; k++) {
        const double along = h->t * r->d[k];
        const double far = most(fabs(r->o[k]) + fabs(along), fabs(f->at[k]));
        away[k] = r->o[k] + along - f->at[k];
        sum += fabs(point.gradient[k]) * 6.0 * DBL_EPSILON * far + f->error[k] * fabs(away[k]);
    }
    point.error = fabs(vec3_dot(point.gradient, away)) + sum;
    return point;
}
