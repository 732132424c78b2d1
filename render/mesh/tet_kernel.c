#include "render/mesh/tet_kernel.h"

#include <float.h>
#include <string.h>

#include "formats/base/exact.h"
#include "formats/base/vec3.h"
#include "render/surface/shade.h"

const uint8_t tet_edge_ends[TET_EDGES][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

const tet_cut tet_cuts[16] = {
    {0, {0, 0, 0, 0}}, /* none */
    {3, {0, 2, 1, 1}}, /* 0 */
    {3, {0, 3, 4, 4}}, /* 1 */
    {4, {1, 3, 4, 2}}, /* 0 1 */
    {3, {1, 5, 3, 3}}, /* 2 */
    {4, {0, 2, 5, 3}}, /* 0 2 */
    {4, {0, 1, 5, 4}}, /* 1 2 */
    {3, {2, 5, 4, 4}}, /* 0 1 2 */
    {3, {2, 4, 5, 5}}, /* 3 */
    {4, {0, 4, 5, 1}}, /* 0 3 */
    {4, {0, 3, 5, 2}}, /* 1 3 */
    {3, {1, 3, 5, 5}}, /* 0 1 3 */
    {4, {1, 2, 4, 3}}, /* 2 3 */
    {3, {0, 4, 3, 3}}, /* 0 2 3 */
    {3, {0, 1, 2, 2}}, /* 1 2 3 */
    {0, {0, 0, 0, 0}}, /* all */
};

static double least(double a, double b) {
    return a < b ? a : b;
}

static double most(double a, double b) {
    return a > b ? a : b;
}

/* ---- the polygon ----------------------------------------------------------------------------- */

/* Returns which vertices are inside, a bit each; 0: the tet is not active. */
static unsigned inside_of(const float f[4], double iso) {
    /* Four floats add up in double without overflow. */
    if (!isfinite((double)f[0] + (double)f[1] + (double)f[2] + (double)f[3]))
        return 0;
    unsigned inside = 0;
    for (unsigned i = 0; i < 4; i++)
        inside |= (unsigned)((double)f[i] >= iso) << i;
    return inside == 15 ? 0 : inside;
}

/* The point never lies beyond a or b. Proof: if s < 1, the product is at least an ulp less than the
 * rounded difference b - a, which errs by half an ulp at most. So a plus the product lies between a
 * and b before it is rounded, and hence after. */
static void cut_edge(const double p[4][3], const float f[4], int edge, double iso,
                     double point[3]) {
    const int i = tet_edge_ends[edge][0], j = tet_edge_ends[edge][1];
    const double fa = (double)f[i], fb = (double)f[j];
    const double s = (iso - fa) / (fb - fa);
    const bool whole = s >= 1.0;
    for (int k = 0; k < 3; k++)
        point[k] = whole ? p[j][k] : p[i][k] + s * (p[j][k] - p[i][k]);
}

void tet_turn_over(uint8_t edge[4], int count) {
    const int i = count == 3 ? 0 : 1, j = count == 3 ? 1 : 3;
    const uint8_t kept = edge[i];
    edge[i] = edge[j];
    edge[j] = kept;
}

bool isopolygon_of(const tet *x, double iso, isopolygon *out) {
    const unsigned inside = inside_of(x->f, iso);
    if (inside == 0)
        return false;
    double p[4][3];
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            p[i][k] = (double)x->p[i][k];
    out->count = tet_cuts[inside].count;
    memcpy(out->edge, tet_cuts[inside].edge, sizeof out->edge);
    if (exact_orientation((const double(*)[3])p) < 0)
        tet_turn_over(out->edge, out->count);
    for (int i = 0; i < out->count; i++)
        cut_edge((const double(*)[3])p, x->f, out->edge[i], iso, out->p[i]);
    if (out->count == 3)
        memcpy(out->p[3], out->p[2], sizeof out->p[3]);
    return true;
}

/* ---- what is known about a hit --------------------------------------------------------------- */

/* Errors, with u = half an epsilon: sides err by u of themselves, differences of two products by 4
 * u of the moduli, their products with the values by 8 u; so does the determinant, of its own
 * terms. */
static bool find_gradient(const tet *x, flat_across *out) {
    double e[3][3], df[3], normal[3][3], moduli[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            e[i][k] = (double)x->p[i + 1][k] - (double)x->p[0][k];
        df[i] = (double)x->f[i + 1] - (double)x->f[0];
    }
    for (int i = 0; i < 3; i++) {
        const double *a = e[(i + 1) % 3], *b = e[(i + 2) % 3];
        vec3_cross(a, b, normal[i]);
        for (int k = 0; k < 3; k++) {
            const int l = (k + 1) % 3, m = (k + 2) % 3;
            moduli[k] += fabs(df[i]) * (fabs(a[l] * b[m]) + fabs(a[m] * b[l]));
        }
    }
    const double determinant = vec3_dot(e[0], normal[0]);
    const exact_estimate sure = exact_near(e[0], e[1], e[2]);
    if (!(fabs(determinant) > TET_GRADIENT_SURE / EXACT_BOUND * sure.bound) ||
        !isfinite(df[0] + df[1] + df[2]))
        return false;
    const double terms = sure.bound / EXACT_BOUND, size = fabs(determinant);
    for (int k = 0; k < 3; k++) {
        const double g =
            (df[0] * normal[0][k] + df[1] * normal[1][k] + df[2] * normal[2][k]) / determinant;
        out->direction[k] = g;
        out->error[k] = 5.0 * DBL_EPSILON * (moduli[k] / size + terms / size * fabs(g));
    }
    return true;
}

bool tet_gradient(const tet *x, double gradient[3]) {
    flat_across g;
    if (!find_gradient(x, &g))
        return false;
    memcpy(gradient, g.direction, sizeof g.direction);
    return true;
}

static double shortest_edge(const tet *x) {
    double square = INFINITY;
    for (int i = 0; i < TET_EDGES; i++) {
        double e[3];
        for (int k = 0; k < 3; k++)
            e[k] = (double)x->p[tet_edge_ends[i][1]][k] - (double)x->p[tet_edge_ends[i][0]][k];
        square = least(square, vec3_dot(e, e));
    }
    return sqrt(square);
}

/* Find the gradient, and return true. If there is none, set the polygon's normal or 0, and return
 * false. */
static bool find_across(const tet *x, const isopolygon *g, flat_across *out) {
    if (find_gradient(x, out))
        return true;
    if (!flat_normal((const double(*)[3])g->p, out))
        *out = (flat_across){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    return false;
}

void tet_normal(const tet *x, double iso, float normal[3]) {
    flat_across n = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    isopolygon g;
    if (!find_gradient(x, &n) && isopolygon_of(x, iso, &g))
        (void)find_across(x, &g, &n);
    flat_normal_against(n.direction, normal);
}

/* A point of the polygon has the isovalue, but for an error along its edge (8 epsilons of the
 * values' greatest difference from it) and its own rounding. */
flat_facts tet_facts_of(const tet *x, double iso) {
    flat_facts f = {.slack = INFINITY, .point = {.span = shortest_edge(x)}};
    flat_across n;
    isopolygon g;
    double range = 0.0;
    if (!isopolygon_of(x, iso, &g))
        return f;
    if (find_across(x, &g, &n))
        for (int i = 0; i < 4; i++)
            range = most(range, fabs((double)x->f[i] - iso));
    f.slack = 8.0 * DBL_EPSILON * range;
    memcpy(f.at, g.p[0], sizeof f.at);
    memcpy(f.error, n.error, sizeof f.error);
    memcpy(f.point.gradient, n.direction, sizeof n.direction);
    flat_normal_against(f.point.gradient, f.point.normal);
    return f;
}

surface_point tet_surface(const tet *x, const ray *r, double iso, const hit *h) {
    const flat_facts f = tet_facts_of(x, iso);
    return flat_point_at(&f, r, h);
}
