#include "prep/tetrahedralize/triangle_tree.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "formats/base/vec3.h"

enum { LEAF = 4, STACK = 128 };

typedef struct tree_node {
    float lo[3], hi[3];
    uint32_t first, count; /* leaf: triangles order[first] ..; else count is 0, and children are
                              first, first + 1 */
} tree_node;

struct triangle_tree {
    mem *m;
    const float (*xyz)[3];
    const uint32_t (*corners)[3];
    uint32_t *order;
    tree_node *nodes;
};

/* ---- building ---- */

/* Three times the centre: enough for comparisons. */
static double centre(const triangle_tree *t, uint32_t triangle, int axis) {
    const uint32_t *c = t->corners[triangle];
    return (double)t->xyz[c[0]][axis] + (double)t->xyz[c[1]][axis] + (double)t->xyz[c[2]][axis];
}

static void box_node(const triangle_tree *t, tree_node *n, size_t first, size_t end) {
    for (int a = 0; a < 3; a++) {
        n->lo[a] = INFINITY;
        n->hi[a] = -INFINITY;
    }
    for (size_t i = first; i < end; i++)
        for (int c = 0; c < 3; c++) {
            const float *p = t->xyz[t->corners[t->order[i]][c]];
            for (int a = 0; a < 3; a++) {
                n->lo[a] = p[a] < n->lo[a] ? p[a] : n->lo[a];
                n->hi[a] = p[a] > n->hi[a] ? p[a] : n->hi[a];
            }
        }
}

static int longest_axis(const triangle_tree *t, size_t first, size_t end) {
    double most = -1;
    int axis = 0;
    for (int a = 0; a < 3; a++) {
        double lo = INFINITY, hi = -INFINITY;
        for (size_t i = first; i < end; i++) {
            const double c = centre(t, t->order[i], a);
            lo = c < lo ? c : lo;
            hi = c > hi ? c : hi;
        }
        if (hi - lo > most) {
            most = hi - lo;
            axis = a;
        }
    }
    return axis;
}

/* Reorder [first, end) so that no centre before `middle` is larger than one after it. */
static void split_middle(triangle_tree *t, size_t first, size_t end, size_t middle, int axis) {
    while (end - first > 1) {
        const double pivot = centre(t, t->order[first + (end - first) / 2], axis);
        size_t i = first, j = end - 1;
        for (;;) {
            while (centre(t, t->order[i], axis) < pivot)
                i++;
            while (centre(t, t->order[j], axis) > pivot)
                j--;
            if (i >= j)
                break;
            const uint32_t swap = t->order[i];
            t->order[i++] = t->order[j];
            t->order[j--] = swap;
        }
        /* All before i are at most the pivot. All from i on are at least the pivot. */
        const size_t cut = i > first ? i : first + 1;
        if (middle < cut)
            end = cut;
        else
            first = cut;
    }
}

static void build_nodes(triangle_tree *t, size_t count) {
    struct {
        uint32_t node;
        size_t first, end;
    } stack[STACK];
    int top = 0;
    uint32_t nodes = 1;
    stack[top++].node = 0;
    stack[0].first = 0;
    stack[0].end = count;
    while (top > 0) {
        const size_t first = stack[--top].first, end = stack[top].end;
        tree_node *n = &t->nodes[stack[top].node];
        box_node(t, n, first, end);
        n->first = (uint32_t)first;
        n->count = (uint32_t)(end - first);
        if (end - first <= LEAF)
            continue;
        const size_t middle = first + (end - first) / 2;
        split_middle(t, first, end, middle, longest_axis(t, first, end));
        n->first = nodes;
        n->count = 0;
        stack[top].node = nodes++;
        stack[top].first = first;
        stack[top++].end = middle;
        stack[top].node = nodes++;
        stack[top].first = middle;
        stack[top++].end = end;
    }
}

status triangle_tree_build(mem *m, const float (*xyz)[3], const uint32_t (*corners)[3],
                           size_t count, triangle_tree **out) {
    triangle_tree *t = mem_zalloc(m, sizeof *t);
    if (!t)
        return ST_NOMEM;
    *t = (triangle_tree){.m = m, .xyz = xyz, .corners = corners};
    t->order = mem_array(m, count, sizeof *t->order);
    t->nodes = mem_array(m, 2 * count, sizeof *t->nodes);
    if (!t->order || !t->nodes) {
        triangle_tree_free(t);
        return ST_NOMEM;
    }
    for (size_t i = 0; i < count; i++)
        t->order[i] = (uint32_t)i;
    build_nodes(t, count);
    *out = t;
    return ST_OK;
}

