#include "render/heights/heights_walk.h"

#include "render/heights/heights_way.h"

/* ---- Nodes on the way ---- */

typedef struct quad_child {
    double t_in, t_out;
    unsigned octant; /* x + 4z, as in the directory */
} quad_child;

/* Set children[] to those that the ray passes, in order. Returns their number, 1 to 3. A crossing
 * at the interval's very start counts as still to come, so that visits without length are kept. */
static int quad_step(const ray *r, const double middle[2], double t_in, double t_out,
                     quad_child children[3]) {
    double t[2];
    int order[2], crossings = 0;
    unsigned octant = 0;
    for (int a = 0; a < 2; a++) {
        const double d = r->d[2 * a];
        if (d == 0.0) {
            octant |= (unsigned)(r->held[2 * a] >= middle[a]) << 2 * a;
            continue;
        }
        t[a] = (middle[a] - r->o[2 * a]) / d;
        const bool to_come = t[a] >= t_in;
        octant |= (unsigned)(to_come == (d < 0.0)) << 2 * a;
        if (to_come && t[a] <= t_out)
            order[crossings++] = a;
    }
    if (crossings == 2 && t[1] < t[0]) {
        order[0] = 1;
        order[1] = 0;
    }
    double from = t_in;
    for (int i = 0; i < crossings; i++) {
        children[i] = (quad_child){from, t[order[i]], octant};
        from = t[order[i]];
        octant ^= 1U << 2 * order[i];
    }
    children[crossings] = (quad_child){from, t_out, octant};
    return crossings + 1;
}

/* ---- In a treelet ---- */

bool heights_walk_block(const heights_block *b, const ray *r, double t_in, double t_out,
                        unsigned octants, trace_state *state, ray_counters *counters) {
    const hit before = state->best;
    heights_way w;
    heights_patch p;
    int cell[2];
    heights_way_begin(&w, b, r, t_in, t_out, octants);
    while (heights_way_next(&w, state->best.t, cell, &p)) {
        heights_root roots[2];
        const int count = heights_patch_roots(&p, r, roots);
        counters->cells++;
        for (int i = 0; i < count; i++) {
            const hit h = {roots[i].t, heights_block_cell(b, (uint32_t)cell[0], (uint32_t)cell[1]),
                           0, roots[i].entering};
            if (h.t < r->t0 || h.t > r->t1 || !hit_less(&state->after, &h) ||
                !hit_less(&h, &state->best))
                continue;
            counters->roots++;
            state->best = h;
        }
    }
    return hit_less(&state->best, &before);
}

/* ---- The directory ---- */

typedef struct passage {
    double t_in, t_out;
    uint32_t t, octants; /* octants: not 0: these eighths of the treelet stand in for others */
} passage;

enum { PASSAGES_MAX = 3 * LEAF_LEVELS_MAX };

static bool drawn(const tracer *tr, const passage *p) {
    return p->octants || tr->layout->level_of[p->t] == tr->target_level ||
           (tr->stop && tr->stop[p->t]);
}

/* In a preview, let a treelet stand in for its child that is absent. Returns whether anything is
 * drawn. */
static bool stand_in(const tracer *tr, const passage *of, unsigned octant, passage *child,
                     bool *provisional) {
    if (!tr->preview || !tr->treelets->own[child->t] || loader_lookup(tr->treelets, child->t))
        return true;
    *provisional = true;
    child->t = of->t;
    child->octants = 1U << octant;
    return loader_lookup(tr->treelets, of->t) != NULL;
}

