#include "render/grid/grid_extreme.h"

#include "render/grid/block_passage.h"
#include "render/grid/grid_passage.h"
#include "render/ray/segments.h"

/* ---- Treelets ---- */

static float bound_of(const tracer *tr, const extreme_state *s, const grid_passage *node) {
    const leaf_file *f = tr->treelets->file;
    const uint32_t at = leaf_layout_samples(tr->layout, tr->set, node->t);
    return extreme_bound(s, grid_passage_drawn(tr, node) ? f->own[at] : f->ranges[at]);
}

/* A preview skips treelet t or draws it coarser: raise the doubt of the result to t's bound. */
static void doubt(const tracer *tr, extreme_state *s, uint32_t t) {
    const float bound =
        extreme_bound(s, tr->treelets->file->ranges[leaf_layout_samples(tr->layout, tr->set, t)]);
    s->doubt = bound > s->doubt ? bound : s->doubt;
}

void grid_extreme_ways(const tracer *tr, const ray *r, extreme_ways *ways, ray_counters *counters) {
    double t_in = r->t0, t_out = r->t1;
    grid_passage stack[GRID_PASSAGES_MAX];
    int top = 0;
    if (!tracer_box(tr, r, &t_in, &t_out))
        return;
    stack[top++] = (grid_passage){t_in, t_out, 0, 0};
    while (top > 0) {
        const grid_passage node = stack[--top];
        bool absent = false;
        if (!(node.t_in < node.t_out))
            continue;
        const float bound = bound_of(tr, ways->state, &node);
        if (extreme_ways_skip(ways, bound, node.t_in))
            continue;
        if (!grid_passage_drawn(tr, &node)) {
            counters->nodes++;
            top = grid_passage_push(tr, r, &node, stack, top, &absent);
            if (absent)
                doubt(tr, ways->state, node.t);
        } else if (tr->treelets->own[node.t]) {
            extreme_ways_take(ways,
                              &(extreme_way){node.t_in, node.t_out, bound, node.t, node.octants});
        }
    }
}

/* ---- Codes ---- */

/* A search through one treelet: what does not change on the way, and what has been found. */
typedef struct extreme_search {
    const walk_scene *scene;
    const resident_grid *at;
    const ray *r;
    extreme_state *s;
    ray_counters *counters;
    quantizer codes;
    int above, level; /* a node whose score's code is less than `above` has no score above what has
                         been found; less than `level`: none as great */
} extreme_search;

/* code_up() - returns the least code that a value of at least `value` can have. code_down() -
 * returns the greatest code that a value of at most `value` can have. */
static int code_up(const quantizer *q, double value) {
    if (!(value <= q->hi))
        return 256;
    value = value > q->lo ? value : q->lo;
    return quantizer_ceil(q, q->exact ? ceil(value) : value);
}

static int code_down(const quantizer *q, double value) {
    if (!(value >= q->lo))
        return -1;
    value = value < q->hi ? value : q->hi;
    return quantizer_floor(q, q->exact ? floor(value) : value);
}

/* Set c->level and c->above. A code's score is the code, or 255 minus it for the least. */
static void set_limits(extreme_search *c) {
    const quantizer *q = &c->codes;
    const double value = extreme_value(c->s);
    if (c->s->least) {
        c->level = 255 - code_down(q, value);
        c->above = q->exact ? 255 - code_down(q, ceil(value) - 1.0) : c->level;
    } else {
        c->level = code_up(q, value);
        c->above = q->exact ? code_up(q, floor(value) + 1.0) : c->level;
    }
}

/* Returns the score, as a code, of a node of 2^size cells on a side: a block or larger. */
static int node_score(const extreme_search *c, uint32_t size, uint32_t morton) {
    const uint32_t k = c->at->shape.node_levels + LEAF_BLOCK_LOG2 - size;
    const uint8_t *lo = (const uint8_t *)c->at->head.payload + leaf_codes_at(k);
    return c->s->least ? 255 - lo[morton] : lo[(UINT32_C(1) << (3 * k)) + morton];
}

