#include "render/triangle/triangle_walk.h"

#include "render/walk/box_interval.h"
#include "render/walk/tree_passage.h"

triangle triangle_walk_one(const triangle_blocks *b, uint32_t local) {
    const uint16_t *v = b->rows[local];
    triangle x;
    for (int k = 0; k < TRIANGLE_CORNERS; k++) {
        for (int a = 0; a < 3; a++)
            x.p[k][a] = b->p[a][v[k]];
        x.value[k] = b->values[v[k]];
    }
    return x;
}

/* Whether the ray meets the box of a triangle, which costs less than the triangle. */
static bool passes_box(const box_line *line, const triangle *x) {
    double lo[3], hi[3];
    box_interval in;
    for (int a = 0; a < 3; a++) {
        float least = x->p[0][a], most = least;
        for (int k = 1; k < TRIANGLE_CORNERS; k++) {
            least = x->p[k][a] < least ? x->p[k][a] : least;
            most = x->p[k][a] > most ? x->p[k][a] : most;
        }
        lo[a] = (double)least;
        hi[a] = (double)most;
    }
    return box_interval_in(line, lo, hi, &in);
}

static bool meet(const triangle *x, uint64_t number, const ray *r, trace_state *state,
                 ray_counters *counters) {
    const hit *after = &state->after, from = {after->t, 0, -1, false},
              behind = {after->t, UINT64_MAX, after->iso, after->entering};
    flat_polygon g;
    hit found = {.t = 0.0};
    triangle_polygon(x, &g);
    counters->cells++;
    if (!flat_polygon_hit(&g, r, number, 0, &from, &found) || !triangle_less(&behind, &found))
        return false;
    counters->roots++;
    if (!triangle_less(&found, &state->best))
        return false;
    state->best = found;
    return true;
}

bool triangle_walk_hits(const triangle_blocks *b, bool coloured, const ray *r, trace_state *state,
                        ray_counters *counters) {
    tree_passages passages;
    tree_passage at = {.t_in = -INFINITY};
    box_line line = box_line_of(r);
    triangle best;
    bool changed = false;
    line.t0 = -INFINITY;
    line.t1 = INFINITY;
    tree_passages_begin(&passages, &b->tree, r, &state->after, counters);
    while ((at = tree_passages_next(&passages, at, state->best.t)).t != LEAF_NO_TREELET) {
        for (unsigned left = b->active[at.t]; left; left &= left - 1) {
            const uint32_t i = TRIANGLE_BLOCK * at.t + (uint32_t)__builtin_ctz(left);
            const uint64_t number = triangle_blocks_number(b, i);
            const triangle x = triangle_walk_one(b, i);
            /* A flat piece that the ray begins on is met nowhere else. */
            if (number == state->origin || !passes_box(&line, &x) ||
                !meet(&x, number, r, state, counters))
                continue;
            best = x;
            changed = true;
            if (state->any)
                return true;
        }
    }
    if (changed)
        state->point = triangle_point(&best, r, &state->best, coloured);
    return changed;
}
