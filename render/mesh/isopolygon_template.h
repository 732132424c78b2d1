/* isopolygon_template.h - isopolygons as vectors of rays meet them; included by the units of an ISA
 * (see formats/base/simd.h). The bits are those of isopolygon_of(). */
#ifndef RENDER_MESH_ISOPOLYGON_TEMPLATE_H
#define RENDER_MESH_ISOPOLYGON_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <string.h>

#include "render/flat/flat_polygon_template.h"
#include "render/mesh/tet_kernel.h"

/* A vertex with its position and its value; or any four doubles. */
typedef double point4 __attribute__((vector_size(32)));
typedef int64_t mask4 __attribute__((vector_size(32)));

/* Finds the sign of exact_orientation(), from e[i] = vertex i + 1 less vertex 0. Returns whether it
 * is sure. */
SIMD bool surely_oriented(const point4 e[3], bool *negative) {
    const point4 yzx2 = __builtin_shufflevector(e[2], e[2], 1, 2, 0, 3),
                 zxy2 = __builtin_shufflevector(e[2], e[2], 2, 0, 1, 3);
    const point4 yzx1 = __builtin_shufflevector(e[1], e[1], 1, 2, 0, 3),
                 zxy1 = __builtin_shufflevector(e[1], e[1], 2, 0, 1, 3);
    const point4 up = yzx1 * zxy2, down = zxy1 * yzx2;
    const point4 value = e[0] * (up - down);
    const mask4 modulus = {INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX};
    const point4 terms = (point4)((mask4)e[0] & modulus) *
                         ((point4)((mask4)up & modulus) + (point4)((mask4)down & modulus));
    const double sum = value[0] + value[1] + value[2];
    *negative = sum < 0.0;
    return fabs(sum) > 2.0 * (EXACT_BOUND * (terms[0] + terms[1] + terms[2]) + EXACT_SMALLEST);
}

typedef struct near_tet {
    point4 v[4];
} near_tet;

SIMD near_tet near_tet_of(const tet *x) {
    near_tet near;
    for (int k = 0; k < 4; k++)
        near.v[k] = (point4){x->p[k][0], x->p[k][1], x->p[k][2], x->f[k]};
    return near;
}

/* A position, and 0. */
SIMD point4 point4_of_triple(const float at[3]) {
    typedef float floats4 __attribute__((vector_size(16)));
    return __builtin_convertvector((floats4){at[0], at[1], at[2]}, point4);
}

typedef enum polygon_certainty { NO_POLYGON, SURE_POLYGON, DOUBTFUL_POLYGON } polygon_certainty;

/* isopolygon_of(), with all coordinates of a vertex in a vector. The result is the same, to the
 * bit, or DOUBTFUL_POLYGON. */
SIMD polygon_certainty isopolygon_near(const near_tet *x, double iso, isopolygon *out) {
    const point4 *v = x->v;
    point4 e[3];
    unsigned inside = 0;
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        inside |= (unsigned)(v[k][3] >= iso) << k;
        sum += v[k][3];
    }
    const tet_cut *cut = &tet_cuts[inside];
    if (cut->count == 0 || !isfinite(sum))
        return NO_POLYGON;
    for (int k = 0; k < 3; k++)
        e[k] = v[k + 1] - v[0];
    const uint8_t *ends[4];
    point4 from, to;
    bool negative;
    if (!surely_oriented(e, &negative))
        return DOUBTFUL_POLYGON;
    memcpy(out->edge, cut->edge, sizeof out->edge);
    out->count = cut->count;
    if (negative)
        tet_turn_over(out->edge, out->count);
    for (int k = 0; k < 4; k++) {
        ends[k] = tet_edge_ends[out->edge[k]];
        from[k] = v[ends[k][0]][3];
        to[k] = v[ends[k][1]][3];
    }
    const point4 s = (iso - from) / (to - from);
    for (int k = 0; k < 4; k++) {
        const point4 a = v[ends[k][0]], b = v[ends[k][1]], at = a + s[k] * (b - a);
        memcpy(out->p[k], s[k] >= 1.0 ? &b : &at, sizeof out->p[k]);
    }
    return SURE_POLYGON;
}

#endif
#endif
