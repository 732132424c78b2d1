#include "render/curved/hex_walk.h"

#include <float.h>

#include "formats/base/vec3.h"
#include "formats/curved/quadratic_path.h"
#include "render/curved/curved_meet.h"
#include "render/curved/hex_pieces.h"
#include "render/walk/cell_walks.h"
#include "render/walk/tree_pieces.h"

/* ---- Hits ---- */

/* A root, and what its surface point is made of. */
typedef struct best_root {
    curved_cell cell;
    double at[3];
} best_root;

static void take_roots(const hex_way *w, const curved_cell *c, const isovalue_list *isos,
                       trace_state *state, best_root *best, path_counts *counts) {
    double range[2];
    curved_cell_range(c, range);
    for (int i = 0; i < isos->count; i++) {
        path_root roots[PATH_ROOTS];
        if (!(range[0] < isos->isovalues[i] && isos->isovalues[i] <= range[1]))
            continue;
        const int count = curved_meet_roots(c, &w->sheared, isos->isovalues[i], roots, counts);
        for (int n = 0; n < count; n++) {
            const hit h = {roots[n].t, c->number, i, roots[n].entering};
            if (!cell_hit(state, w->ray, &h))
                continue;
            best->cell = *c;
            for (int a = 0; a < 3; a++)
                best->at[a] = roots[n].at[a];
        }
    }
}

/* Collapsed edges are none. */
static double edge_or(const double a[3], const double b[3], double least) {
    double away[3];
    vec3_sub(a, b, away);
    const double length = vec3_length(away);
    return length > 0.0 ? real_min(least, length) : least;
}

static double shortest_edge(const curved_cell *c) {
    double least = INFINITY;
    for (int e = 0; e < QUADRATIC_EDGES && c->quadratic; e++) {
        const int *edge = quadratic_edge(e);
        least = edge_or(c->tet.p[edge[0]], c->tet.p[edge[1]], least);
    }
    for (int n = 0; n < HEX_CORNERS && !c->quadratic; n++)
        for (int bit = 1; bit < HEX_CORNERS; bit *= 2)
            least = edge_or(c->hexahedron.p[n | bit], c->hexahedron.p[n & ~bit], least);
    return least;
}

/* The value errs as if the point were moved by the roundings of its way from the ray's origin and
 * of the cell's corners, and by those of the trilinear form. */
surface_point hex_walk_surface(const curved_cell *c, const double at[3], const ray *r, double t) {
    surface_point p = {.span = shortest_edge(c)};
    double reach = 0.0, range[2];
    curved_cell_range(c, range);
    curved_cell_gradient(c, at, p.gradient, p.normal);
    for (int a = 0; a < 3; a++)
        reach += 2.0 * fabs(r->o[a]) + 2.0 * fabs(t * r->d[a]);
    const double most = real_max(fabs(range[0]), fabs(range[1]));
    p.error = 64.0 * DBL_EPSILON * (reach * vec3_length(p.gradient) + most);
    return p;
}

bool hex_walk_hits(hex_way *w, const isovalue_list *isos, trace_state *state, path_counts *counts) {
    const hit before = state->best;
    curved_cell c;
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
    state->point = hex_walk_surface(&best.cell, best.at, w->ray, state->best.t);
    return true;
}

/* ---- Pieces ---- */

static int pieces_of(const curved_cell *c, const sheared_ray *r, const double range[2],
                     double tolerance, path_piece out[PATH_PIECES], path_counts *counts) {
    if (c->quadratic) {
        quadratic_path path;
        if (quadratic_path_of(&c->tet, c->sense, r, &path) == 0)
            return 0;
        return path_pieces(&path.map, path.part, path.count, c->sense == 0, range, tolerance, out,
                           counts);
    }
    hex_path path;
    return hex_path_of(&c->hexahedron, c->sense, r, &path) == 0
               ? 0
               : hex_pieces(&c->hexahedron, c->sense, &path, tolerance, out, counts);
}

static void take_pieces(const hex_way *w, const curved_cell *c, double tolerance, hex_taker *take,
                        void *ctx, path_counts *counts) {
    path_piece pieces[PATH_PIECES];
    double range[2];
    curved_cell_range(c, range);
    const int count = pieces_of(c, &w->sheared, range, tolerance, pieces, counts);
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
    curved_cell c;
    while (w->next(w, limit, &c)) {
        double *value = curved_cell_values(&c);
        for (int k = 0; k < curved_cell_nodes(&c); k++)
            value[k] -= above;
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

bool hex_walk_sample(const curved_cell *c, const double point[3], leafcast_sample *out) {
    double at[3], value;
    float normal[3];
    if (!curved_cell_find(c, point, at, &value))
        return false;
    *out = (leafcast_sample){.inside = true,
                             .cell = c->number,
                             .at = {at[0], at[1], at[2]},
                             .value = value,
                             .nearest = curved_cell_value(c, curved_cell_nearest(c, at))};
    curved_cell_gradient(c, at, out->gradient, normal);
    return true;
}

/* The parameters of a point on the cell. Where rounding puts it beside the cell, the cell's middle
 * stands in. */
static void locate(const curved_cell *c, const double point[3], double at[3]) {
    double value;
    if (!curved_cell_find(c, point, at, &value))
        at[0] = at[1] = at[2] = c->quadratic ? 0.25 : 0.5;
}

void hex_walk_gradient(const curved_cell *c, const ray *r, const segment *s,
                       segment_gradient *out) {
    double b[3][4];
    for (int i = 0; i < 4; i++) {
        const double t = segment_t(s, i / 3.0);
        double point[3], at[3], gradient[3];
        float normal[3];
        for (int a = 0; a < 3; a++)
            point[a] = r->o[a] + t * r->d[a];
        locate(c, point, at);
        curved_cell_gradient(c, at, gradient, normal);
        for (int a = 0; a < 3; a++)
            b[a][i] = gradient[a];
    }
    *out = segment_gradient_through((const double(*)[4])b);
}

void hex_walk_at(const curved_cell *c, const ray *r, double t, leafcast_hit *out) {
    double point[3];
    for (int a = 0; a < 3; a++)
        point[a] = r->o[a] + t * r->d[a];
    locate(c, point, out->at);
    out->flat = c->sense == 0;
}

void hex_walk_corners(const curved_cell *c, leafcast_cell *out) {
    out->corners = curved_cell_nodes(c);
    for (int n = 0; n < out->corners; n++) {
        out->value[n] = (float)curved_cell_value(c, n);
        for (int a = 0; a < 3; a++)
            out->position[n][a] = curved_cell_place(c, n)[a];
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
