#include "render/mesh/mesh_walk.h"

#include <limits.h>
#include <string.h>

#include "formats/base/exact.h"
#include "formats/mesh/mesh_leaf.h"

tet mesh_walk_tet(const resident_mesh *tr, uint32_t local) {
    const uint16_t *v = mesh_leaf_tets(&tr->mesh, tr->head.payload)[local];
    const float(*at)[3] = tr->positions;
    const float *values = mesh_leaf_values(&tr->mesh, tr->values);
    tet x;
    for (int k = 0; k < 4; k++) {
        for (int a = 0; a < 3; a++)
            x.p[k][a] = at[v[k]][a];
        x.f[k] = values[v[k]];
    }
    return x;
}

void mesh_walk_gradients(const resident_mesh *tr, uint32_t local, float gradients[4][3]) {
    const uint16_t *v = mesh_leaf_tets(&tr->mesh, tr->head.payload)[local];
    for (int k = 0; k < 4; k++)
        memcpy(gradients[k], tr->gradients[v[k]], sizeof gradients[k]);
}

/* ---- Leaves ---- */

/* Returns whether the ray meets the tet's box, which costs less than its isopolygon. */
static bool passes_box(const box_line *line, const tet *x) {
    double lo[3], hi[3];
    box_interval in;
    for (int a = 0; a < 3; a++) {
        float least = x->p[0][a], most = least;
        for (int k = 1; k < 4; k++) {
            least = x->p[k][a] < least ? x->p[k][a] : least;
            most = x->p[k][a] > most ? x->p[k][a] : most;
        }
        lo[a] = (double)least;
        hi[a] = (double)most;
    }
    return box_interval_in(line, lo, hi, &in);
}

static bool test_tet(const isovalue_list *isos, const resident_mesh *tr, uint32_t local,
                     const ray *r, const box_line *line, trace_state *s, ray_counters *counters) {
    const uint64_t cell = tr->first_tet + local;
    const tet x = mesh_walk_tet(tr, local);
    bool changed = false, active = false;
    if (!passes_box(line, &x))
        return false;
    for (int i = 0; i < isos->count; i++) {
        isopolygon g;
        hit found;
        if (cell == s->origin && i == s->origin_iso)
            continue;
        if (!isopolygon_of(&x, isos->isovalues[i], &g))
            continue;
        active = true;
        if (!flat_polygon_next(&g, r, cell, i, &s->after, &found))
            continue;
        counters->roots++;
        if (flat_polygon_less(&found, &s->best)) {
            s->best = found;
            changed = true;
        }
    }
    counters->cells += active;
    return changed;
}

/* ---- Nodes ---- */

typedef struct pending {
    double t_in;
    uint32_t child; /* as in mesh_node */
} pending;

/* Depth times siblings. Loading a file checks that its trees are not deeper. */
enum { STACK_MAX = MESH_DEPTH_MAX * (MESH_CHILDREN - 1) + 1 };

/* A ray, prepared for tests against a treelet's boxes. It reaches the plane of code c of an axis at
 * near + c * slope (near side) or far + c * slope (far side). To be conservative, near is a little
 * too early, and far a little too late. */
typedef struct code_slabs {
    double near[3], far[3], slope[3];
    bool back[3]; /* whether the near side is the upper one */
    double slack;
    double t0, t1, behind;
} code_slabs;

/* Stands for 1 / 0. Times any float it is finite, but larger than any t of a ray. */
static const double never = 0x1p600;

/* Errors: a plane errs by 2^-24 of the treelet's size and coordinates, the kernel by less than
 * `slack`. */
static code_slabs code_slabs_of(const resident_mesh *tr, const ray *r, const hit *after) {
    code_slabs s = {.slack = box_interval_slack(tr->bounds, r, 0.0),
                    .t0 = r->t0,
                    .t1 = r->t1,
                    .behind = box_interval_behind(tr->bounds, r, after)};
    for (int a = 0; a < 3; a++) {
        const double lo = (double)tr->planes.lo[a], step = (double)tr->planes.step[a];
        const double inverse = r->d[a] == 0.0 ? never : 1.0 / r->d[a];
        const double at = (lo - r->o[a]) * inverse;
        const double error = 0x1p-22 * (fabs(lo) + 256.0 * step) * fabs(inverse);
        s.back[a] = r->d[a] < 0.0;
        s.near[a] = at - error;
        s.far[a] = at + error;
        s.slope[a] = step * inverse;
    }
    return s;
}

