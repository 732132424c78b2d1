#include "formats/leaf/time_tree.h"

#include <math.h>
#include <string.h>

/* 8^11 treelets, and 2^32 steps, are more than a file may have. */
enum { GROUP_LOG2 = 3, SIZES = LEAF_LEVELS_MAX, SPANS = 33 };

/* Nodes of one size: groups of treelets in spans of 2^j steps. A size below is that of the children
 * in space, where groups of size k have the children begin[k][i] to before begin[k][i + 1]. */
struct time_tree {
    mem *m;
    const leaf_file *f;
    uint32_t field;
    int sizes, spans;        /* numbers of sizes of groups, of lengths of spans */
    uint32_t groups[SIZES];  /* of a size; of size 0: treelets */
    uint32_t lengths[SPANS]; /* spans of a length; of length 0: steps */
    uint32_t *begin[SIZES];  /* of size 0 NULL */
    float (
        *ranges[SIZES][SPANS])[2]; /* span * groups + group; NULL: not in the tree, or the file's */
    bool in_time[SIZES][SPANS];    /* how nodes of the tree are split */
};

/* The ranges of all groups of size k in a span of length j. */
static const float (*row(const time_tree *t, int k, int j, uint32_t span))[2] {
    const leaf_layout *l = &t->f->layout;
    if (k == 0 && j == 0)
        return (const float(*)[2])t->f->own + l->level[0].first +
               (size_t)leaf_layout_set(l, t->field, span) * l->treelets;
    return (const float(*)[2])t->ranges[k][j] + (size_t)span * t->groups[k];
}

/* ---- what lies below a group ---- */

/* What a coarser treelet covers; where there are none, GROUP neighbours. */
static uint32_t first_below(const leaf_layout *l, int k, uint32_t i) {
    if (l->levels == 1)
        return i << GROUP_LOG2;
    return l->first_child[l->level[k].first + i] - l->level[k - 1].first;
}

static status group(time_tree *t, time_order order) {
    const leaf_layout *l = &t->f->layout;
    t->groups[0] = l->level[0].count;
    t->sizes = 1;
    for (int k = 1; t->groups[k - 1] > 1; k++, t->sizes++) {
        const uint32_t below = t->groups[k - 1];
        t->groups[k] = l->levels > 1 ? l->level[k].count : ((below - 1) >> GROUP_LOG2) + 1;
        t->begin[k] = mem_array(t->m, (size_t)t->groups[k] + 1, sizeof *t->begin[k]);
        if (!t->begin[k])
            return ST_NOMEM;
        for (uint32_t i = 0; i < t->groups[k]; i++)
            t->begin[k][i] = first_below(l, k, i);
        t->begin[k][t->groups[k]] = below;
    }
    t->lengths[0] = l->steps;
    for (t->spans = 1; t->lengths[t->spans - 1] > 1 && order != TIME_ORDER_STEPS; t->spans++)
        t->lengths[t->spans] = (t->lengths[t->spans - 1] - 1) / 2 + 1;
    return ST_OK;
}

/* ---- ranges ---- */

static void widen(float range[2], const float by[2]) {
    range[0] = by[0] < range[0] ? by[0] : range[0];
    range[1] = by[1] > range[1] ? by[1] : range[1];
}

/* From the two spans below, or of the last the only one. */
static void join_spans(time_tree *t, int j) {
    const uint32_t groups = t->groups[0];
    for (uint32_t span = 0; span < t->lengths[j]; span++) {
        float(*to)[2] = t->ranges[0][j] + (size_t)span * groups;
        memcpy(to, row(t, 0, j - 1, 2 * span), groups * sizeof *to);
        if (2 * span + 1 == t->lengths[j - 1])
            continue;
        const float(*second)[2] = row(t, 0, j - 1, 2 * span + 1);
        for (uint32_t i = 0; i < groups; i++)
            widen(to[i], second[i]);
    }
}

