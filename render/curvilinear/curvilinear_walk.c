#include "render/curvilinear/curvilinear_walk.h"

#include <float.h>

#include "formats/base/vec3.h"
#include "render/curved/hex_meet.h"
#include "render/curved/hex_pieces.h"
#include "render/curved/hex_point.h"
#include "render/walk/cell_walks.h"
#include "render/walk/tree_passage.h"
#include "render/walk/tree_points.h"

#define WIDEN 0x1p-40 /* bounds are wider than computed by this, relative to their terms */

/* ---- A cell ---- */

hexahedron curvilinear_walk_cell(const curvilinear_lattice *l, uint32_t index) {
    const uint32_t i = index % l->cells[0], j = index / l->cells[0] % l->cells[1],
                   k = index / (l->cells[0] * l->cells[1]);
    hexahedron h;
    for (uint32_t c = 0; c < HEX_CORNERS; c++) {
        const uint32_t node =
            i + (c & 1) + l->nodes[0] * (j + (c >> 1 & 1) + l->nodes[1] * (k + (c >> 2)));
        for (int a = 0; a < 3; a++)
            h.p[c][a] = (double)l->p[a][node];
        h.value[c] = (double)l->values[node];
    }
    return h;
}

int curvilinear_walk_sense(const curvilinear_lattice *l, uint32_t index) {
    const curvilinear_code code = curvilinear_lattice_code(l, index);
    return code == CURVILINEAR_RIGHT ? 1 : code == CURVILINEAR_LEFT ? -1 : 0;
}

void curvilinear_walk_range(const hexahedron *h, double range[2]) {
    range[0] = range[1] = h->value[0];
    for (int c = 1; c < HEX_CORNERS; c++) {
        range[0] = real_min(range[0], h->value[c]);
        range[1] = real_max(range[1], h->value[c]);
    }
}

/* ---- A ray's cells ---- */

typedef struct cell_way {
    const curvilinear_lattice *lattice;
    hex_block_fn cells;
    const isovalue_list *isos; /* blocks without these on the ray are passed over; NULL: none is */
    double above;              /* subtracted from all values */
    const ray *ray;
    sheared_ray sheared;
    tree_passages passages;
    tree_passage at;
    const curvilinear_place *place;
    uint64_t ahead; /* cells of the block that are yet to come */
} cell_way;

typedef struct way_cell {
    uint32_t number; /* in the treelet */
    int sense;
    hexahedron hexahedron;
} way_cell;

static void begin_way(cell_way *w, const curvilinear_lattice *l, hex_block_fn cells, double above,
                      const isovalue_list *isos, const ray *r, const hit *after,
                      ray_counters *counters) {
    w->lattice = l;
    w->cells = cells;
    w->isos = isos;
    w->above = above;
    w->ray = r;
    w->sheared = sheared_ray_of(r);
    w->at = (tree_passage){.t_in = -INFINITY};
    w->ahead = 0;
    tree_passages_begin(&w->passages, &l->tree, r, after, counters);
}

/* Whether a block may have an isovalue on the ray. What cannot be compared may. */
static bool may_hit(const cell_way *w, uint32_t block) {
    const curvilinear_plane *p = &w->lattice->planes[block];
    const box_line *line = &w->passages.slabs;
    const float *bounds = w->lattice->tree.bounds[0][block];
    double lo[3], hi[3], start = 0.0, rate = 0.0, size = 0.0;
    box_interval in;
    for (int a = 0; a < 3; a++) {
        lo[a] = (double)bounds[a];
        hi[a] = (double)bounds[a + 3];
        start += p->gradient[a] * (line->o[a] - p->from[a]);
        rate += p->gradient[a] * w->ray->d[a];
    }
    if (!box_interval_in(line, lo, hi, &in))
        return false;
    const double reach = real_max(fabs(in.t_in), fabs(in.t_out));
    for (int a = 0; a < 3; a++)
        size += fabs(p->gradient[a]) *
                (fabs(line->o[a]) + fabs(p->from[a]) + reach * fabs(w->ray->d[a]));
    const double end[2] = {start + rate * in.t_in, start + rate * in.t_out};
    const double room = WIDEN * (size + fabs(p->rest[0]) + fabs(p->rest[1]));
    const double least = real_min(end[0], end[1]) + p->rest[0] - room,
                 most = real_max(end[0], end[1]) + p->rest[1] + room;
    for (int i = 0; i < w->isos->count; i++)
        if (!(w->isos->isovalues[i] < least || w->isos->isovalues[i] > most))
            return true;
    return false;
}

