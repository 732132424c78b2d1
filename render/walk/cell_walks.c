#include "render/walk/cell_walks.h"

#include "formats/base/box3.h"
#include "formats/leaf/leaf_cells.h"
#include "render/look/scene_facts.h"
#include "render/ray/open_volume.h"
#include "render/walk/tree_passage.h"
#include "render/walk/tree_pieces.h"
#include "render/walk/tree_points.h"

static cell cell_of(const treelet *at, uint32_t i) {
    const resident_cells *own = resident_cells_of(at);
    return (cell){(const char *)at->payload + (size_t)i * own->record_bytes, own->first + i};
}

/* ---- In a treelet ---- */

/* The cells on a ray's way. */
typedef struct cell_way {
    tree_passages passages;
    tree_passage at;
} cell_way;

static void begin_way(cell_way *w, const treelet *at, const ray *r, const hit *after,
                      ray_counters *counters) {
    w->at = (tree_passage){.t_in = -INFINITY};
    tree_passages_begin(&w->passages, &resident_cells_of(at)->tree, r, after, counters);
}

/* Go on to the next cell that the ray enters at `limit` or before. Returns false if there is none.
 */
static bool next_cell(cell_way *w, const treelet *at, double limit, cell *out) {
    w->at = tree_passages_next(&w->passages, w->at, limit);
    if (w->at.t == LEAF_NO_TREELET)
        return false;
    w->passages.counters->cells++;
    *out = cell_of(at, w->at.t);
    return true;
}

static bool walk_hits(const tracer *tr, const treelet *at, const ray *r, trace_state *state,
                      ray_counters *counters) {
    const hit before = state->best;
    cell_way w;
    cell c, of = {0};
    begin_way(&w, at, r, &state->after, counters);
    while (next_cell(&w, at, state->best.t, &c)) {
        const hit last = state->best;
        tr->kind->cells->hits(tr, &c, r, state);
        if (!hit_less(&state->best, &last))
            continue;
        counters->roots++;
        of = c;
        if (state->any)
            return true;
    }
    if (!hit_less(&state->best, &before))
        return false;
    state->point = tr->kind->cells->surface(tr, &of, r, &state->best);
    return true;
}

static bool piece_of(const tracer *tr, const treelet *at, const cell *c, const ray *r,
                     segment *out) {
    *out = (segment){.cell = c->number, .treelet = at->id, .degree = tr->kind->degree};
    return tr->kind->cells->piece(c, r, out) && segment_cut(out, r);
}

static void walk_pieces(const tracer *tr, const treelet *at, const ray *r, const hit *after,
                        segments_state *state, ray_counters *counters) {
    cell_way w;
    cell c;
    segment s;
    begin_way(&w, at, r, after, counters);
    while (next_cell(&w, at, state->limit.t0, &c)) {
        if (!piece_of(tr, at, &c, r, &s))
            continue;
        for (uint32_t k = 0; k <= s.degree; k++)
            s.b[k] -= tr->above;
        tree_pieces_hold(state, &s);
    }
}

static void walk_extremes(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                          extreme_state *s, ray_counters *counters) {
    const resident_cells *own = resident_cells_of(at);
    const hit before = hit_before_all();
    cell_way w;
    cell c;
    segment piece;
    begin_way(&w, at, part, &before, counters);
    while (next_cell(&w, at, INFINITY, &c)) {
        const double most = (double)extreme_bound(s, own->ranges[c.number - own->first]);
        if (most < s->score || !piece_of(tr, at, &c, r, &piece))
            continue;
        const segment_extent e = segment_range(&piece);
        extreme_offer(s, fmin(s->least ? -e.least : e.most, most), s->least ? e.least_t : e.most_t,
                      at->id);
    }
}

const treelet_walks cell_walks = {walk_hits, walk_pieces, walk_extremes};

void cell_walks_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                         segment_gradient *out) {
    const cell c = cell_of(at, (uint32_t)(s->cell - resident_cells_of(at)->first));
    double gradient[3], b[3][4];
    for (int i = 0; i < 4; i++) {
        const double t = segment_t(s, i / 3.0);
        const double point[3] = {r->o[0] + t * r->d[0], r->o[1] + t * r->d[1],
                                 r->o[2] + t * r->d[2]};
        (void)tr->kind->cells->value(&c, point, gradient);
        for (int a = 0; a < 3; a++)
            b[a][i] = gradient[a];
    }
    *out = segment_gradient_through((const double(*)[4])b);
}

/* ---- Cells ---- */

void cell_walks_cell_in(const leafcast *v, const treelet *at, const double point[3],
                        leafcast_sample *out) {
    const treelet_tree *tree = &resident_cells_of(at)->tree;
    uint32_t i = LEAF_NO_TREELET;
    while ((i = tree_box_at(tree, point, i)) != LEAF_NO_TREELET) {
        const cell c = cell_of(at, i);
        if (!v->kind->cells->holds(&c, point))
            continue;
        *out = (leafcast_sample){.inside = true, .treelet = at->id, .cell = c.number};
        out->value = out->nearest = v->kind->cells->value(&c, point, out->gradient);
        return;
    }
}

/* ---- A volume and a frame ---- */

void cell_walks_describe(const leafcast *v, uint32_t step, leafcast_info *info) {
    const leaf_cells_directory *d = leaf_cells_directory_of(v->file);
    info->cells = d->first[v->file->layout.treelets];
    tree_describe(v, step, 1.0 / (double)info->cells, info);
}

status cell_walks_check(const leafcast *v, const leafcast_scene *scene) {
    if (scene_intersector(scene) != LEAFCAST_MARMITT || scene->smooth_normals)
        return status_describe(ST_USAGE, "a %s has no intersectors or smooth normals",
                               v->kind->name);
    return volume_check_level(v, scene);
}

void cell_walks_aim(leafcast *v, const leafcast_scene *scene, const struct camera *c, tracer *tr) {
    (void)scene, (void)c;
    box3_of_floats(v->file->header.bounds, tr->box);
}
