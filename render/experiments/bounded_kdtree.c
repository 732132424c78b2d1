#include "render/experiments/bounded_kdtree.h"

#include <string.h>

#include "render/triangle/triangle_kernel.h"
#include "render/walk/box_interval.h"

/* Bins: planes that are tried along an axis. From BY_HALVES levels on, ranges are halved, so that
 * no tree is deeper than its stacks. */
enum { BINS = 16, BY_HALVES = 64, STACK_MAX = 128, PARTS = 64 };

/* ---- Boxes ---- */

static void box_of(const bounded_kdtree *t, uint32_t number, float box[6]) {
    const uint32_t *v = t->rows[number];
    for (int a = 0; a < 3; a++) {
        box[a] = box[a + 3] = t->positions[v[0]][a];
        for (int k = 1; k < 3; k++) {
            const float x = t->positions[v[k]][a];
            box[a] = x < box[a] ? x : box[a];
            box[a + 3] = x > box[a + 3] ? x : box[a + 3];
        }
    }
}

static void widen(float box[6], const float by[6]) {
    for (int a = 0; a < 3; a++) {
        box[a] = by[a] < box[a] ? by[a] : box[a];
        box[a + 3] = by[a + 3] > box[a + 3] ? by[a + 3] : box[a + 3];
    }
}

