#include "render/frame/object_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/box3.h"

/* Relative: what places of LEAFCAST_SCALE_UNEVEN make of a rounding, 2^20 * 2^-53 times a few, is
 * less than a hundredth of it. */
static const double slack = 0x1p-24;

/* ---- Making ---- */

/* An object while the tree is made. */
typedef struct member {
    double box[2][3], middle[3];
    uint32_t object;
} member;

static int order(const member *a, const member *b, int axis) {
    if (a->middle[axis] != b->middle[axis])
        return a->middle[axis] < b->middle[axis] ? -1 : 1;
    return a->object < b->object ? -1 : 1;
}

static int order_x(const void *a, const void *b) {
    return order(a, b, 0);
}
static int order_y(const void *a, const void *b) {
    return order(a, b, 1);
}
static int order_z(const void *a, const void *b) {
    return order(a, b, 2);
}

/* Make the node of these objects, and all below it, from node `at` on. Halves them by their
 * middles, along the axis on which these lie furthest apart. */
static void make_node(object_tree *t, uint32_t at, member *of, uint32_t count) {
    static int (*const orders[3])(const void *, const void *) = {order_x, order_y, order_z};
    object_node *n = &t->nodes[at];
    double spread[2][3];
    int axis = 0;
    *n = (object_node){.least = UINT32_MAX};
    box3_begin(n->box);
    box3_begin(spread);
    for (uint32_t i = 0; i < count; i++) {
        box3_widen(n->box, of[i].box[0], of[i].box[1]);
        box3_widen(spread, of[i].middle, of[i].middle);
        n->least = of[i].object < n->least ? of[i].object : n->least;
        n->most = of[i].object > n->most ? of[i].object : n->most;
    }
    if (count == 1) {
        t->leaf[n->least] = at;
        return;
    }
    for (int a = 1; a < 3; a++)
        if (spread[1][a] - spread[0][a] > spread[1][axis] - spread[0][axis])
            axis = a;
    qsort(of, count, sizeof *of, orders[axis]);
    const uint32_t half = count / 2;
    n->second = at + 2 * half;
    make_node(t, at + 1, of, half);
    make_node(t, at + 2 * half, of + half, count - half);
}

/* Widen a box by much more than rounding. */
static void begin_member(member *m, const double box[2][3], uint32_t object) {
    double far = 0.0;
    m->object = object;
    for (int a = 0; a < 3; a++)
        far = fmax(far, fmax(fabs(box[0][a]), fabs(box[1][a])));
    for (int a = 0; a < 3; a++) {
        m->box[0][a] = box[0][a] - slack * far;
        m->box[1][a] = box[1][a] + slack * far;
        m->middle[a] = 0.5 * box[0][a] + 0.5 * box[1][a];
    }
}

status object_tree_make(object_tree *t, mem *m, const double (*boxes)[2][3], uint32_t objects) {
    member *members = mem_array(m, objects, sizeof *members);
    *t = (object_tree){.objects = objects};
    t->nodes = members ? mem_array(m, 2 * (size_t)objects - 1, sizeof *t->nodes) : NULL;
    t->leaf = t->nodes ? mem_array(m, objects, sizeof *t->leaf) : NULL;
    for (uint32_t i = 0; i < objects && t->leaf; i++)
        begin_member(&members[i], boxes[i], i);
    if (t->leaf)
        make_node(t, 0, members, objects);
    mem_free(m, members);
    return t->leaf ? ST_OK : ST_NOMEM;
}

void object_tree_release(object_tree *t, mem *m) {
    mem_free(m, t->leaf);
    mem_free(m, t->nodes);
    *t = (object_tree){0};
}

/* ---- Asking ---- */

/* As fmin() and fmax(), of numbers that are none of them a NaN, without a call. */
static inline double lesser(double a, double b) {
    return a < b ? a : b;
}
static inline double greater(double a, double b) {
    return a > b ? a : b;
}

/* Whether the ray meets a box: sets *in and *out to where. Both keep their order from a box to one
 * inside it. */
static bool meets(const object_ray *r, const double box[2][3], double *in, double *out) {
    double t0 = -INFINITY, t1 = INFINITY;
    for (int a = 0; a < 3; a++) {
        const double o = r->origin[a], d = r->direction[a];
        if (d == 0.0) {
            if (o < box[0][a] || o > box[1][a])
                return false;
            continue;
        }
        const bool up = d > 0.0;
        t0 = greater(t0, (box[!up][a] - o) / d);
        t1 = lesser(t1, (box[up][a] - o) / d);
    }
    t0 -= slack * fabs(t0);
    t1 += slack * fabs(t1);
    *in = greater(t0, r->t0);
    *out = lesser(t1, r->t1);
    return *in <= *out;
}

/* Whether the first child of a node is likely to be entered first: a guess, for speed alone. */
static bool begins_with_first(const object_tree *t, uint32_t i, const double direction[3]) {
    const object_node *a = &t->nodes[i + 1], *b = &t->nodes[t->nodes[i].second];
    double along = 0.0;
    for (int k = 0; k < 3; k++)
        along += direction[k] * (b->box[0][k] - a->box[0][k] + b->box[1][k] - a->box[1][k]);
    return along > 0.0;
}

enum { DEPTH = 32 }; /* of a tree that halves up to 2^31 objects */

bool object_tree_after(const object_tree *t, const object_ray *r, object_entry *at) {
    const object_entry before = *at;
    uint32_t stack[DEPTH + 1], count = 1;
    object_entry best = {INFINITY, UINT32_MAX};
    stack[0] = 0;
    while (count > 0) {
        const uint32_t i = stack[--count];
        const object_node *n = &t->nodes[i];
        double in, out;
        if (!meets(r, n->box, &in, &out) || out < before.t || in > best.t)
            continue;
        if (n->second) {
            const bool first = begins_with_first(t, i, r->direction);
            stack[count++] = first ? n->second : i + 1;
            stack[count++] = first ? i + 1 : n->second;
            continue;
        }
        const bool after = in > before.t || (in == before.t && n->least > before.object);
        if (after && (in < best.t || (in == best.t && n->least < best.object)))
            best = (object_entry){in, n->least};
    }
    if (best.object != UINT32_MAX)
        *at = best;
    return best.object != UINT32_MAX;
}

object_entry object_tree_entry(const object_tree *t, const object_ray *r, uint32_t object) {
    object_entry at = {.object = object};
    double out;
    (void)meets(r, t->nodes[t->leaf[object]].box, &at.t, &out);
    return at;
}

uint32_t object_tree_from(const object_tree *t, const object_ray *r, uint32_t from) {
    uint32_t stack[DEPTH + 1], count = 1, best = t->objects;
    stack[0] = 0;
    while (count > 0) {
        const uint32_t i = stack[--count];
        const object_node *n = &t->nodes[i];
        double in, out;
        if (n->most < from || n->least >= best || !meets(r, n->box, &in, &out))
            continue;
        if (n->second) {
            stack[count++] = n->second;
            stack[count++] = i + 1;
        } else {
            best = n->least;
        }
    }
    return best;
}