/* The active cells of a block that are not beside the ray: of the rows and slabs that have any. */
static uint64_t cells_ahead(const cell_way *w, uint32_t block) {
    const curvilinear_lattice *l = w->lattice;
    const curvilinear_place *place = &l->places[block];
    const uint64_t active = l->active[block];
    const uint32_t rows =
        (uint32_t)((active | active >> 16 | active >> 32 | active >> 48) & 0xffff);
    const unsigned slab[2] = {(unsigned)__builtin_ctzll(active) >> 4,
                              (63 - (unsigned)__builtin_clzll(active)) >> 4};
    const unsigned row[2] = {(unsigned)__builtin_ctz(rows) >> 2,
                             (31 - (unsigned)__builtin_clz(rows)) >> 2};
    const uint32_t node =
        curvilinear_lattice_node(l, place) + l->nodes[0] * (row[0] + l->nodes[1] * slab[0]);
    const hex_block b = {.p = {l->p[0] + node, l->p[1] + node, l->p[2] + node},
                         .row = l->nodes[0],
                         .slab = l->nodes[0] * l->nodes[1],
                         .cells = {place->cells[0], row[1] - row[0] + 1, slab[1] - slab[0] + 1}};
    return active & w->cells(&b, &w->sheared) << (4 * row[0] + 16 * slab[0]);
}

static bool next_block(cell_way *w, double limit) {
    while (!w->ahead) {
        w->at = tree_passages_next(&w->passages, w->at, limit);
        if (w->at.t == LEAF_NO_TREELET)
            return false;
        if (w->isos && !may_hit(w, w->at.t))
            continue;
        w->place = &w->lattice->places[w->at.t];
        w->ahead = cells_ahead(w, w->at.t);
    }
    return true;
}

/* Go on to the next cell that is not beside the ray, in a block that the ray enters at `limit` or
 * before. Returns false if there is none. */
static bool next_cell(cell_way *w, double limit, way_cell *out) {
    if (!next_block(w, limit))
        return false;
    out->number =
        curvilinear_lattice_cell(w->lattice, w->place, (unsigned)__builtin_ctzll(w->ahead));
    w->ahead &= w->ahead - 1;
    w->passages.counters->cells++;
    out->sense = curvilinear_walk_sense(w->lattice, out->number);
    out->hexahedron = curvilinear_walk_cell(w->lattice, out->number);
    for (int c = 0; c < HEX_CORNERS; c++)
        out->hexahedron.value[c] -= w->above;
    return true;
}

/* ---- Hits ---- */

/* A root, and what its surface point is made of. */
typedef struct best_root {
    hexahedron hexahedron;
    double at[3];
} best_root;