static void join_groups(time_tree *t, int k, int j) {
    for (uint32_t span = 0; span < t->lengths[j]; span++) {
        const float(*below)[2] = row(t, k - 1, j, span);
        float(*to)[2] = t->ranges[k][j] + (size_t)span * t->groups[k];
        for (uint32_t i = 0; i < t->groups[k]; i++) {
            to[i][0] = INFINITY;
            to[i][1] = -INFINITY;
            for (uint32_t c = t->begin[k][i]; c < t->begin[k][i + 1]; c++)
                widen(to[i], below[c]);
        }
    }
}

static status join(time_tree *t) {
    for (int j = 0; j < t->spans; j++)
        for (int k = 0; k < t->sizes; k++) {
            if (k == 0 && j == 0)
                continue;
            t->ranges[k][j] =
                mem_array(t->m, (size_t)t->groups[k] * t->lengths[j], sizeof(float[2]));
            if (!t->ranges[k][j])
                return ST_NOMEM;
            if (k == 0)
                join_spans(t, j);
            else
                join_groups(t, k, j);
        }
    return ST_OK;
}

/* ---- the order of splits ---- */

/* A mean of shares. */
typedef struct overlap {
    double sum;
    uint64_t count;
} overlap;

/* The share of a node's range that a child has. What is empty has none. */
static void overlap_add(overlap *o, const float node[2], const float child[2]) {
    const double whole = (double)node[1] - (double)node[0];
    if (!(whole >= 0.0))
        return;
    o->sum += whole > 0.0 ? fmax(0.0, ((double)child[1] - (double)child[0]) / whole) : 1.0;
    o->count++;
}

static double overlap_mean(const overlap *o) {
    return o->count ? o->sum / (double)o->count : 1.0;
}

static double overlap_in_time(const time_tree *t, int k, int j) {
    overlap o = {0};
    for (uint32_t span = 0; span < t->lengths[j - 1]; span++) {
        const float(*node)[2] = row(t, k, j, span / 2), (*child)[2] = row(t, k, j - 1, span);
        for (uint32_t i = 0; i < t->groups[k]; i++)
            overlap_add(&o, node[i], child[i]);
    }
    return overlap_mean(&o);
}

static double overlap_in_space(const time_tree *t, int k, int j) {
    overlap o = {0};
    for (uint32_t span = 0; span < t->lengths[j]; span++) {
        const float(*node)[2] = row(t, k, j, span), (*child)[2] = row(t, k - 1, j, span);
        for (uint32_t i = 0; i < t->groups[k]; i++)
            for (uint32_t c = t->begin[k][i]; c < t->begin[k][i + 1]; c++)
                overlap_add(&o, node[i], child[c]);
    }
    return overlap_mean(&o);
}

static bool goes_in_time(const time_tree *t, int k, int j, time_order order) {
    if (k == 0 || j == 0)
        return k == 0;
    switch (order) {
    case TIME_ORDER_LONG: return j > k;
    case TIME_ORDER_LEAST: return overlap_in_time(t, k, j) < overlap_in_space(t, k, j);
    default: return overlap_in_time(t, k, j) >= overlap_in_space(t, k, j);
    }
}

/* Go down from the root, and keep the sizes of nodes on this way alone. */
static void choose(time_tree *t, time_order order) {
    float(*kept[SIZES][SPANS])[2] = {0};
    for (int k = t->sizes - 1, j = t->spans - 1; k > 0 || j > 0;) {
        kept[k][j] = t->ranges[k][j];
        t->in_time[k][j] = goes_in_time(t, k, j, order);
        *(t->in_time[k][j] ? &j : &k) -= 1;
    }
    for (int k = 0; k < t->sizes; k++)
        for (int j = 0; j < t->spans; j++)
            if (!kept[k][j]) {
                mem_free(t->m, t->ranges[k][j]);
                t->ranges[k][j] = NULL;
            }
}

status time_tree_create(mem *m, const leaf_file *f, uint32_t field, time_order order,
                        time_tree **out) {
    time_tree *t = mem_zalloc(m, sizeof *t);
    *out = NULL;
    if (!t)
        return ST_NOMEM;
    t->m = m;
    t->f = f;
    t->field = field;
    status st = group(t, order);
    if (st == ST_OK)
        st = join(t);
    if (st != ST_OK) {
        time_tree_destroy(t);
        return st;
    }
    choose(t, order);
    *out = t;
    return ST_OK;
}