/* Returns which children of a node the ray meets before `nearest`; t_in: where it enters them. */
static unsigned meet_children(const code_slabs *s, const mesh_node *n, double nearest,
                              double t_in[MESH_CHILDREN]) {
    double t_out[MESH_CHILDREN];
    unsigned met = 0;
    for (int c = 0; c < MESH_CHILDREN; c++) {
        t_in[c] = -INFINITY;
        t_out[c] = INFINITY;
    }
    for (int a = 0; a < 3; a++) {
        const uint8_t *near = s->back[a] ? n->hi[a] : n->lo[a];
        const uint8_t *far = s->back[a] ? n->lo[a] : n->hi[a];
        for (int c = 0; c < MESH_CHILDREN; c++) {
            const double in = s->near[a] + (double)near[c] * s->slope[a];
            const double out = s->far[a] + (double)far[c] * s->slope[a];
            t_in[c] = in > t_in[c] ? in : t_in[c];
            t_out[c] = out < t_out[c] ? out : t_out[c];
        }
    }
    for (int c = 0; c < MESH_CHILDREN; c++) {
        const double slack = BOX_INTERVAL_MARGIN * (fabs(t_in[c]) + fabs(t_out[c])) + s->slack;
        t_in[c] = t_in[c] - slack > s->t0 ? t_in[c] - slack : s->t0;
        t_out[c] = t_out[c] + slack < s->t1 ? t_out[c] + slack : s->t1;
        const bool meets = t_in[c] <= t_out[c] && t_in[c] <= nearest && t_out[c] >= s->behind;
        met |= (unsigned)meets << c;
    }
    return met;
}

/* Push the chosen children that the ray meets before `nearest`, the nearest last. */
static int push_children(const code_slabs *s, const resident_mesh *tr, uint32_t node,
                         unsigned chosen, double nearest, pending stack[], int top) {
    const mesh_node *n = &tr->nodes[node];
    const int bottom = top;
    double t_in[MESH_CHILDREN];
    unsigned left = meet_children(s, n, nearest, t_in) & chosen;
    for (; left; left &= left - 1) {
        const unsigned c = (unsigned)__builtin_ctz(left);
        int at = top++;
        for (; at > bottom && stack[at - 1].t_in < t_in[c]; at--)
            stack[at] = stack[at - 1];
        stack[at] = (pending){t_in[c], n->child[c]};
    }
    return top;
}

/* Test the active tets from `first` on. */
static bool walk_leaf(const isovalue_list *isos, const resident_mesh *tr, uint32_t first,
                      uint32_t end, const ray *r, const box_line *line, trace_state *s,
                      ray_counters *counters) {
    bool changed = false;
    for (uint32_t i = first; i < end; i++)
        if (tr->active->tets[i / 64] >> i % 64 & 1u)
            changed |= test_tet(isos, tr, i, r, line, s, counters);
    return changed;
}

bool mesh_walk(const isovalue_list *isos, const resident_mesh *tr, const ray *r, trace_state *state,
               ray_counters *counters) {
    const code_slabs slabs = code_slabs_of(tr, r, &state->after);
    box_line line = box_line_of(r);
    line.t0 = -INFINITY;
    line.t1 = INFINITY;
    const uint16_t *first = mesh_leaf_first(&tr->mesh, tr->head.payload);
    pending stack[STACK_MAX];
    bool changed = false;
    int top = 0;
    stack[top++] = (pending){-INFINITY, 0};
    while (top > 0 && !(state->any && changed)) {
        const pending p = stack[--top];
        if (p.t_in > state->best.t)
            continue;
        if (!(p.child & MESH_LEAF)) {
            counters->nodes++;
            top = push_children(&slabs, tr, p.child, tr->active->children[p.child], state->best.t,
                                stack, top);
            continue;
        }
        const uint32_t leaf = p.child & ~(uint32_t)MESH_LEAF;
        changed |= walk_leaf(isos, tr, first[leaf], first[leaf + 1], r, &line, state, counters);
    }
    return changed;
}

/* ---- All tets ---- */