static void take_roots(const cell_way *w, const way_cell *c, const isovalue_list *isos,
                       const ray *r, trace_state *state, best_root *best, hex_counts *counts) {
    double range[2];
    curvilinear_walk_range(&c->hexahedron, range);
    for (int i = 0; i < isos->count; i++) {
        hex_root roots[HEX_ROOTS];
        if (!(range[0] < isos->isovalues[i] && isos->isovalues[i] <= range[1]))
            continue;
        const int count = hex_meet_roots(&c->hexahedron, c->sense, &w->sheared, isos->isovalues[i],
                                         roots, counts);
        for (int n = 0; n < count; n++) {
            const hit h = {roots[n].t, w->lattice->first + c->number, i, roots[n].entering};
            if (!cell_hit(state, r, &h))
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
surface_point curvilinear_walk_surface(const hexahedron *h, const double at[3], const ray *r,
                                       double t) {
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

bool curvilinear_walk_hits(const curvilinear_lattice *l, hex_block_fn cells,
                           const isovalue_list *isos, const ray *r, trace_state *state,
                           ray_counters *counters, hex_counts *counts) {
    const hit before = state->best;
    cell_way w;
    way_cell c;
    best_root best;
    begin_way(&w, l, cells, 0.0, isos, r, &state->after, counters);
    while (next_cell(&w, state->best.t, &c)) {
        const hit last = state->best;
        take_roots(&w, &c, isos, r, state, &best, counts);
        if (!hit_less(&state->best, &last))
            continue;
        counters->roots++;
        if (state->any)
            return true;
    }
    if (!hit_less(&state->best, &before))
        return false;
    state->point = curvilinear_walk_surface(&best.hexahedron, best.at, r, state->best.t);
    return true;
}

/* ---- Pieces ---- */

void curvilinear_walk_pieces(const curvilinear_lattice *l, hex_block_fn cells, double above,
                             double tolerance, const ray *r, const hit *after, double limit,
                             curvilinear_take *take, void *ctx, ray_counters *counters,
                             hex_counts *counts) {
    cell_way w;
    way_cell c;
    begin_way(&w, l, cells, above, NULL, r, after, counters);
    while (next_cell(&w, limit, &c)) {
        hex_path path;
        hex_piece pieces[HEX_PIECES];
        double range[2];
        if (hex_path_of(&c.hexahedron, c.sense, &w.sheared, &path) == 0)
            continue;
        curvilinear_walk_range(&c.hexahedron, range);
        const int count = hex_pieces(&c.hexahedron, c.sense, &path, tolerance, pieces, counts);
        for (int n = 0; n < count; n++) {
            segment s = {.t0 = pieces[n].t[0],
                         .t1 = pieces[n].t[1],
                         .spread = range[0] == range[1] ? SEGMENT_EVEN : 0.0,
                         .cell = l->first + c.number,
                         .degree = 3};
            for (int k = 0; k < 4; k++)
                s.b[k] = pieces[n].b[k];
            if (segment_cut(&s, r))
                take(ctx, &s);
        }
    }
}

/* ---- Points ---- */

static bool find_in(const curvilinear_lattice *l, uint32_t index, const double point[3],
                    leafcast_sample *out) {
    double at[3], value;
    const hexahedron h = curvilinear_walk_cell(l, index);
    if (curvilinear_lattice_code(l, index) == CURVILINEAR_NONE ||
        !hex_point_find(&h, curvilinear_walk_sense(l, index), point, at, &value))
        return false;
    int corner = 0;
    for (int a = 0; a < 3; a++)
        corner |= (at[a] >= 0.5) << a;
    *out = (leafcast_sample){.inside = true,
                             .cell = l->first + index,
                             .at = {at[0], at[1], at[2]},
                             .value = value,
                             .nearest = h.value[corner]};
    (void)hex_point_gradient(&h, at, out->gradient);
    return true;
}

bool curvilinear_walk_point(const curvilinear_lattice *l, const double point[3],
                            leafcast_sample *out) {
    uint32_t b = LEAF_NO_TREELET;
    while ((b = tree_box_at(&l->tree, point, b)) != LEAF_NO_TREELET) {
        const curvilinear_place *place = &l->places[b];
        for (unsigned bit = 0; bit < 64; bit++)
            if ((bit & 3) < place->cells[0] && (bit >> 2 & 3) < place->cells[1] &&
                bit >> 4 < place->cells[2] &&
                find_in(l, curvilinear_lattice_cell(l, place, bit), point, out))
                return true;
    }
    return false;
}
