#include "render/curved/hex_walk.h"

#include <float.h>

#include "formats/base/vec3.h"
#include "formats/curved/hex_point.h"
#include "render/curved/hex_meet.h"
#include "render/curved/hex_pieces.h"
#include "render/walk/cell_walks.h"
#include "render/walk/tree_pieces.h"

void hex_cell_range(const hexahedron *h, double range[2]) {
    range[0] = range[1] = h->value[0];
    for (int c = 1; c < HEX_CORNERS; c++) {
        range[0] = real_min(range[0], h->value[c]);
        range[1] = real_max(range[1], h->value[c]);
    }
}

/* ---- Hits ---- */

/* A root, and what its surface point is made of. */
typedef struct best_root {
    hexahedron hexahedron;
    double at[3];
} best_root;

static void take_roots(const hex_way *w, const hex_cell *c, const isovalue_list *isos,
                       trace_state *state, best_root *best, path_counts *counts) {
    double range[2];
    hex_cell_range(&c->hexahedron, range);
    for (int i = 0; i < isos->count; i++) {
        path_root roots[PATH_ROOTS];
        if (!(range[0] < isos->isovalues[i] && isos->isovalues[i] <= range[1]))
            continue;
        const int count = hex_meet_roots(&c->hexahedron, c->sense, &w->sheared, isos->isovalues[i],
                                         roots, counts);
        for (int n = 0; n < count; n++) {
            const hit h = {roots[n].t, c->number, i, roots[n].entering};
            if (!cell_hit(state, w->ray, &h))
                continue;
            best->hexahedron = c->hexahedron;
            for (int a = 0; a < 3; a++)
                best->at[a] = roots[n].at[a];
        }
    }
}

static double shortest_edge(const hexahedron *h) {
    double least = INFINITY;
    for (int c = 0; c < HEX_CORNERS; c++)
        for (int bit = 1; bit < HEX_CORNERS; bit *= 2) {
            double away[3];
            vec3_sub(h->p[c | bit], h->p[c & ~bit], away);
            const double length = vec3_length(away);
            least = length > 0.0 ? real_min(least, length) : least; /* collapsed edges are none */
        }
    return least;
}

/* The value errs as if the point were moved by the roundings of its way from the ray's origin and
 * of the cell's corners, and by those of the trilinear form. */
surface_point hex_walk_surface(const hexahedron *h, const double at[3], const ray *r, double t) {
    surface_point p = {.span = shortest_edge(h)};
    double reach = 0.0, most = 0.0;
    hex_point_normal(h, at, p.gradient, p.normal);
    for (int a = 0; a < 3; a++)
        reach += 2.0 * fabs(r->o[a]) + 2.0 * fabs(t * r->d[a]);
    for (int c = 0; c < HEX_CORNERS; c++)
        most = real_max(most, fabs(h->value[c]));
    p.error = 64.0 * DBL_EPSILON * (reach * vec3_length(p.gradient) + most);
    return p;
}

bool hex_walk_hits(hex_way *w, const isovalue_list *isos, trace_state *state, path_counts *counts) {
    const hit before = state->best;
    hex_cell c;
    best_root best;
    while (w->next(w, state->best.t, &c)) {
        const hit last = state->best;
        take_roots(w, &c, isos, state, &best, counts);
        if (!hit_less(&state->best, &last))
            continue;
        w->counters->roots++;
        if (state->any)
            return true;
    }
    if (!hit_less(&state->best, &before))
        return false;
    state->point = hex_walk_surface(&best.hexahedron, best.at, w->ray, state->best.t);
    return true;
}

/* ---- Pieces ---- */

static void take_pieces(const hex_way *w, const hex_cell *c, double tolerance, hex_taker *take,
                        void *ctx, path_counts *counts) {
    hex_path path;
    path_piece pieces[PATH_PIECES];
    double range[2];
    if (hex_path_of(&c->hexahedron, c->sense, &w->sheared, &path) == 0)
        return;
    hex_cell_range(&c->hexahedron, range);
    const int count = hex_pieces(&c->hexahedron, c->sense, &path, tolerance, pieces, counts);
    for (int n = 0; n < count; n++) {
        segment s = {.t0 = pieces[n].t[0],
                     .t1 = pieces[n].t[1],
                     .spread = range[0] == range[1] ? SEGMENT_EVEN : 0.0,
                     .cell = c->number,
                     .degree = 3};
        for (int k = 0; k < 4; k++)
            s.b[k] = pieces[n].b[k];
        if (segment_cut(&s, w->ray))
            take(ctx, &s);
    }
}