void triangle_tree_free(triangle_tree *t) {
    if (!t)
        return;
    mem_free(t->m, t->order);
    mem_free(t->m, t->nodes);
    mem_free(t->m, t);
}

/* ---- queries ---- */

/* The point nearest to p on the segment from 0 to d, as a share of d. */
static double nearest_on(const double d[3], const double p[3]) {
    const double length = vec3_dot(d, d), along = vec3_dot(d, p);
    return length > 0 && along > 0 ? (along < length ? along / length : 1) : 0;
}

typedef struct corner_offsets {
    double ab[3], ac[3], ap[3];
} corner_offsets;

/* Compute the squared distance to a + v ab + w ac, and update *near if it is smaller. */
static void take_nearer(const corner_offsets *o, double v, double w, triangle_near *near,
                        double *square) {
    double d[3];
    for (int a = 0; a < 3; a++)
        d[a] = o->ap[a] - v * o->ab[a] - w * o->ac[a];
    const double here = vec3_dot(d, d);
    if (here < *square) {
        *square = here;
        near->weight[0] = 1 - v - w;
        near->weight[1] = v;
        near->weight[2] = w;
    }
}

/* Take the foot of the perpendicular if it is inside, else the nearest point of the edges. */
static double nearest_in(const triangle_tree *t, uint32_t triangle, const double p[3],
                         triangle_near *near) {
    const float *a = t->xyz[t->corners[triangle][0]], *b = t->xyz[t->corners[triangle][1]];
    const float *c = t->xyz[t->corners[triangle][2]];
    corner_offsets o;
    double bc[3], bp[3], square = INFINITY;
    for (int k = 0; k < 3; k++) {
        o.ab[k] = (double)b[k] - (double)a[k];
        o.ac[k] = (double)c[k] - (double)a[k];
        bc[k] = (double)c[k] - (double)b[k];
        o.ap[k] = p[k] - (double)a[k];
        bp[k] = p[k] - (double)b[k];
    }
    const double bb = vec3_dot(o.ab, o.ab), cc = vec3_dot(o.ac, o.ac), bc2 = vec3_dot(o.ab, o.ac);
    const double pb = vec3_dot(o.ap, o.ab), pc = vec3_dot(o.ap, o.ac);
    const double area = bb * cc - bc2 * bc2;
    const double v = (cc * pb - bc2 * pc) / area, w = (bb * pc - bc2 * pb) / area;
    if (v >= 0 && w >= 0 && v + w <= 1)
        take_nearer(&o, v, w, near, &square);
    take_nearer(&o, nearest_on(o.ab, o.ap), 0, near, &square);
    take_nearer(&o, 0, nearest_on(o.ac, o.ap), near, &square);
    const double along = nearest_on(bc, bp);
    take_nearer(&o, 1 - along, along, near, &square);
    return square;
}

static double box_square(const tree_node *n, const double p[3]) {
    double square = 0;
    for (int a = 0; a < 3; a++) {
        const double lo = (double)n->lo[a] - p[a], hi = p[a] - (double)n->hi[a];
        const double d = lo > 0 ? lo : hi > 0 ? hi : 0;
        square += d * d;
    }
    return square;
}

static void look_in_leaf(const triangle_tree *t, const tree_node *n, const double p[3],
                         triangle_near *best, double *square) {
    for (uint32_t i = n->first; i < n->first + n->count; i++) {
        triangle_near here = {.triangle = t->order[i]};
        const double d = nearest_in(t, here.triangle, p, &here);
        if (d < *square) {
            *square = d;
            *best = here;
        }
    }
}

triangle_near triangle_tree_nearest(const triangle_tree *t, const float point[3]) {
    const double p[3] = {(double)point[0], (double)point[1], (double)point[2]};
    uint32_t stack[STACK];
    int top = 0;
    double square = INFINITY;
    triangle_near best = {0};
    stack[top++] = 0;
    while (top > 0) {
        const tree_node *n = &t->nodes[stack[--top]];
        if (box_square(n, p) >= square)
            continue;
        if (n->count > 0) {
            look_in_leaf(t, n, p, &best, &square);
            continue;
        }
        const tree_node *child = &t->nodes[n->first];
        const bool swap = box_square(&child[0], p) < box_square(&child[1], p);
        stack[top++] = n->first + (swap ? 1 : 0);
        stack[top++] = n->first + (swap ? 0 : 1);
    }
    best.distance = sqrt(square);
    return best;
}