void mesh_walk_each(const resident_mesh *tr, const ray *r, const hit *after, double nearest,
                    const mesh_walk_visitor *v, ray_counters *counters) {
    const code_slabs slabs = code_slabs_of(tr, r, after);
    const box_line line = box_line_of(r);
    const uint16_t *first = mesh_leaf_first(&tr->mesh, tr->head.payload);
    const mesh_active *among = v->among ? v->among : tr->active;
    pending stack[STACK_MAX];
    int top = 0;
    stack[top++] = (pending){-INFINITY, 0};
    while (top > 0) {
        const pending p = stack[--top];
        if (!(p.child & MESH_LEAF)) {
            counters->nodes++;
            const unsigned chosen =
                among->children[p.child] & (v->choose ? v->choose(v->ctx, tr, p.child) : UINT_MAX);
            top = push_children(&slabs, tr, p.child, chosen, nearest, stack, top);
            continue;
        }
        const uint32_t leaf = p.child & ~(uint32_t)MESH_LEAF;
        for (uint32_t i = first[leaf]; i < first[leaf + 1]; i++) {
            if (!(among->tets[i / 64] >> i % 64 & 1u))
                continue;
            const tet x = mesh_walk_tet(tr, i);
            if (!passes_box(&line, &x))
                continue;
            counters->cells++;
            v->visit(v->ctx, tr, i, &x);
        }
    }
}

/* ---- Points ---- */

/* Returns whether the tet's box holds the point. This is exact, and much cheaper than testing the
 * tet. */
static bool box_holds_point(const tet *x, const double point[3]) {
    bool holds = true;
    for (int a = 0; a < 3; a++) {
        float lo = x->p[0][a], hi = lo;
        for (int k = 1; k < 4; k++) {
            lo = x->p[k][a] < lo ? x->p[k][a] : lo;
            hi = x->p[k][a] > hi ? x->p[k][a] : hi;
        }
        holds &= (double)lo <= point[a] && point[a] <= (double)hi;
    }
    return holds;
}

static bool holds_point(const tet *x, const double point[3], double weights[4]) {
    double p[4][3], all = 0.0;
    for (int k = 0; k < 4; k++)
        for (int a = 0; a < 3; a++)
            p[k][a] = (double)x->p[k][a];
    const int sign = exact_orientation((const double(*)[3])p);
    if (sign == 0 || !exact_weights((const double(*)[3])p, sign, point, weights))
        return false;
    for (int k = 0; k < 4; k++)
        all += weights[k];
    for (int k = 0; k < 4; k++)
        weights[k] /= all;
    return true;
}

/* Returns which children of a node have boxes that hold the point. */
static unsigned children_at(const resident_mesh *tr, const mesh_node *n, const double point[3]) {
    unsigned at = 0;
    for (int c = 0; c < MESH_CHILDREN; c++) {
        bool holds = true;
        for (int a = 0; a < 3; a++)
            holds &= n->lo[a][c] <= n->hi[a][c] && /* the child exists */
                     (double)mesh_leaf_plane(&tr->planes, a, n->lo[a][c]) <= point[a] &&
                     point[a] <= (double)mesh_leaf_plane(&tr->planes, a, n->hi[a][c]);
        at |= (unsigned)holds << c;
    }
    return at;
}

/* Returns the first tet from `from` to `end` that holds the point; `end`: none does. */
static uint32_t find_in_leaf(const resident_mesh *tr, uint32_t from, uint32_t end,
                             const double point[3], double weights[4]) {
    for (; from < end; from++) {
        const tet x = mesh_walk_tet(tr, from);
        if (box_holds_point(&x, point) && holds_point(&x, point, weights))
            break;
    }
    return from;
}

bool mesh_walk_find(const resident_mesh *tr, const double point[3], uint32_t *local,
                    double weights[4]) {
    const uint16_t *first = mesh_leaf_first(&tr->mesh, tr->head.payload);
    uint16_t stack[STACK_MAX];
    int top = 0;
    *local = tr->mesh.tets;
    stack[top++] = 0;
    while (top > 0) {
        const uint16_t child = stack[--top];
        if (!(child & MESH_LEAF)) {
            const mesh_node *n = &tr->nodes[child];
            for (unsigned left = children_at(tr, n, point); left; left &= left - 1)
                stack[top++] = n->child[__builtin_ctz(left)];
            continue;
        }
        /* Other leaves may hold an earlier tet with the point, so go on: the first of all is
         * wanted. */
        const uint32_t leaf = child & ~MESH_LEAF;
        const uint32_t end = first[leaf + 1] < *local ? first[leaf + 1] : *local;
        double w[4];
        const uint32_t found = find_in_leaf(tr, first[leaf], end, point, w);
        if (found >= end)
            continue;
        *local = found;
        memcpy(weights, w, sizeof w);
    }
    return *local < tr->mesh.tets;
}