static double half_surface(const float box[6]) {
    double e[3];
    for (int a = 0; a < 3; a++)
        e[a] = (double)box[a + 3] - (double)box[a];
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

/* ---- Building ---- */

/* Triangles ids[first .. end) that a node is to be made of. */
typedef struct range {
    uint32_t first, end, level;
    uint32_t *slot; /* the parent's child; NULL: it is the root */
    bool top;       /* the node above is none of a part */
} range;

typedef struct builder {
    bounded_kdtree *t;
    uint32_t *ids;
    float (*boxes)[6]; /* of the triangles */
} builder;

/* A plane between bins, and what it costs. */
typedef struct cut {
    double cost, plane;
    int axis;
} cut;

static double middle_of(const float box[6], int axis) {
    return 0.5 * ((double)box[axis] + (double)box[axis + 3]);
}

static int bin_of(double middle, const double extent[2]) {
    const double share = (middle - extent[0]) / (extent[1] - extent[0]);
    const int bin = (int)(BINS * share);
    return bin < BINS - 1 ? bin : BINS - 1;
}

static void middles_extent(const builder *b, const range *r, int axis, double extent[2]) {
    extent[0] = INFINITY;
    extent[1] = -INFINITY;
    for (uint32_t i = r->first; i < r->end; i++) {
        const double x = middle_of(b->boxes[b->ids[i]], axis);
        extent[0] = fmin(extent[0], x);
        extent[1] = fmax(extent[1], x);
    }
}

/* Boxes around the first and the last bins, to each plane: count and surface. */
typedef struct bins {
    uint32_t count[BINS];
    float box[BINS][6];
} bins;

static void fill_bins(const builder *b, const range *r, int axis, const double extent[2],
                      bins *to) {
    memset(to->count, 0, sizeof to->count);
    for (uint32_t i = r->first; i < r->end; i++) {
        const float *box = b->boxes[b->ids[i]];
        const int k = bin_of(middle_of(box, axis), extent);
        if (to->count[k]++)
            widen(to->box[k], box);
        else
            memcpy(to->box[k], box, sizeof to->box[k]);
    }
}

/* Sum up bins from one end: the cost of the side below, or above, each plane. */
static void sweep(const bins *from, bool back, double cost[BINS]) {
    float box[6] = {0};
    uint32_t count = 0;
    for (int n = 0; n < BINS; n++) {
        const int k = back ? BINS - 1 - n : n;
        if (from->count[k] && count)
            widen(box, from->box[k]);
        else if (from->count[k])
            memcpy(box, from->box[k], sizeof box);
        count += from->count[k];
        cost[k] = count ? count * half_surface(box) : 0.0;
    }
}

static void try_axis(const builder *b, const range *r, int axis, cut *best) {
    double extent[2], below[BINS], above[BINS];
    bins all;
    middles_extent(b, r, axis, extent);
    if (!(extent[1] > extent[0]))
        return;
    fill_bins(b, r, axis, extent, &all);
    sweep(&all, false, below);
    sweep(&all, true, above);
    for (int k = 1; k < BINS; k++)
        if (below[k - 1] + above[k] < best->cost)
            *best = (cut){below[k - 1] + above[k], k, axis};
}

/* Sort a range's triangles by the bins on either side of the plane. Returns where the upper ones
 * begin. */
static uint32_t part_by(const builder *b, const range *r, const cut *at) {
    double extent[2];
    uint32_t low = r->first, high = r->end;
    middles_extent(b, r, at->axis, extent);
    while (low < high) {
        const uint32_t id = b->ids[low];
        if (bin_of(middle_of(b->boxes[id], at->axis), extent) < (int)at->plane) {
            low++;
        } else {
            b->ids[low] = b->ids[--high];
            b->ids[high] = id;
        }
    }
    return low;
}

/* Part a range in two, by the plane that costs least; by halves where none parts it. */
static uint32_t part(const builder *b, const range *r, uint32_t *axis) {
    cut best = {.cost = INFINITY};
    for (int a = 0; a < 3 && r->level < BY_HALVES; a++)
        try_axis(b, r, a, &best);
    *axis = (uint32_t)best.axis;
    const uint32_t at = isinf(best.cost) ? r->first : part_by(b, r, &best);
    return at > r->first && at < r->end ? at : r->first + (r->end - r->first) / 2;
}

/* Note where threads begin: at ranges that are few enough, below one that is not. */
static status note(builder *b, const range *r, uint32_t node, bool *top) {
    bounded_kdtree *t = b->t;
    const uint32_t count = r->end - r->first;
    *top = r->top && count > t->triangles / PARTS;
    if (!r->top)
        return ST_OK;
    status st;
    if (*top) {
        st = mem_grow(t->m, &t->tops, sizeof *t->tops, t->top_count, PARTS, &t->tops_room);
        if (st == ST_OK)
            t->tops[t->top_count++] = node;
        return st;
    }
    st = mem_grow(t->m, &t->parts, sizeof *t->parts, t->part_count, PARTS, &t->parts_room);
    if (st == ST_OK)
        t->parts[t->part_count++] = (bounded_part){node, node + count - 1};
    return st;
}

static status make_nodes(builder *b) {
    bounded_kdtree *t = b->t;
    range stack[STACK_MAX];
    int held = 0;
    status st = ST_OK;
    stack[held++] = (range){.end = t->triangles, .top = true};
    while (held > 0 && st == ST_OK) {
        const range r = stack[--held];
        if (r.end - r.first == 1) {
            if (r.slot)
                *r.slot = b->ids[r.first] | BOUNDED_LEAF;
            continue;
        }
        const uint32_t at = t->nodes++;
        bounded_node *node = &t->node[at];
        bool top;
        if (r.slot)
            *r.slot = at;
        const uint32_t middle = part(b, &r, &node->axis);
        st = note(b, &r, at, &top);
        stack[held++] = (range){middle, r.end, r.level + 1, &node->child[1], top};
        stack[held++] = (range){r.first, middle, r.level + 1, &node->child[0], top};
    }
    return st;
}

status bounded_kdtree_build(mem *m, const uint32_t (*rows)[3], uint32_t triangles,
                            const float (*positions)[3], bounded_kdtree *out) {
    *out = (bounded_kdtree){.m = m, .triangles = triangles, .rows = rows, .positions = positions};
    builder b = {.t = out,
                 .ids = mem_array(m, triangles, sizeof *b.ids),
                 .boxes = mem_array(m, triangles, sizeof *b.boxes)};
    out->node = mem_array(m, triangles, sizeof *out->node);
    out->box = mem_array(m, triangles, sizeof *out->box);
    status st = b.ids && b.boxes && out->node && out->box ? ST_OK : ST_NOMEM;
    for (uint32_t i = 0; i < triangles && st == ST_OK; i++) {
        b.ids[i] = i;
        box_of(out, i, b.boxes[i]);
    }
    if (st == ST_OK)
        st = make_nodes(&b);
    mem_free(m, b.boxes);
    mem_free(m, b.ids);
    if (st == ST_OK)
        st = bounded_kdtree_refit(out, positions, NULL);
    if (st != ST_OK)
        bounded_kdtree_release(out);
    return st;
}

void bounded_kdtree_release(bounded_kdtree *t) {
    if (!t->m)
        return;
    mem_free(t->m, t->tops);
    mem_free(t->m, t->parts);
    mem_free(t->m, t->box);
    mem_free(t->m, t->node);
    *t = (bounded_kdtree){0};
}

/* ---- Updates ---- */

static void refit_node(bounded_kdtree *t, uint32_t i) {
    bounded_node *node = &t->node[i];
    float box[2][6];
    for (int c = 0; c < 2; c++) {
        if (node->child[c] & BOUNDED_LEAF)
            box_of(t, node->child[c] & ~BOUNDED_LEAF, box[c]);
        else
            memcpy(box[c], t->box[node->child[c]], sizeof box[c]);
        node->lo[c] = box[c][node->axis];
        node->hi[c] = box[c][node->axis + 3];
    }
    widen(box[0], box[1]);
    memcpy(t->box[i], box[0], sizeof box[0]);
}

static status refit_part(void *ctx, size_t index, int worker) {
    bounded_kdtree *t = ctx;
    (void)worker;
    for (uint32_t i = t->parts[index].end; i-- > t->parts[index].first;)
        refit_node(t, i);
    return ST_OK;
}

status bounded_kdtree_refit(bounded_kdtree *t, const float (*positions)[3], pool *threads) {
    status st = ST_OK;
    t->positions = positions;
    if (threads)
        st = pool_run(threads, t->part_count, refit_part, t);
    for (size_t i = 0; i < t->part_count && !threads; i++)
        st = refit_part(t, i, 0);
    for (size_t i = t->top_count; i-- > 0 && st == ST_OK;)
        refit_node(t, t->tops[i]);
    return st;
}

/* ---- Rays ---- */

typedef struct visit {
    double near, far;
    uint32_t child;
} visit;

/* Cut a ray's interval to that of a child along an axis: M08 figure 5.12. False: nothing is left.
 */
static bool enter(const box_line *line, const bounded_node *node, int c, visit *v) {
    const uint32_t a = node->axis;
    const double lo = (double)node->lo[c], hi = (double)node->hi[c];
    v->child = node->child[c];
    if (line->inverse[a] == 0.0)
        return line->o[a] >= lo && line->o[a] <= hi;
    const bool back = line->inverse[a] < 0.0;
    const double in = ((back ? hi : lo) - line->o[a]) * line->inverse[a],
                 out = ((back ? lo : hi) - line->o[a]) * line->inverse[a], length = out - in,
                 first = in - 2.0 * BOX_INTERVAL_MARGIN * (fabs(in) + length),
                 last = out + 2.0 * BOX_INTERVAL_MARGIN * (fabs(out) + length);
    v->near = first > v->near ? first : v->near;
    v->far = last < v->far ? last : v->far;
    return !(v->near > v->far);
}

static void meet(const bounded_kdtree *t, uint32_t number, const ray *r, hit *best,
                 bounded_counts *counts) {
    const hit before = hit_before_all();
    triangle x = {.value = {0.0f}};
    flat_polygon g;
    hit found;
    for (int k = 0; k < 3; k++)
        memcpy(x.p[k], t->positions[t->rows[number][k]], sizeof x.p[k]);
    triangle_polygon(&x, &g);
    counts->triangles++;
    if (flat_polygon_hit(&g, r, number, 0, &before, &found) && triangle_less(&found, best))
        *best = found;
}

/* The root's box, as far as its two children have it. */
static bool begin(const bounded_kdtree *t, const box_line *line, visit *v) {
    double lo[3], hi[3];
    box_interval in;
    for (int a = 0; a < 3; a++) {
        lo[a] = (double)t->box[0][a];
        hi[a] = (double)t->box[0][a + 3];
    }
    if (!box_interval_in(line, lo, hi, &in))
        return false;
    *v = (visit){in.t_in, in.t_out, 0};
    return true;
}

bool bounded_kdtree_first(const bounded_kdtree *t, const ray *r, hit *found,
                          bounded_counts *counts) {
    const box_line line = box_line_of(r);
    visit stack[STACK_MAX];
    int held = 0;
    *found = hit_none();
    if (t->nodes == 0)
        meet(t, 0, r, found, counts);
    if (t->nodes > 0 && begin(t, &line, &stack[0]))
        held = 1;
    while (held > 0) {
        const visit v = stack[--held];
        if (v.near > found->t)
            continue;
        if (v.child & BOUNDED_LEAF) {
            meet(t, v.child & ~BOUNDED_LEAF, r, found, counts);
            continue;
        }
        /* Push the farther child first: the ray's direction along the axis tells which that is. */
        const bounded_node *node = &t->node[v.child];
        const int far = line.inverse[node->axis] < 0.0 ? 0 : 1;
        counts->nodes++;
        for (int n = 0; n < 2; n++) {
            stack[held] = v;
            held += enter(&line, node, n ? !far : far, &stack[held]);
        }
    }
    return hit_exists(found);
}

/* ---- Figures ---- */

double bounded_kdtree_cost(const bounded_kdtree *t) {
    double sum = 0.0;
    float box[6];
    for (uint32_t i = 0; i < t->nodes; i++)
        for (int c = 0; c < 2; c++) {
            const uint32_t child = t->node[i].child[c];
            if (child & BOUNDED_LEAF)
                box_of(t, child & ~BOUNDED_LEAF, box);
            sum += half_surface(child & BOUNDED_LEAF ? box : t->box[child]);
        }
    return t->nodes ? sum / half_surface(t->box[0]) : 0.0;
}

size_t bounded_kdtree_bytes(const bounded_kdtree *t) {
    return t->nodes * sizeof *t->node;
}
