#include "render/mesh_walk.h"

#include <string.h>

#include "formats/mesh_leaf.h"

/* Kernel and boxes round differently; what is given away is a millionth of the distance. */
static const double generosity = 0x1p-20;

bool mesh_interval_of(const ray *r, const double lo[3], const double hi[3], mesh_interval *out) {
    double t_in = -INFINITY, t_out = INFINITY;
    for (int a = 0; a < 3; a++) {
        if (r->d[a] == 0.0) {
            if (r->o[a] < lo[a] || r->o[a] > hi[a])
                return false;
            continue;
        }
        const double near = ((r->d[a] < 0.0 ? hi : lo)[a] - r->o[a]) / r->d[a];
        const double far = ((r->d[a] > 0.0 ? hi : lo)[a] - r->o[a]) / r->d[a];
        t_in = near > t_in ? near : t_in;
        t_out = far < t_out ? far : t_out;
    }
    const double slack = generosity * (fabs(t_in) + fabs(t_out));
    out->t_in = t_in - slack > r->t0 ? t_in - slack : r->t0;
    out->t_out = t_out + slack < r->t1 ? t_out + slack : r->t1;
    /* With a slack that is not finite, everything may be. */
    return !(t_in - slack > t_out + slack) && !(out->t_in > out->t_out);
}

tet mesh_walk_tet(const treelet *tr, uint32_t place) {
    const uint16_t *v = mesh_leaf_tets(&tr->mesh, tr->payload)[place];
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

/* ---- Leaves ---- */

/* The first hit with one isopolygon behind `after`: another crossing, whatever the tet. */
static bool next_hit(const isopolygon *g, const ray *r, uint64_t cell, int32_t iso,
                     const hit *after, hit *found) {
    /* The kernel orders by (t, tet, iso): it is asked for everything from the same t on. */
    hit last = {after->t, 0, -1, false};
    const hit behind = {after->t, UINT64_MAX, after->iso, after->entering};
    while (isopolygon_hit(g, r, cell, iso, &last, found)) {
        if (tet_less(&behind, found))
            return true;
        last = *found;
    }
    return false;
}

static bool test_tet(const walk_scene *scene, const treelet *tr, uint32_t place, const ray *r,
                     const hit *after, hit *best, walk_counters *counters) {
    const tet x = mesh_walk_tet(tr, place);
    bool changed = false, active = false;
    for (int i = 0; i < scene->count; i++) {
        isopolygon g;
        hit found;
        if (!isopolygon_of(&x, scene->isovalues[i], &g))
            continue;
        active = true;
        if (!next_hit(&g, r, tr->first_tet + place, i, after, &found))
            continue;
        counters->roots++;
        if (tet_less(&found, best)) {
            *best = found;
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

/* Depth times siblings: a file's trees are no deeper, which is checked when they are loaded. */
enum { STACK_MAX = MESH_DEPTH_MAX * (MESH_CHILDREN - 1) + 1 };

/* What a walk does not change. */
typedef struct walk_of {
    const treelet *tr;
    const ray *r;
} walk_of;

/* Push a node's children that the ray meets before `nearest`, the first of them last. */
static int push_children(const walk_of *w, uint32_t node, double nearest, pending stack[],
                         int top) {
    const mesh_node *n = &w->tr->nodes[node];
    const int bottom = top;
    for (unsigned left = w->tr->active->children[node]; left; left &= left - 1) {
        const unsigned c = (unsigned)__builtin_ctz(left);
        double lo[3], hi[3];
        mesh_interval in;
        for (int a = 0; a < 3; a++) {
            lo[a] = (double)mesh_leaf_plane(&w->tr->planes, a, n->lo[a][c]);
            hi[a] = (double)mesh_leaf_plane(&w->tr->planes, a, n->hi[a][c]);
        }
        if (!mesh_interval_of(w->r, lo, hi, &in) || in.t_in > nearest)
            continue;
        int at = top++;
        for (; at > bottom && stack[at - 1].t_in < in.t_in; at--)
            stack[at] = stack[at - 1];
        stack[at] = (pending){in.t_in, n->child[c]};
    }
    return top;
}

bool mesh_walk(const walk_scene *scene, const treelet *tr, const ray *r, const hit *after,
               hit *best, walk_counters *counters) {
    const walk_of w = {tr, r};
    const uint16_t *first = mesh_leaf_first(&tr->mesh, tr->payload);
    pending stack[STACK_MAX];
    bool changed = false;
    int top = 0;
    stack[top++] = (pending){-INFINITY, 0};
    while (top > 0) {
        const pending p = stack[--top];
        if (p.t_in > best->t)
            continue;
        if (!(p.child & MESH_LEAF)) {
            counters->nodes++;
            top = push_children(&w, p.child, best->t, stack, top);
            continue;
        }
        const uint32_t leaf = p.child & ~(uint32_t)MESH_LEAF;
        for (uint32_t i = first[leaf]; i < first[leaf + 1]; i++)
            if (tr->active->tets[i / 64] >> i % 64 & 1u)
                changed |= test_tet(scene, tr, i, r, after, best, counters);
    }
    return changed;
}

/* ---- Points ---- */

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Six times the volume of the tet (a, b, c, d). */
static double volume(const double a[3], const double b[3], const double c[3], const double d[3]) {
    double u[3], v[3], w[3], n[3];
    for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - a[i];
        w[i] = d[i] - a[i];
    }
    cross(v, w, n);
    return u[0] * n[0] + u[1] * n[1] + u[2] * n[2];
}

static bool holds_point(const tet *x, const double point[3], double weights[4]) {
    static const double tolerance = 1e-12;
    double p[4][3];
    for (int k = 0; k < 4; k++)
        for (int a = 0; a < 3; a++)
            p[k][a] = (double)x->p[k][a];
    const double all = volume(p[0], p[1], p[2], p[3]);
    for (int k = 0; k < 4; k++) {
        double q[4][3];
        memcpy(q, p, sizeof q);
        memcpy(q[k], point, sizeof q[k]);
        weights[k] = volume(q[0], q[1], q[2], q[3]) / all;
        if (!(weights[k] >= -tolerance && weights[k] <= 1.0 + tolerance))
            return false;
    }
    return true;
}

bool mesh_walk_find(const treelet *tr, const double point[3], uint32_t *place, double weights[4]) {
    for (*place = 0; *place < tr->mesh.tets; ++*place) {
        const tet x = mesh_walk_tet(tr, *place);
        if (holds_point(&x, point, weights))
            return true;
    }
    return false;
}