/* ---- Cells ---- */

static double greatest_sample(const extreme_state *s, const float samples[8]) {
    float least = samples[0], most = samples[0];
    for (int i = 1; i < 8; i++) {
        least = samples[i] < least ? samples[i] : least;
        most = samples[i] > most ? samples[i] : most;
    }
    return s->least ? -(double)least : (double)most;
}

/* Returns a bound of the score: no value is beyond all control values, except by the rounding of
 * three means of means. */
static double greatest_control(const extreme_state *s, const double b[4]) {
    double least = b[0], most = b[0];
    for (int i = 1; i < 4; i++) {
        least = b[i] < least ? b[i] : least;
        most = b[i] > most ? b[i] : most;
    }
    return (s->least ? -least : most) + 0x1p-48 * (fabs(least) + fabs(most));
}

bool grid_extreme_cell(const walk_scene *scene, const resident_grid *at, const ray *r,
                       const uint32_t cell[3], const float samples[8], extreme_state *s) {
    const cell_box box = walk_cell_box(&scene->levels[at->level], cell);
    cell_visit visit;
    if (!cell_visit_of(r, &box, &visit) || !(visit.t_in < visit.t_out))
        return false;
    segment piece = {.t0 = visit.t_in, .t1 = visit.t_out, .degree = 3};
    cell_values(&visit, samples, 0.0, piece.b);
    if (!extreme_matters(s, greatest_control(s, piece.b), visit.t_in))
        return false;
    const segment_extent e = segment_range(&piece);
    const double most = greatest_sample(s, samples), score = s->least ? -e.least : e.most;
    return extreme_offer(s, score < most ? score : most, s->least ? e.least_t : e.most_t,
                         at->head.id);
}

static void try_cell(extreme_search *c, const uint32_t cell[3], double t_in) {
    float samples[8];
    const double before = c->s->score;
    walk_cell_samples(c->scene, c->at, cell, samples);
    if (!extreme_matters(c->s, greatest_sample(c->s, samples), t_in))
        return;
    c->counters->cells++;
    (void)grid_extreme_cell(c->scene, c->at, c->r, cell, samples, c->s);
    if (c->s->score > before)
        set_limits(c);
}

/* ---- Nodes ---- */

typedef struct pending {
    double t_in, t_out;
    uint32_t cell[3];
    uint32_t morton;
    uint32_t size; /* 2^size cells on a side */
    int score;     /* its greatest one, as a code */
} pending;

enum { STACK_MAX = 4 * (LEAF_CELLS_LOG2_MAX + 1) };

static bool node_matters(const extreme_search *c, int score, double t_in) {
    return score >= c->above || (score >= c->level && t_in < c->s->t);
}

/* Push the children that matter: the best last, of equal ones the nearest last. */
static int push_children(const extreme_search *c, const pending *node, unsigned octants,
                         pending stack[STACK_MAX], int top) {
    const level_planes *planes = &c->scene->levels[c->at->level];
    const unsigned mask = walk_children(c->at, node->size, node->morton) & octants;
    const uint32_t half = 1u << (node->size - 1);
    const int bottom = top;
    double middle[3];
    octree_child children[4];
    c->counters->nodes++;
    for (int a = 0; a < 3; a++)
        middle[a] = planes->at[a][node->cell[a] + half];
    for (int i = octree_step(c->r, middle, node->t_in, node->t_out, children); i-- > 0;) {
        const unsigned o = children[i].octant;
        const uint32_t morton = node->morton << 3 | o;
        if (!(mask >> o & 1u) || !(children[i].t_in < children[i].t_out))
            continue;
        const int score = node_score(c, node->size - 1, morton);
        if (!node_matters(c, score, children[i].t_in))
            continue;
        int at = top++;
        for (; at > bottom && stack[at - 1].score > score; at--)
            stack[at] = stack[at - 1];
        stack[at] =
            (pending){children[i].t_in, children[i].t_out, {0}, morton, node->size - 1, score};
        for (int a = 0; a < 3; a++)
            stack[at].cell[a] = node->cell[a] + (o >> a & 1u ? half : 0);
    }
    return top;
}

