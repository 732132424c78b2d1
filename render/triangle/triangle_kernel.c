#include "render/triangle/triangle_kernel.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "formats/leaf/triangle_normal.h"
#include "render/look/picture_bytes.h"

void triangle_polygon(const triangle *x, flat_polygon *out) {
    uint8_t rank[3];
    for (int k = 0; k < 3; k++)
        rank[k] = (uint8_t)(triangle_is_before(x->p[(k + 1) % 3], x->p[k]) +
                            triangle_is_before(x->p[(k + 2) % 3], x->p[k]));
    const bool second = triangle_is_before(x->p[1], x->p[0]);
    const bool third = triangle_is_before(x->p[2], x->p[second]);
    const uint8_t *from = triangle_corners_from[third ? 2 : second];
    out->count = 3;
    for (int i = 0; i < 4; i++) {
        const int k = from[i < 3 ? i : 2];
        out->edge[i] = rank[k];
        for (int a = 0; a < 3; a++)
            out->p[i][a] = (double)x->p[k][a];
    }
}

static double shortest_edge(const triangle *x) {
    double square = INFINITY;
    for (int i = 0; i < 3; i++) {
        double e[3];
        for (int k = 0; k < 3; k++)
            e[k] = (double)x->p[(i + 1) % 3][k] - (double)x->p[i][k];
        square = fmin(square, vec3_dot(e, e));
    }
    return sqrt(square);
}

