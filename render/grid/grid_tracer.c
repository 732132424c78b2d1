#include "render/grid/grid_tracer.h"

#include "render/grid/grid_passage.h"
#include "render/grid/surface.h"

surface_point grid_tracer_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h) {
    const walk_scene *scene = tr->own;
    return surface_at(scene, &tr->space, resident_grid_of(at), r, h, scene->analytic_normals);
}

static void walk_resident(const tracer *tr, const ray *r, const treelet *at,
                          const grid_passage *node, trace_state *state, ray_counters *counters) {
    const walk_scene *scene = tr->own;
    const unsigned octants = node->octants ? node->octants : 255u;
    if (scene->walk(scene, resident_grid_of(at), r, node->t_in, node->t_out, octants, &state->after,
                    &state->best, counters))
        state->point = grid_tracer_surface(tr, at, r, &state->best);
}

trace_result grid_tracer_next(const tracer *tr, const ray *r, trace_state *state,
                              ray_counters *counters) {
    double t_in = fmax(fmax(r->t0, state->after.t), state->t_from), t_out = r->t1;
    if (!tracer_box(tr, r, &t_in, &t_out))
        return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
    /* When resuming, everything in front of the treelet that blocked has been walked. */
    bool resuming = state->blocked != LEAF_NO_TREELET;
    grid_passage stack[GRID_PASSAGES_MAX];
    int top = 0;
    stack[top++] = (grid_passage){t_in, t_out, 0, 0};
    while (top > 0) {
        const grid_passage node = stack[--top];
        if (node.t_in > state->best.t)
            break;
        if (!grid_passage_drawn(tr, &node)) {
            counters->nodes++;
            top = grid_passage_push(tr, r, &node, stack, top, &state->provisional);
            continue;
        }
        if (!tr->treelets->own[node.t] || (resuming && !tracer_resumes(tr, node.t, state->blocked)))
            continue;
        const treelet *at = tracer_enter(tr, node.t, node.t_in, &state->t_from, &state->blocked,
                                         &state->provisional);
        if (!at && state->blocked != LEAF_NO_TREELET)
            return TRACE_BLOCKED;
        resuming = false;
        if (at)
            walk_resident(tr, r, at, &node, state, counters);
    }
    return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
}