/* ---- Blocks ---- */

/* Search the active cells of a block that the ray passes, as long as the block's bound matters:
 * cells have no codes. */
static void walk_block(extreme_search *c, const pending *block) {
    block_passage p =
        block_passage_begin(&c->scene->levels[c->at->level], c->r, block->cell,
                            c->at->masks->cells[block->morton], block->t_in, block->t_out);
    uint32_t in_block[3], cell[3];
    double from;
    c->counters->nodes++;
    while (block_passage_next(&p, in_block, &from) && node_matters(c, block->score, from)) {
        for (int a = 0; a < 3; a++)
            cell[a] = block->cell[a] + in_block[a];
        try_cell(c, cell, from);
    }
}

/* ---- The tree ---- */

static extreme_search extreme_search_of(const tracer *tr, const resident_grid *at, const ray *r,
                                        extreme_state *s, ray_counters *counters) {
    const uint32_t p = leaf_layout_samples(tr->layout, tr->set, at->head.id);
    const float *own = tr->treelets->file->own[p];
    extreme_search c = {.scene = tr->own,
                        .at = at,
                        .r = r,
                        .s = s,
                        .counters = counters,
                        .codes = quantizer_of(own[0], own[1], tr->layout->type)};
    set_limits(&c);
    return c;
}

void grid_extreme(const tracer *tr, const treelet *found, const ray *r, const extreme_way *way,
                  extreme_state *s, ray_counters *counters) {
    const resident_grid *at = resident_grid_of(found);
    extreme_search c = extreme_search_of(tr, at, r, s, counters);
    unsigned octants = way->octants ? way->octants : 255u;
    pending stack[STACK_MAX];
    int top = 0;
    stack[top++] = (pending){way->t_in,
                             way->t_out,
                             {at->first_cell[0], at->first_cell[1], at->first_cell[2]},
                             0,
                             at->shape.node_levels + LEAF_BLOCK_LOG2,
                             255};
    while (top > 0) {
        const pending p = stack[--top];
        if (!node_matters(&c, p.score, p.t_in))
            continue;
        if (p.size > LEAF_BLOCK_LOG2)
            top = push_children(&c, &p, octants, stack, top);
        else
            walk_block(&c, &p);
        octants = 255u;
    }
}

/* ---- Near a place ---- */

/* Returns the treelet's cell that owns a coordinate, or the nearest one, counted within the
 * treelet. */
static uint32_t cell_near(const level_planes *planes, const resident_grid *at, int a, double x) {
    uint32_t lo = 0, hi = at->shape.cells[a];
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (planes->at[a][at->first_cell[a] + middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

void grid_extreme_near(const tracer *tr, const treelet *found, const ray *r, double t,
                       extreme_state *s, ray_counters *counters) {
    const resident_grid *at = resident_grid_of(found);
    extreme_search c = extreme_search_of(tr, at, r, s, counters);
    const uint32_t levels = at->shape.node_levels + LEAF_BLOCK_LOG2;
    uint32_t cell[3], morton = 0;
    for (int a = 0; a < 3; a++) {
        const uint32_t i = cell_near(&c.scene->levels[at->level], at, a, r->o[a] + t * r->d[a]);
        cell[a] = at->first_cell[a] + i;
        for (uint32_t k = 0; k < levels; k++)
            morton |= (i >> k & 1u) << (3 * k + (uint32_t)a);
    }
    if (walk_children(at, 1, morton >> 3) >> (morton & 7u) & 1u)
        try_cell(&c, cell, t);
}
