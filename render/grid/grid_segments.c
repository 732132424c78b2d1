#include "render/grid/grid_segments.h"

#include "render/grid/block_passage.h"
#include "render/grid/block_way.h"
#include "render/grid/grid_way.h"

/* A node of a treelet still to be visited, as in walk.c. */
typedef struct pending {
    double t_in, t_out;
    uint32_t cell[3];
    uint32_t morton;
    uint32_t size; /* 2^size cells on a side */
} pending;

/* The constants of a walk through a treelet. */
typedef struct collector {
    const tracer *tr;
    const walk_scene *scene;
    const resident_grid *at;
    bool bounded; /* as in grid_way */
    const active_masks *masks;
    const ray *r;
    segments_state *state;
    ray_counters *counters;
} collector;

static bool is_even(const float samples[8]) {
    bool even = true;
    for (int i = 1; i < 8; i++)
        even = even && samples[i] == samples[0];
    return even;
}

/* Append the piece in a cell, if there is one. Returns false if there is no room for it. */
static bool take_cell(const collector *c, const uint32_t cell[3]) {
    const level_planes *planes = &c->scene->levels[c->at->level];
    const cell_box box = walk_cell_box(planes, cell);
    segments_state *s = c->state;
    cell_visit visit;
    float samples[8];
    c->counters->cells++;
    if (!cell_visit_of(c->r, &box, &visit))
        return true;
    if (s->count == s->room)
        return false;
    walk_cell_samples(c->scene, c->at, cell, samples);
    segment *piece = &s->ahead[s->count++];
    *piece = (segment){.t0 = visit.t_in,
                       .t1 = visit.t_out,
                       .cell = walk_cell_index(planes, cell),
                       .treelet = c->at->head.id,
                       .degree = 3};
    if (c->bounded)
        piece->spread = resident_grid_deviation(c->at, c->tr->layout, cell);
    cell_values(&visit, samples, c->tr->above, piece->b);
    if (!c->bounded && is_even(samples)) {
        piece->spread = SEGMENT_EVEN;
        piece->b[1] = piece->b[2] = (double)samples[0] - c->tr->above;
    }
    s->t_from = visit.t_out;
    return true;
}

/* Append the piece of a whole node or treelet. cell: its first cell. Returns false if there is no
 * room. */
static bool take_whole(segments_state *s, ray_counters *counters, const segment *piece,
                       uint64_t cell) {
    counters->cells++;
    if (s->count == s->room)
        return false;
    s->ahead[s->count] = *piece;
    s->ahead[s->count++].cell = cell;
    s->t_from = piece->t1;
    return true;
}

enum { STACK_MAX = 4 * (LEAF_CELLS_LOG2_MAX + 1) };

static int push_children(const collector *c, const pending *node, unsigned octants,
                         pending stack[STACK_MAX], int top) {
    const level_planes *planes = &c->scene->levels[c->at->level];
    const unsigned mask = walk_children_of(c->at, c->masks, node->size, node->morton) & octants;
    const uint32_t half = 1u << (node->size - 1);
    double middle[3];
    octree_child children[4];
    c->counters->nodes++;
    for (int a = 0; a < 3; a++)
        middle[a] = planes->at[a][node->cell[a] + half];
    for (int i = octree_step(c->r, middle, node->t_in, node->t_out, children); i-- > 0;) {
        const unsigned o = children[i].octant;
        if (!(mask >> o & 1u) || !(children[i].t_in < children[i].t_out))
            continue;
        pending *child = &stack[top++];
        *child = (pending){
            children[i].t_in, children[i].t_out, {0}, node->morton << 3 | o, node->size - 1};
        for (int a = 0; a < 3; a++)
            child->cell[a] = node->cell[a] + (o >> a & 1u ? half : 0);
    }
    return top;
}

/* Append the pieces of the active cells in a block. Returns false if there was no room for all. */
static bool walk_block(const collector *c, const pending *block) {
    block_passage p =
        block_passage_begin(&c->scene->levels[c->at->level], c->r, block->cell,
                            c->masks->cells[block->morton], block->t_in, block->t_out);
    uint32_t in_block[3], cell[3];
    double from;
    c->counters->nodes++;
    while (block_passage_next(&p, in_block, &from)) {
        for (int a = 0; a < 3; a++)
            cell[a] = block->cell[a] + in_block[a];
        if (!take_cell(c, cell))
            return false;
    }
    return true;
}

/* Returns whether the node is the largest one that is taken whole there. */
static bool is_whole(const collector *c, const pending *node) {
    const active_masks *masks = c->masks;
    if (!masks->some_whole || node->size == c->at->shape.node_levels + LEAF_BLOCK_LOG2)
        return false;
    const uint32_t levels = node->size - LEAF_BLOCK_LOG2;
    return masks->whole[node->morton << 3 * levels] == levels + 1;
}

