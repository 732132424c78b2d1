#include "render/curvilinear/curvilinear_walk.h"

#include "formats/base/vec3.h"
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
    return hex_code_sense(curvilinear_lattice_code(l, index));
}

curved_cell curvilinear_walk_hexahedron(const curvilinear_lattice *l, uint32_t index) {
    return (curved_cell){.hexahedron = curvilinear_walk_cell(l, index),
                         .sense = curvilinear_walk_sense(l, index),
                         .number = l->first + index};
}

/* ---- A ray's cells ---- */

typedef struct cell_way {
    hex_way way;
    const curvilinear_lattice *lattice;
    hex_block_fn cells;
    const isovalue_list *isos; /* blocks without these on the ray are passed over; NULL: none is */
    tree_passages passages;
    tree_passage at;
    const curvilinear_place *place;
    uint64_t ahead; /* cells of the block that are yet to come */
} cell_way;

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
        rate += p->gradient[a] * w->way.ray->d[a];
    }
    if (!box_interval_in(line, lo, hi, &in))
        return false;
    const double reach = real_max(fabs(in.t_in), fabs(in.t_out));
    for (int a = 0; a < 3; a++)
        size += fabs(p->gradient[a]) *
                (fabs(line->o[a]) + fabs(p->from[a]) + reach * fabs(w->way.ray->d[a]));
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
    return active & w->cells(&b, &w->way.sheared) << (4 * row[0] + 16 * slab[0]);
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

/* hex_way.next: cells that are not beside the ray, block by block. */
static bool next_cell(hex_way *way, double limit, curved_cell *out) {
    cell_way *w = (cell_way *)way;
    if (!next_block(w, limit))
        return false;
    const unsigned bit = (unsigned)__builtin_ctzll(w->ahead);
    w->ahead &= w->ahead - 1;
    way->counters->cells++;
    *out = curvilinear_walk_hexahedron(w->lattice,
                                       curvilinear_lattice_cell(w->lattice, w->place, bit));
    return true;
}

static void begin_way(cell_way *w, const curvilinear_lattice *l, hex_block_fn cells,
                      const isovalue_list *isos, const ray *r, const hit *after,
                      ray_counters *counters) {
    w->way = (hex_way){r, sheared_ray_of(r->o, r->d), counters, next_cell};
    w->lattice = l;
    w->cells = cells;
    w->isos = isos;
    w->at = (tree_passage){.t_in = -INFINITY};
    w->ahead = 0;
    tree_passages_begin(&w->passages, &l->tree, r, after, counters);
}

/* ---- Hits and pieces ---- */

bool curvilinear_walk_hits(const curvilinear_lattice *l, hex_block_fn cells,
                           const isovalue_list *isos, const ray *r, trace_state *state,
                           ray_counters *counters, path_counts *counts) {
    cell_way w;
    begin_way(&w, l, cells, isos, r, &state->after, counters);
    return hex_walk_hits(&w.way, isos, state, counts);
}

void curvilinear_walk_pieces(const curvilinear_lattice *l, hex_block_fn cells, double above,
                             double tolerance, const ray *r, const hit *after, double limit,
                             hex_taker *take, void *ctx, ray_counters *counters,
                             path_counts *counts) {
    cell_way w;
    begin_way(&w, l, cells, NULL, r, after, counters);
    hex_walk_pieces(&w.way, above, tolerance, limit, take, ctx, counts);
}

void curvilinear_walk_hold(const curvilinear_lattice *l, hex_block_fn cells, uint32_t id,
                           double above, double tolerance, const ray *r, const hit *after,
                           segments_state *state, ray_counters *counters) {
    cell_way w;
    begin_way(&w, l, cells, NULL, r, after, counters);
    hex_walk_hold(&w.way, id, above, tolerance, state);
}

void curvilinear_walk_extremes(const curvilinear_lattice *l, hex_block_fn cells, uint32_t id,
                               double tolerance, const ray *r, const ray *part,
                               extreme_state *state, ray_counters *counters) {
    const hit before = hit_from(part->t0);
    cell_way w;
    begin_way(&w, l, cells, NULL, r, &before, counters);
    hex_walk_extremes(&w.way, id, tolerance, part->t1, state);
}

/* ---- Points ---- */

static bool find_in(const curvilinear_lattice *l, uint32_t index, const double point[3],
                    leafcast_sample *out) {
    if (curvilinear_lattice_code(l, index) == HEX_NONE)
        return false;
    const curved_cell c = curvilinear_walk_hexahedron(l, index);
    return hex_walk_sample(&c, point, out);
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