static int push(const tracer *tr, const ray *r, const passage *p, passage *stack, int top,
                bool *provisional) {
    const leaf_layout *l = tr->layout;
    const float(*ranges)[2] =
        (const float(*)[2])tr->treelets->file->ranges + leaf_layout_samples(l, tr->set, 0);
    const unsigned active = tr->treelets->children[p->t], there = leaf_layout_children(l, p->t);
    const uint32_t level = l->level_of[p->t], half = 1U << (l->cells_log2 - 1);
    double middle[2];
    quad_child children[3];
    for (int a = 0; a < 2; a++)
        middle[a] = ldexp((double)((l->place[p->t][2 * a] << l->cells_log2) + half), (int)level);
    for (int i = quad_step(r, middle, p->t_in, p->t_out, children); i-- > 0;) {
        const unsigned o = children[i].octant;
        if (!(active >> o & 1U))
            continue;
        passage child = {
            children[i].t_in, children[i].t_out,
            l->first_child[p->t] + (uint32_t)__builtin_popcount(there & ((1U << o) - 1U)), 0};
        const float *range = ranges[child.t];
        if (heights_meets(r, child.t_in, child.t_out, (double)range[0], (double)range[1]) &&
            stand_in(tr, p, o, &child, provisional))
            stack[top++] = child;
    }
    return top;
}

static void walk_treelet_at(const tracer *tr, const treelet *at, const passage *p, const ray *r,
                            trace_state *state, ray_counters *counters) {
    const heights_block b = heights_block_of(tr, at);
    if (heights_walk_block(&b, r, p->t_in, p->t_out, p->octants ? p->octants : 255U, state,
                           counters) &&
        !state->any)
        state->point = heights_hit_surface(tr, at, r, &state->best);
}

trace_result heights_walk_next(const tracer *tr, const ray *r, trace_state *state,
                               ray_counters *counters) {
    double t_in = heights_most(heights_most(r->t0, state->after.t), state->t_from);
    double t_out = r->t1;
    /* When resuming, everything in front of the treelet that blocked has been walked. */
    bool resuming = state->blocked != LEAF_NO_TREELET;
    passage stack[PASSAGES_MAX];
    int top = 0;
    if (tracer_box(tr, r, &t_in, &t_out))
        stack[top++] = (passage){t_in, t_out, 0, 0};
    while (top > 0) {
        const passage p = stack[--top];
        if (p.t_in > state->best.t)
            break;
        if (!drawn(tr, &p)) {
            counters->nodes++;
            top = push(tr, r, &p, stack, top, &state->provisional);
            continue;
        }
        if (!tr->treelets->own[p.t] || (resuming && !tracer_resumes(tr, p.t, state->blocked)))
            continue;
        const treelet *at =
            tracer_enter(tr, p.t, p.t_in, &state->t_from, &state->blocked, &state->provisional);
        if (!at && state->blocked != LEAF_NO_TREELET)
            return TRACE_BLOCKED;
        resuming = false;
        if (at)
            walk_treelet_at(tr, at, &p, r, state, counters);
    }
    return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
}

/* ---- Surfaces ---- */

/* A bound of the distance between a computed point of the ray and the true one, along an axis. */
static double position_error(const affine *space, const ray *r, double t, int a) {
    double sum = fabs(r->o[a]) + fabs(t * r->d[a]);
    for (int i = 0; i < 3; i++) {
        double world = fabs(space->to_world[i][3]);
        for (int b = 0; b < 3; b++)
            world += fabs(space->to_world[i][b]) * (fabs(r->o[b]) + fabs(t * r->d[b]));
        sum += fabs(space->to_grid[a][i]) * world;
    }
    return 4.0 * DBL_EPSILON * sum;
}

surface_point heights_hit_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h) {
    const heights_field *field = tr->own;
    const heights_block b = heights_block_of(tr, at);
    const uint32_t i = (uint32_t)(h->cell % b.cells[0]), k = (uint32_t)(h->cell / b.cells[0]);
    heights_patch p;
    surface_point out = {.span = b.size * heights_least(field->unit[0], field->unit[2])};
    (void)heights_block_patch(&b, i - b.of->first_cell[0], k - b.of->first_cell[2], &p);
    double slope[3], most = 0.0;
    for (int c = 0; c < 4; c++)
        most = heights_most(most, fabs(p.h[c]));
    out.own[0] = (float)heights_hit_slope(&tr->space, &p, r, h->t, slope, out.gradient, out.normal);
    out.error = 32.0 * DBL_EPSILON * most;
    for (int a = 0; a < 3; a++)
        out.error += fabs(slope[a]) * position_error(&tr->space, r, h->t, a);
    return out;
}