static bool walk_whole(const collector *c, const pending *node) {
    const uint32_t levels = node->size - LEAF_BLOCK_LOG2;
    const block_stretch all = {.t_in = node->t_in,
                               .t_out = node->t_out,
                               .node = node->morton << 3 * levels,
                               .whole = levels + 1};
    const segment piece = block_way_node(c->tr->treelets->file, c->tr->layout, c->at, &all);
    return take_whole(c->state, c->counters, &piece,
                      walk_cell_index(&c->scene->levels[c->at->level], node->cell));
}

/* Append the pieces in a treelet, front to back. Returns false if there was no room for all of
 * them. */
static bool walk_pieces(const collector *c, const grid_passage *node) {
    unsigned octants = node->octants ? node->octants : 255u;
    pending stack[STACK_MAX];
    int top = 0;
    stack[top++] = (pending){node->t_in,
                             node->t_out,
                             {c->at->first_cell[0], c->at->first_cell[1], c->at->first_cell[2]},
                             0,
                             c->at->shape.node_levels + LEAF_BLOCK_LOG2};
    while (top > 0) {
        const pending p = stack[--top];
        const bool whole = is_whole(c, &p);
        if (whole ? !walk_whole(c, &p) : p.size == LEAF_BLOCK_LOG2 && !walk_block(c, &p))
            return false;
        if (!whole && p.size > LEAF_BLOCK_LOG2)
            top = push_children(c, &p, octants, stack, top);
        octants = 255u;
    }
    return true;
}

/* Append a doubt. Returns false if there is no room. */
static bool tell_doubt(segments_state *s, ray_counters *counters, const segment *doubt) {
    counters->cells++;
    if (s->count == s->room)
        return false;
    s->ahead[s->count++] = *doubt;
    s->doubted = doubt->treelet;
    s->t_from = doubt->t0;
    return true;
}

/* Append the piece of a whole treelet that is not in memory. Returns false if there is no room. */
static bool walk_treelet_whole(const collector *c, const grid_passage *node) {
    const leaf_layout *layout = c->tr->layout;
    uint32_t cell[3];
    if (node->t == LEAF_NO_TREELET)
        return true;
    const segment piece = block_way_treelet(c->tr, node->t, node->t_in, node->t_out);
    for (int a = 0; a < 3; a++)
        cell[a] = layout->place[node->t][a] << layout->cells_log2;
    return take_whole(c->state, c->counters, &piece,
                      walk_cell_index(&c->scene->levels[layout->level_of[node->t]], cell));
}

/* Returns SEGMENTS_SOME if there are pieces to give, else `otherwise`: why there are none. */
static segments_result stop(segments_state *state, segments_result otherwise) {
    state->sure = state->count;
    return state->count > 0 ? SEGMENTS_SOME : otherwise;
}

segments_result grid_segments(const tracer *tr, const ray *r, segments_state *state,
                              ray_counters *counters) {
    grid_way way;
    grid_passage passage;
    const resident_grid *at;
    if (!grid_way_begin(&way, tr, r, state))
        return SEGMENTS_END;
    for (;;) {
        if (tr->lenient && state->count > 0) /* do not look for what may be lost too soon */
            return stop(state, SEGMENTS_SOME);
        const segments_result next = grid_way_next(&way, tr, r, state, counters, &at, &passage);
        if (next != SEGMENTS_SOME)
            return stop(state, next);
        const collector c = {.tr = tr,
                             .scene = tr->own,
                             .at = at,
                             .bounded = way.bounded,
                             .masks = !at           ? NULL
                                      : way.bounded ? at->wide
                                                    : at->masks,
                             .r = r,
                             .state = state,
                             .counters = counters};
        if (way.doubted && !tell_doubt(state, counters, &way.doubt))
            return stop(state, SEGMENTS_SOME);
        if (at ? !walk_pieces(&c, &passage) : !walk_treelet_whole(&c, &passage))
            return stop(state, SEGMENTS_SOME);
    }
}

segments_error grid_segments_error(const tracer *tr, const ray *r, const double range[2]) {
    const walk_scene *scene = tr->own;
    const double u = 0x1p-53;
    double steps = 0.0, t_out = r->t1, t_in = r->t0;
    for (int a = 0; a < 3; a++) {
        const double far = fmax(fabs(tr->box[0][a] - r->o[a]), fabs(tr->box[1][a] - r->o[a]));
        steps += 16.0 * u * far / scene->narrowest[a];
    }
    (void)tracer_box(tr, r, &t_in, &t_out);
    return (segments_error){.t = 4.0 * u * fmax(fabs(t_in), fabs(t_out)),
                            .value = (range[1] - range[0]) * steps +
                                     16.0 * u * fmax(fabs(range[0]), fabs(range[1]))};
}