void hex_walk_pieces(hex_way *w, double above, double tolerance, double limit, hex_taker *take,
                     void *ctx, path_counts *counts) {
    hex_cell c;
    while (w->next(w, limit, &c)) {
        for (int k = 0; k < HEX_CORNERS; k++)
            c.hexahedron.value[k] -= above;
        take_pieces(w, &c, tolerance, take, ctx, counts);
    }
}

typedef struct holder {
    segments_state *state;
    uint32_t treelet;
} holder;

static void hold(void *ctx, const segment *piece) {
    const holder *to = ctx;
    segment s = *piece;
    s.treelet = to->treelet;
    tree_pieces_hold(to->state, &s);
}

void hex_walk_hold(hex_way *w, uint32_t id, double above, double tolerance, segments_state *state) {
    holder to = {state, id};
    hex_walk_pieces(w, above, tolerance, state->limit.t0, hold, &to, NULL);
}

typedef struct offerer {
    extreme_state *state;
    uint32_t treelet;
} offerer;

static void offer(void *ctx, const segment *piece) {
    const offerer *to = ctx;
    const segment_extent e = segment_range(piece);
    extreme_offer(to->state, to->state->least ? -e.least : e.most,
                  to->state->least ? e.least_t : e.most_t, to->treelet);
}

void hex_walk_extremes(hex_way *w, uint32_t id, double tolerance, double limit,
                       extreme_state *state) {
    offerer to = {state, id};
    hex_walk_pieces(w, 0.0, tolerance, limit, offer, &to, NULL);
}

/* ---- Points ---- */

bool hex_walk_sample(const hex_cell *c, const double point[3], leafcast_sample *out) {
    double at[3], value;
    int corner = 0;
    if (!hex_point_find(&c->hexahedron, c->sense, point, at, &value))
        return false;
    for (int a = 0; a < 3; a++)
        corner |= (at[a] >= 0.5) << a;
    *out = (leafcast_sample){.inside = true,
                             .cell = c->number,
                             .at = {at[0], at[1], at[2]},
                             .value = value,
                             .nearest = c->hexahedron.value[corner]};
    (void)hex_point_gradient(&c->hexahedron, at, out->gradient);
    return true;
}

/* The parameters of a point on the cell. Where rounding puts it beside the cell, the cell's middle
 * stands in. */
static void locate(const hex_cell *c, const double point[3], double at[3]) {
    double value;
    if (!hex_point_find(&c->hexahedron, c->sense, point, at, &value))
        at[0] = at[1] = at[2] = 0.5;
}

void hex_walk_gradient(const hex_cell *c, const ray *r, const segment *s, segment_gradient *out) {
    double b[3][4];
    for (int i = 0; i < 4; i++) {
        const double t = segment_t(s, i / 3.0);
        double point[3], at[3], gradient[3];
        for (int a = 0; a < 3; a++)
            point[a] = r->o[a] + t * r->d[a];
        locate(c, point, at);
        (void)hex_point_gradient(&c->hexahedron, at, gradient);
        for (int a = 0; a < 3; a++)
            b[a][i] = gradient[a];
    }
    *out = segment_gradient_through((const double(*)[4])b);
}

void hex_walk_at(const hex_cell *c, const ray *r, double t, leafcast_hit *out) {
    double point[3];
    for (int a = 0; a < 3; a++)
        point[a] = r->o[a] + t * r->d[a];
    locate(c, point, out->at);
    out->flat = c->sense == 0;
}

void hex_walk_corners(const hexahedron *h, leafcast_cell *out) {
    out->corners = HEX_CORNERS;
    for (int c = 0; c < HEX_CORNERS; c++) {
        out->value[c] = (float)h->value[c];
        for (int a = 0; a < 3; a++)
            out->position[c][a] = h->p[c][a];
    }
}

/* ---- Errors ---- */

segments_error hex_walk_error(const double box[2][3], double tolerance, const ray *r,
                              const double range[2]) {
    double reach = 0.0;
    for (int a = 0; a < 3; a++)
        reach += fmax(fabs(box[0][a] - r->o[a]), fabs(box[1][a] - r->o[a]));
    return (segments_error){.t = 0x1p20 * 16.0 * DBL_EPSILON * reach / vec3_length(r->d),
                            .value = tolerance +
                                     64.0 * DBL_EPSILON * fmax(fabs(range[0]), fabs(range[1]))};
}

double hex_walk_tolerance(double least, double most) {
    const double range = most - least;
    return range > 0.0 ? 0x1p-22 * range : 1.0;
}