flat_facts triangle_flat_facts(const triangle *x) {
    flat_facts f = {.point = {.span = shortest_edge(x)}};
    double over[4][3]; /* the gradient goes against the right-hand rule */
    flat_across n;
    for (int k = 0; k < 3; k++) {
        over[0][k] = (double)x->p[0][k];
        over[1][k] = (double)x->p[2][k];
        over[2][k] = over[3][k] = (double)x->p[1][k];
    }
    if (!flat_normal((const double(*)[3])over, &n))
        n = (flat_across){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    memcpy(f.at, over[0], sizeof f.at);
    memcpy(f.error, n.error, sizeof f.error);
    memcpy(f.point.gradient, n.direction, sizeof n.direction);
    for (int k = 0; k < 3; k++)
        f.point.normal[k] = (float)-n.direction[k];
    return f;
}

/* The shares of the vertices at a point of the plane, by the areas as seen along the axis along
 * which the triangle is seen largest. */
static void shares_at(const triangle *x, const ray *r, double t, double share[3]) {
    double e[2][3], n[3], away[3], area[3];
    int axis = 0;
    for (int k = 0; k < 3; k++) {
        e[0][k] = (double)x->p[1][k] - (double)x->p[0][k];
        e[1][k] = (double)x->p[2][k] - (double)x->p[0][k];
        away[k] = r->o[k] + t * r->d[k] - (double)x->p[0][k];
    }
    vec3_cross(e[0], e[1], n);
    for (int k = 1; k < 3; k++)
        if (fabs(n[k]) > fabs(n[axis]))
            axis = k;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    area[1] = (away[u] * e[1][v] - away[v] * e[1][u]) / n[axis];
    area[2] = (e[0][u] * away[v] - e[0][v] * away[u]) / n[axis];
    for (int k = 1; k < 3; k++)
        area[k] = area[k] > 0.0 ? fmin(area[k], 1.0) : 0.0; /* NaN: a triangle without an area */
    share[1] = area[1];
    share[2] = fmin(area[2], 1.0 - area[1]);
    share[0] = 1.0 - share[1] - share[2];
}

/* ---- smooth normals ---- */

/* The cosine to the eye that normals have at least. */
#define SEEN 0x1p-10

/* Set what tells the shares of the vertices: as shares_at(), but for the last bits. */
static bool find_axes(const triangle *x, triangle_smooth *s) {
    double e[2][3], n[3];
    int axis = 0;
    for (int k = 0; k < 3; k++) {
        s->corner[k] = (double)x->p[0][k];
        e[0][k] = (double)x->p[1][k] - (double)x->p[0][k];
        e[1][k] = (double)x->p[2][k] - (double)x->p[0][k];
    }
    vec3_cross(e[0], e[1], n);
    for (int k = 1; k < 3; k++)
        if (fabs(n[k]) > fabs(n[axis]))
            axis = k;
    s->u = (axis + 1) % 3;
    s->v = (axis + 2) % 3;
    for (int k = 0; k < 2; k++) {
        const double sign = k ? -1.0 : 1.0;
        s->by[k][0] = sign * e[!k][s->v] / n[axis];
        s->by[k][1] = -sign * e[!k][s->u] / n[axis];
    }
    return isfinite(s->by[0][0] + s->by[0][1] + s->by[1][0] + s->by[1][1]);
}

triangle_smooth triangle_smooth_of(const triangle *x) {
    triangle_smooth s = {.any = x->smooth};
    for (int k = 0; k < 3 && s.any; k++)
        s.any = triangle_normal_decode(x->normal[k], s.at[k]);
    s.any = s.any && find_axes(x, &s);
    return s;
}

static double between(double least, double x, double most) {
    const double low = x < least ? least : x;
    return low > most ? most : low;
}

/* Add up the vertices' normals by their shares at a point of the plane. */
static void add_normals(const triangle_smooth *s, const ray *r, double t, double n[3]) {
    const double u = r->o[s->u] + t * r->d[s->u] - s->corner[s->u],
                 v = r->o[s->v] + t * r->d[s->v] - s->corner[s->v];
    const double second = between(0.0, s->by[0][0] * u + s->by[0][1] * v, 1.0),
                 third = between(0.0, s->by[1][0] * u + s->by[1][1] * v, 1.0 - second),
                 first = 1.0 - second - third;
    for (int a = 0; a < 3; a++)
        n[a] = first * s->at[0][a] + second * s->at[1][a] + third * s->at[2][a];
}

/* Bend a unit vector to the side from which its triangle is seen. */
static void bend(double side, const ray *r, double n[3]) {
    double eye[3] = {-r->d[0], -r->d[1], -r->d[2]};
    if (!vec3_unit(eye, eye))
        return;
    const double less = SEEN - side * vec3_dot(n, eye);
    for (int a = 0; a < 3 && less > 0.0; a++)
        n[a] += less * side * eye[a];
}

void triangle_smooth_normal(const triangle_smooth *s, const ray *r, double t, float normal[3]) {
    const double flat[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};
    double n[3];
    add_normals(s, r, t, n);
    double square = vec3_dot(n, n);
    if (vec3_dot(n, flat) < 0.0)
        for (int a = 0; a < 3; a++)
            n[a] = -n[a];
    /* The ray goes against what is seen. */
    const double side = vec3_dot(flat, r->d) > 0.0 ? -1.0 : 1.0, to = -side * vec3_dot(n, r->d);
    if (!(to > 0.0 && to * to >= SEEN * SEEN * square * vec3_dot(r->d, r->d))) {
        if (!vec3_unit(n, n))
            return;
        bend(side, r, n);
        square = vec3_dot(n, n);
    }
    const double scale = 1.0 / sqrt(square);
    for (int a = 0; a < 3; a++)
        normal[a] = (float)(n[a] * scale);
}

void triangle_values(const triangle *x, const ray *r, double t, bool coloured, surface_point *out) {
    double share[3], own[3] = {0.0, 0.0, 0.0};
    shares_at(x, r, t, share);
    for (int k = 0; k < 3; k++) {
        double of[3] = {(double)x->value[k], 0.0, 0.0};
        if (coloured)
            picture_light((double)x->value[k], of);
        for (int c = 0; c < 3; c++)
            own[c] += share[k] * of[c];
    }
    for (int c = 0; c < 3; c++)
        out->own[c] = (float)own[c];
}

surface_point triangle_point(const triangle *x, const ray *r, const hit *h, bool coloured) {
    const flat_facts f = triangle_flat_facts(x);
    surface_point p = flat_point_at(&f, r, h);
    const triangle_smooth s = triangle_smooth_of(x);
    if (s.any)
        triangle_smooth_normal(&s, r, h->t, p.normal);
    triangle_values(x, r, h->t, coloured, &p);
    return p;
}
