#include "render/frame/box_tree.h"

#include <math.h>
#include <stdlib.h>

#include "formats/base/box3.h"

/* Relative: what places of LEAFCAST_SCALE_UNEVEN make of a rounding, 2^20 * 2^-53 times a few, is
 * less than a hundredth of it. */
static const double slack = 0x1p-24;

/* Of a t of a plane, or of a point, relative: more than there is. */
static const double rounding = 0x1p-48;

/* A component of a direction below it moves no ray, and has no inverse. */
static const double still = 0x1p-1000;

/* ---- Making ---- */

/* An entry while the tree is made. */
typedef struct member {
    double box[2][3], middle[3];
    uint32_t entry;
} member;

static int order(const member *a, const member *b, int axis) {
    if (a->middle[axis] != b->middle[axis])
        return a->middle[axis] < b->middle[axis] ? -1 : 1;
    return a->entry < b->entry ? -1 : 1;
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

/* Sort entries by their middles, along the axis on which these lie furthest apart. */
static void sort_members(member *of, uint32_t count) {
    static int (*const orders[3])(const void *, const void *) = {order_x, order_y, order_z};
    double spread[2][3];
    int axis = 0;
    box3_begin(spread);
    for (uint32_t i = 0; i < count; i++)
        box3_widen(spread, of[i].middle, of[i].middle);
    for (int a = 1; a < 3; a++)
        if (spread[1][a] - spread[0][a] > spread[1][axis] - spread[0][axis])
            axis = a;
    qsort(of, count, sizeof *of, orders[axis]);
}

/* Into how many parts a node divides its entries: as few as leave trees of full nodes to each. */
static uint32_t parts_of(uint32_t count) {
    uint32_t full = 1;
    while (full < (count + BOX_WIDTH - 1) / BOX_WIDTH)
        full *= BOX_WIDTH;
    return (count + full - 1) / full;
}

/* The first entry of a part; of the part behind the last one: their number. */
static uint32_t part_at(uint32_t count, uint32_t parts, uint32_t k) {
    return (uint32_t)((uint64_t)count * k / parts);
}

/* Divide entries into parts: along an axis, then each half along another. */
static void part_members(member *of, uint32_t count, uint32_t parts) {
    const uint32_t half = parts / 2, middle = part_at(count, parts, half);
    sort_members(of, count);
    if (half > 1)
        sort_members(of, middle);
    if (parts - half > 1)
        sort_members(of + middle, count - middle);
}

/* How many nodes 2 or more entries need. */
static size_t nodes_of(uint32_t count) {
    const uint32_t parts = parts_of(count);
    size_t nodes = 1;
    for (uint32_t k = 0; k < parts; k++) {
        const uint32_t own = part_at(count, parts, k + 1) - part_at(count, parts, k);
        nodes += own > 1 ? nodes_of(own) : 0;
    }
    return nodes;
}

static void set_box(const box_tree *t, box_node *n, uint32_t k, const double box[2][3]) {
    for (int a = 0; a < 3; a++) {
        n->box[0][a][k] = (float)((box[0][a] - t->middle[a]) * t->scale);
        n->box[1][a][k] = (float)((box[1][a] - t->middle[a]) * t->scale);
    }
}

/* Make the node of 2 or more entries, and all below it, from node *next on. Sets box[] to that
 * around them. */
static void make_node(box_tree *t, uint32_t *next, member *of, uint32_t count, double box[2][3]) {
    const uint32_t at = (*next)++, parts = parts_of(count);
    box_node *n = &t->nodes[at];
    part_members(of, count, parts);
    *n = (box_node){.least = UINT32_MAX};
    box3_begin(box);
    for (uint32_t i = 0; i < count; i++) {
        n->least = of[i].entry < n->least ? of[i].entry : n->least;
        n->most = of[i].entry > n->most ? of[i].entry : n->most;
    }
    for (uint32_t k = 0; k < BOX_WIDTH; k++) {
        const uint32_t begin = k < parts ? part_at(count, parts, k) : count,
                       own = k < parts ? part_at(count, parts, k + 1) - begin : 0;
        double around[2][3];
        box3_begin(around);
        if (own == 1) {
            memcpy(around, of[begin].box, sizeof around);
            n->child[k] = of[begin].entry;
            t->leaf[n->child[k]] = BOX_WIDTH * at + k;
        } else if (own > 1) {
            n->child[k] = *next;
            n->inner |= 1U << k;
            make_node(t, next, of + begin, own, around);
        }
        set_box(t, n, k, (const double(*)[3])around);
        box3_widen(box, around[0], around[1]);
    }
}

/* Widen a box by much more than rounding. */
static void begin_member(member *m, const double box[2][3], uint32_t entry) {
    double far = 0.0;
    m->entry = entry;
    for (int a = 0; a < 3; a++)
        far = fmax(far, fmax(fabs(box[0][a]), fabs(box[1][a])));
    for (int a = 0; a < 3; a++) {
        m->box[0][a] = box[0][a] - slack * far;
        m->box[1][a] = box[1][a] + slack * far;
        m->middle[a] = 0.5 * box[0][a] + 0.5 * box[1][a];
    }
}

static void set_all(box_tree *t, const member *of) {
    double most = 0.0;
    int exponent;
    box3_begin(t->box);
    for (uint32_t i = 0; i < t->entries; i++)
        box3_widen(t->box, of[i].box[0], of[i].box[1]);
    for (int a = 0; a < 3; a++) {
        t->middle[a] = 0.5 * t->box[0][a] + 0.5 * t->box[1][a];
        t->half[a] = fmax(t->box[1][a] - t->middle[a], t->middle[a] - t->box[0][a]);
        most = fmax(most, t->half[a]);
    }
    (void)frexp(most, &exponent);
    t->scale = most > 0.0 ? ldexp(1.0, -exponent) : 1.0;
    for (int a = 0; a < 3; a++)
        t->half[a] *= t->scale;
}

status box_tree_make(box_tree *t, mem *m, const double (*boxes)[2][3], uint32_t entries) {
    member *members = mem_array(m, entries, sizeof *members);
    *t = (box_tree){.entries = entries};
    if (members && entries > 1) {
        t->nodes = mem_array(m, nodes_of(entries), sizeof *t->nodes);
        t->leaf = mem_array(m, entries, sizeof *t->leaf);
    }
    const bool made = members && (entries == 1 || (t->nodes && t->leaf));
    for (uint32_t i = 0; i < entries && made; i++)
        begin_member(&members[i], boxes[i], i);
    if (made)
        set_all(t, members);
    if (made && entries > 1) {
        uint32_t next = 0;
        double all[2][3];
        make_node(t, &next, members, entries, all);
    }
    mem_free(m, members);
    return made ? ST_OK : ST_NOMEM;
}

void box_tree_release(box_tree *t, mem *m) {
    mem_free(m, t->leaf);
    mem_free(m, t->nodes);
    *t = (box_tree){.entries = 0};
}

/* ---- Asking ---- */

/* As fmin() and fmax(), of numbers that are none of them a NaN, without a call. */
static inline double lesser(double a, double b) {
    return a < b ? a : b;
}
static inline double greater(double a, double b) {
    return a > b ? a : b;
}

box_way box_way_of(const double origin[3], const double direction[3]) {
    const double far = greater(greater(fabs(origin[0]), fabs(origin[1])), fabs(origin[2]));
    box_way w;
    for (int a = 0; a < 3; a++) {
        w.origin[a] = origin[a];
        w.direction[a] = direction[a];
        w.inverse[a] = fabs(direction[a]) < still ? 0.0 : 1.0 / direction[a];
        w.off[a] = rounding * far;
    }
    return w;
}

/* The span widened by more than the rounding of t. */
static box_span widened(double t0, double t1) {
    return (box_span){t0 - slack * fabs(t0), t1 + slack * fabs(t1)};
}

static box_span cut(box_span s, double t0, double t1) {
    return (box_span){greater(s.t0, t0), lesser(s.t1, t1)};
}

/* A number as a float that is no infinity: those are planes of empty boxes. */
static float bounded(double x) {
    return (float)lesser(greater(x, -1e37), 1e37);
}

/* A ray from where the way enters the box of all. On an axis that it hardly moves along it is as if
 * it stood still: over the whole box it moves by less than the margin. */
static void begin_ray(const box_tree *t, const box_way *w, double from, box_ray *r) {
    static const float slowest = 0x1p-70f, steepest = 0x1p+70f;
    const double *d = w->direction;
    r->from = from;
    r->unit = 1.0 / (greater(greater(fabs(d[0]), fabs(d[1])), fabs(d[2])) * t->scale);
    for (int a = 0; a < 3; a++) {
        const double way = from * d[a], at = (w->origin[a] + way - t->middle[a]) * t->scale;
        const double off = (fabs(w->origin[a]) + fabs(way) + fabs(t->middle[a])) * t->scale;
        const double margin =
            0x1p-20 * (fabs(at) + t->half[a]) + 0x1p-50 * off + w->off[a] * t->scale;
        const float along = (float)(d[a] * t->scale * r->unit);
        r->down[a] = d[a] < 0.0;
        r->inverse[a] = fabsf(along) > slowest ? 1.0f / along : r->down[a] ? -steepest : steepest;
        r->near[a] = bounded(r->down[a] ? at - margin : at + margin);
        r->far[a] = bounded(r->down[a] ? at + margin : at - margin);
    }
}

bool box_tree_enter(const box_tree *t, const box_way *w, const box_span *within, box_span *at,
                    box_ray *r) {
    double t0 = -INFINITY, t1 = INFINITY;
    for (int a = 0; a < 3; a++) {
        const double o = w->origin[a], low = t->box[0][a] - w->off[a],
                     high = t->box[1][a] + w->off[a];
        if (w->inverse[a] == 0.0) {
            if (o < low || o > high)
                return false;
            continue;
        }
        const bool up = w->inverse[a] > 0.0;
        t0 = greater(t0, ((up ? low : high) - o) * w->inverse[a]);
        t1 = lesser(t1, ((up ? high : low) - o) * w->inverse[a]);
    }
    /* The t are right but for their last digits; those of what is returned are wider. */
    if (!(t0 - rounding * fabs(t0) <= t1 + rounding * fabs(t1)))
        return false;
    const box_span met = cut(widened(t0, t1), within->t0, within->t1);
    if (!(met.t0 <= met.t1))
        return false;
    *at = met;
    if (!t->nodes)
        return true;
    begin_ray(t, w, greater(t0, within->t0), r);
    r->t0 = met.t0;
    r->t1 = met.t1;
    return true;
}

box_span box_ray_span(const box_ray *r, float s0, float s1) {
    return cut(widened(r->from + (double)s0 * r->unit, r->from + (double)s1 * r->unit), r->t0,
               r->t1);
}

float box_ray_least(const box_ray *r, double t) {
    const double s = (t - 4.0 * slack * fabs(t) - r->from) / r->unit;
    return bounded(s - 0x1p-20 * fabs(s));
}

float box_ray_most(const box_ray *r, double t) {
    const double s = (t + 4.0 * slack * fabs(t) - r->from) / r->unit;
    return bounded(s + 0x1p-20 * fabs(s));
}
