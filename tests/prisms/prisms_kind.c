#include <float.h>

#include "formats/base/vec3.h"
#include "render/walk/cell_walks.h"
#include "tests/prisms/prisms.h"

/* The plane of a face: n . x = n . p. Two prisms that share the face have the same bits of n and p,
 * and lie on different sides of it. */
typedef struct face {
    double n[3], p[3];
    double side; /* 1 or -1: the prism is where side * n . (x - p) > 0 */
} face;

enum { FACES = 5 };

static face cap_of(const prism *x, int top) {
    return (face){{0.0, 0.0, 1.0}, {0.0, 0.0, (double)x->z[top]}, top ? -1.0 : 1.0};
}

/* The face over an edge, from its lesser vertex to the greater one. */
static face side_of(const prism *x, int edge) {
    const float *p = x->base[edge], *q = x->base[(edge + 1) % 3], *rest = x->base[(edge + 2) % 3];
    if (q[0] < p[0] || (q[0] == p[0] && q[1] < p[1])) {
        const float *const swap = p;
        p = q;
        q = swap;
    }
    face f = {.n = {(double)p[1] - (double)q[1], (double)q[0] - (double)p[0]},
              .p = {(double)p[0], (double)p[1]}};
    f.side = f.n[0] * ((double)rest[0] - f.p[0]) + f.n[1] * ((double)rest[1] - f.p[1]) > 0.0 ? 1.0
                                                                                             : -1.0;
    return f;
}

static face face_of(const prism *x, int i) {
    return i < 2 ? cap_of(x, i) : side_of(x, i - 2);
}

/* How far behind a face a point is, times a factor of the face's own. */
static double behind(const face *f, const double point[3]) {
    double away[3];
    vec3_sub(point, f->p, away);
    return vec3_dot(f->n, away);
}

/* Whether the prism has points of a face's plane that are so far behind it. */
static bool owns(const face *f, double far) {
    return f->side > 0.0 ? far >= 0.0 : far < 0.0;
}

/* The part of a line in a prism, and the faces at its ends. */
typedef struct crossing {
    double t[2];
    int face[2];
} crossing;

static bool cross(const prism *x, const ray *r, crossing *c) {
    *c = (crossing){.t = {-INFINITY, INFINITY}};
    for (int i = 0; i < FACES; i++) {
        const face f = face_of(x, i);
        const double far = behind(&f, r->o), speed = vec3_dot(f.n, r->d);
        if (speed == 0.0) {
            if (!owns(&f, far))
                return false;
            continue;
        }
        const double t = -far / speed;
        const int end = speed * f.side < 0.0;
        if (end ? t < c->t[1] : t > c->t[0]) {
            c->t[end] = t;
            c->face[end] = i;
        }
    }
    return c->t[0] < c->t[1];
}

static void hits(const tracer *tr, const cell *c, const ray *r, trace_state *state) {
    const prism *x = c->record;
    crossing at;
    if (!cross(x, r, &at))
        return;
    for (int i = 0; i < tr->isos.count; i++) {
        const double iso = tr->isos.isovalues[i];
        /* A ray that begins on the prism leaves it: it is convex. */
        if (!(iso > 0.0 && iso <= (double)x->value) ||
            (c->number == state->origin && i == state->origin_iso))
            continue;
        for (int end = 0; end < 2; end++)
            cell_hit(state, r, &(hit){at.t[end], c->number, i, end == 0});
    }
}

/* The value steps from 0 at the face: as if it rose along the face's normal, over the prism's
 * height. */
static surface_point surface(const tracer *tr, const cell *c, const ray *r, const hit *h) {
    const prism *x = c->record;
    surface_point p = {.span = (double)x->z[1] - (double)x->z[0]};
    crossing at;
    double unit[3] = {0.0, 0.0, 0.0}, size = 0.0;
    (void)tr;
    (void)cross(x, r, &at);
    const face f = face_of(x, at.face[!h->entering]);
    (void)vec3_unit(f.n, unit);
    for (int a = 0; a < 3; a++) {
        size += fabs(r->o[a]) + fabs(h->t * r->d[a]) + fabs(f.p[a]);
        p.gradient[a] = f.side * unit[a] * (double)x->value / p.span;
        p.normal[a] = (float)(-f.side * unit[a]);
    }
    p.error = 16.0 * DBL_EPSILON * size * (double)x->value / p.span;
    return p;
}

static bool piece(const cell *c, const ray *r, segment *out) {
    const prism *x = c->record;
    crossing at;
    if (!cross(x, r, &at))
        return false;
    out->t0 = at.t[0];
    out->t1 = at.t[1];

    out->b[0] = out->b[1] = (double)x->value;
    out->spread = SEGMENT_EVEN;
    return true;
}

static bool holds(const cell *c, const double point[3]) {
    bool inside = true;
    for (int i = 0; i < FACES; i++) {
        const face f = face_of(c->record, i);
        inside = inside && owns(&f, behind(&f, point));
    }
    return inside;
}

static double value(const cell *c, const double point[3], double gradient[3]) {
    const prism *x = c->record;
    (void)point;
    gradient[0] = gradient[1] = gradient[2] = 0.0;
    return (double)x->value;
}

/* Values are exact. t errs by the roundings of the way to the face's first vertex; a face that is
 * seen at less than 2^-20 of a right angle is not bounded. */
static segments_error segments_error_in(const tracer *tr, const ray *r, const double range[2]) {
    double reach = 0.0;
    (void)range;
    for (int a = 0; a < 3; a++)
        reach += fmax(fabs(tr->box[0][a] - r->o[a]), fabs(tr->box[1][a] - r->o[a]));
    return (segments_error){.t = 0x1p20 * 16.0 * DBL_EPSILON * reach / vec3_length(r->d)};
}

static const cell_kind cells = {hits, surface, piece, holds, value};

const kind prisms_kind = {.name = "prisms",
                          .cell = "prism",
                          CELL_WALKS_ROW,
                          .cells = &cells,
                          .degree = 1,
                          .describe = cell_walks_describe,
                          .segments_error = segments_error_in};
