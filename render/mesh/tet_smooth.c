#include "render/mesh/tet_smooth.h"

#include "formats/base/vec3.h"
#include "render/surface/shade.h"

static const uint8_t ends_of[TET_EDGES][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* Interpolate the gradient at a polygon's point, with the point's own share of the edge. */
static void gradient_at(const tet *x, double iso, int edge, const float gradients[4][3],
                        double out[3]) {
    const int i = ends_of[edge][0], j = ends_of[edge][1];
    const double fa = (double)x->f[i], fb = (double)x->f[j], s = (iso - fa) / (fb - fa);
    for (int a = 0; a < 3; a++) {
        const double from = (double)gradients[i][a], to = (double)gradients[j][a];
        out[a] = s >= 1.0 ? to : from + s * (to - from);
    }
}

void tet_smooth_of(const tet *x, double iso, const isopolygon *g, const float gradients[4][3],
                   tet_smooth *out) {
    double diagonal[2][3];
    out->g = *g;
    for (int i = 0; i < 4; i++)
        gradient_at(x, iso, g->edge[i], gradients, out->gradient[i]);
    vec3_sub(g->p[2], g->p[0], diagonal[0]);
    vec3_sub(g->p[3], g->p[1], diagonal[1]);
    vec3_cross(diagonal[0], diagonal[1], out->across);
}

/* Returns twice the area of the triangle of a place and the polygon's points i and j, times the
 * length of `across`; to[k]: from the place to point k. Rounding may make it negative: then 0. */
static double area(const tet_smooth *s, const double to[4][3], int i, int j) {
    double n[3];
    vec3_cross(to[i], to[j], n);
    const double weight = vec3_dot(s->across, n);
    return weight > 0.0 ? weight : 0.0;
}

bool tet_smooth_normal(const tet_smooth *s, const double o[3], const double d[3], double t,
                       float normal[3]) {
    double to[4][3], gradient[3];
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            to[i][a] = (s->g.p[i][a] - o[a]) - t * d[a];
    /* Find the side of the diagonal 0 2 on which the place is. A triangle has its third point
     * twice.
     */
    const double beyond = s->g.count == 4 ? area(s, (const double(*)[3])to, 0, 2) : 0.0;
    const int far = beyond > 0.0 ? 3 : 1, i = beyond > 0.0 ? 2 : 1, j = beyond > 0.0 ? 3 : 2;
    const double w0 = area(s, (const double(*)[3])to, i, j);
    const double w2 = beyond > 0.0 ? area(s, (const double(*)[3])to, 3, 0)
                                   : area(s, (const double(*)[3])to, 0, 1);
    const double w = beyond > 0.0 ? beyond : area(s, (const double(*)[3])to, 2, 0);
    for (int a = 0; a < 3; a++)
        gradient[a] = w0 * s->gradient[0][a] + w2 * s->gradient[2][a] + w * s->gradient[far][a];
    return shade_normal(gradient, normal);
}
