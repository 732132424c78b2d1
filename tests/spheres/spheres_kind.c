#include <float.h>

#include "formats/base/vec3.h"
#include "render/walk/cell_walks.h"
#include "tests/spheres/spheres.h"

/* The line of a ray and a ball, about the point of the line that is nearest to the centre: so
 * nothing cancels but in the tangent. */
typedef struct chord {
    double nearest; /* t there */
    double beside2; /* square of its distance from the centre */
    double length2; /* of the ray's direction */
} chord;

static chord chord_of(const sphere *x, const ray *r) {
    double to[3], beside[3];
    vec3_sub(x->centre, r->o, to);
    const double length2 = vec3_dot(r->d, r->d), nearest = vec3_dot(to, r->d) / length2;
    for (int a = 0; a < 3; a++)
        beside[a] = to[a] - nearest * r->d[a];
    return (chord){nearest, vec3_dot(beside, beside), length2};
}

/* Where the line is at a distance from the centre whose square this is: in and out. */
static bool roots(const chord *c, double square, double t[2]) {
    const double half = sqrt((square - c->beside2) / c->length2);
    t[0] = c->nearest - half;
    t[1] = c->nearest + half;
    return square > c->beside2;
}

static void hits(const tracer *tr, const cell *c, const ray *r, trace_state *state) {
    const sphere *x = c->record;
    const chord line = chord_of(x, r);
    for (int i = 0; i < tr->isos.count; i++) {
        const double iso = tr->isos.isovalues[i];
        double t[2];
        if (!(iso > 0.0 && iso <= x->peak) ||
            !roots(&line, x->radius * x->radius * (1.0 - iso / x->peak), t))
            continue;
        for (int k = 0; k < 2; k++)
            cell_hit(state, r, &(hit){t[k], c->number, i, k == 0});
    }
}

static double value(const cell *c, const double point[3], double gradient[3]) {
    const sphere *x = c->record;
    const double square = x->radius * x->radius;
    double away[3];
    vec3_sub(point, x->centre, away);
    for (int a = 0; a < 3; a++)
        gradient[a] = -2.0 * x->peak / square * away[a];
    return x->peak * (1.0 - vec3_dot(away, away) / square);
}

static surface_point surface(const tracer *tr, const cell *c, const ray *r, const hit *h) {
    const sphere *x = c->record;
    surface_point p = {.span = x->radius};
    double at[3], out[3], unit[3] = {0.0, 0.0, 0.0}, size = 0.0;
    (void)tr;
    for (int a = 0; a < 3; a++) {
        at[a] = r->o[a] + h->t * r->d[a];
        size += fabs(r->o[a]) + fabs(h->t * r->d[a]) + fabs(x->centre[a]);
    }
    (void)value(c, at, p.gradient);
    p.error = 16.0 * DBL_EPSILON * (2.0 * x->peak / x->radius * size + x->peak);
    for (int a = 0; a < 3; a++)
        out[a] = -p.gradient[a];
    (void)vec3_unit(out, unit);
    for (int a = 0; a < 3; a++)
        p.normal[a] = (float)unit[a];
    return p;
}

/* From rim to rim the value is 4 s (1 - s) of its greatest, here as a cubic. */
static bool piece(const cell *c, const ray *r, segment *out) {
    const sphere *x = c->record;
    const chord line = chord_of(x, r);
    const double square = x->radius * x->radius;
    double t[2];
    if (!roots(&line, square, t))
        return false;
    out->t0 = t[0];
    out->t1 = t[1];

    out->b[0] = out->b[3] = 0.0;
    out->b[1] = out->b[2] = 4.0 / 3.0 * x->peak * (1.0 - line.beside2 / square);
    return true;
}

static bool holds(const cell *c, const double point[3]) {
    const sphere *x = c->record;
    double away[3];
    vec3_sub(point, x->centre, away);
    return vec3_dot(away, away) / (x->radius * x->radius) <= 1.0;
}

/* The nearest point errs by some roundings of the way to the centre. That moves values by as much
 * over the least radius; and ends by its root, where the line is nearly a tangent. */
static segments_error segments_error_in(const tracer *tr, const ray *r, const double range[2]) {
    const double *widest = tr->treelets->tree->widest;
    double reach = 0.0, wide = 0.0;
    for (int a = 0; a < 3; a++) {
        reach += fmax(fabs(tr->box[0][a] - r->o[a]), fabs(tr->box[1][a] - r->o[a]));
        wide = fmax(wide, widest[a]);
    }
    const double off = 16.0 * DBL_EPSILON * reach;
    return (segments_error){.t = (off + sqrt(off * wide)) / vec3_length(r->d),
                            .value = 4.0 * range[1] * (off / SPHERES_RADIUS_MIN + DBL_EPSILON)};
}

static const cell_kind cells = {hits, surface, piece, holds, value};

const kind spheres_kind = {.name = "spheres",
                           .cell = "sphere",
                           CELL_WALKS_ROW,
                           .cells = &cells,
                           .degree = 3,
                           .describe = cell_walks_describe,
                           .segments_error = segments_error_in};