void time_tree_destroy(time_tree *t) {
    for (int k = 0; t && k < SIZES; k++) {
        mem_free(t->m, t->begin[k]);
        for (int j = 0; j < SPANS; j++)
            mem_free(t->m, t->ranges[k][j]);
    }
    if (t)
        mem_free(t->m, t);
}

size_t time_tree_bytes(const time_tree *t) {
    size_t bytes = 0;
    for (int k = 0; k < t->sizes; k++)
        for (int j = 0; j < t->spans; j++)
            bytes += t->ranges[k][j] ? (size_t)t->groups[k] * t->lengths[j] * sizeof(float[2]) : 0;
    return bytes;
}

/* ---- questions ---- */

static inline bool meets(const time_query *q, const float range[2]) {
    for (int i = 0; i < q->count; i++)
        if (value_limits_meet(&q->limits[i], range[0], range[1]))
            return true;
    return false;
}

/* Whether a span has steps that are asked for. */
static bool is_asked(const time_query *q, uint64_t first, uint64_t end) {
    const uint64_t from = first > q->first ? first : q->first, to = end < q->end ? end : q->end;
    return from < to &&
           !(q->settled && !memchr(q->settled + (from - q->first), 0, (size_t)(to - from)));
}

static bool is_span_asked(const time_query *q, int j, uint32_t span) {
    return is_asked(q, (uint64_t)span << j, ((uint64_t)span + 1) << j);
}

/* Go below a node that meets an interval: first look at each child's range. */
static void descend(const time_tree *t, time_query *q, int k, uint32_t i, int j, uint32_t span) {
    if (k == 0 && j == 0) {
        q->met(q, t->f->layout.level[0].first + i, span);
    } else if (t->in_time[k][j]) {
        const uint32_t end = 2 * span + 2 < t->lengths[j - 1] ? 2 * span + 2 : t->lengths[j - 1];
        for (uint32_t s = 2 * span; s < end; s++) {
            if (!is_span_asked(q, j - 1, s))
                continue;
            q->visited++;
            if (meets(q, row(t, k, j - 1, s)[i]))
                descend(t, q, k, i, j - 1, s);
        }
    } else {
        const float(*ranges)[2] = row(t, k - 1, j, span);
        for (uint32_t c = t->begin[k][i]; c < t->begin[k][i + 1]; c++) {
            q->visited++;
            if (!meets(q, ranges[c]))
                continue;
            descend(t, q, k - 1, c, j, span);
            if (!is_span_asked(q, j, span))
                return;
        }
    }
}

void time_tree_ask(const time_tree *t, time_query *q) {
    const int k = t->sizes - 1, j = t->spans - 1;
    for (uint32_t span = 0; span < t->lengths[j]; span++) {
        if (!is_span_asked(q, j, span))
            continue;
        q->visited++;
        if (meets(q, row(t, k, j, span)[0]))
            descend(t, q, k, 0, j, span);
    }
}

static void settle(time_query *q, uint32_t treelet, uint32_t step) {
    (void)treelet;
    q->settled[step - q->first] = 1;
}

void time_tree_steps(const time_tree *t, value_limits at, uint32_t first, uint32_t end,
                     uint8_t *has, uint64_t *visited) {
    time_query q = {.limits = &at, .count = 1, .first = first, .end = end, .met = settle};
    q.settled = has;
    memset(has, 0, end - first);
    time_tree_ask(t, &q);
    *visited += q.visited;
}

static void lower_end(time_query *q, uint32_t treelet, uint32_t step) {
    (void)treelet;
    q->end = step;
}

uint32_t time_tree_first(const time_tree *t, value_limits at, uint32_t first, uint32_t end,
                         uint64_t *visited) {
    time_query q = {.limits = &at, .count = 1, .first = first, .end = end, .met = lower_end};
    time_tree_ask(t, &q);
    *visited += q.visited;
    return q.end;
}
