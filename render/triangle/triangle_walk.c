#include "render/triangle/triangle_walk.h"

#include "formats/leaf/triangle_normal.h"
#include "render/walk/box_interval.h"
#include "render/walk/tree_passage.h"
#include "stream/moving_surface.h"

uint32_t triangle_walk_place(const leaf_file *f, uint64_t number, uint32_t *local) {
    const leaf_cells_directory *d = triangle_directory_of(f);
    if (f->moving)
        return moving_surface_find(f->moving, number, local);
    const uint32_t t = leaf_cells_treelet(d->first, f->layout.treelets, number);
    *local = (uint32_t)(number - d->first[t]);
    return t;
}

triangle triangle_walk_one(const triangle_blocks *b, uint32_t local) {
    const uint16_t *v = b->rows[local];
    triangle x = {.smooth = b->normals != NULL};
    for (int k = 0; k < TRIANGLE_CORNERS; k++) {
        for (int a = 0; a < 3; a++)
            x.p[k][a] = b->p[a][v[k]];
        x.value[k] = b->values[v[k]];
        x.normal[k] = b->normals ? b->normals[v[k]] : TRIANGLE_NO_NORMAL;
    }
    return x;
}

/* Whether the ray meets the box of a triangle, which costs less than the triangle. */
static bool passes_box(const box_line *line, const triangle *x) {
    double lo[3], hi[3];
    box_interval in;
    for (int a = 0; a < 3; a++) {
        float least = x->p[0][a], most = least;
        for (int k = 1; k < TRIANGLE_CORNERS; k++) {
            least = x->p[k][a] < least ? x->p[k][a] : least;
            most = x->p[k][a] > most ? x->p[k][a] : most;
        }
        lo[a] = (double)least;
        hi[a] = (double)most;
    }
    return box_interval_in(line, lo, hi, &in);
}

static bool meet(const triangle *x, uint64_t number, const ray *r, trace_state *state,
                 ray_counters *counters) {
    const hit *after = &state->after, from = {after->t, 0, -1, false},
              behind = {after->t, UINT64_MAX, after->iso, after->entering};
    flat_polygon g;
    hit found = {.t = 0.0};
    triangle_polygon(x, &g);
    counters->cells++;
    if (!flat_polygon_hit(&g, r, number, 0, &from, &found) || !triangle_less(&behind, &found))
        return false;
    counters->roots++;
    if (!triangle_less(&found, &state->best))
        return false;
    state->best = found;
    return true;
}

/* ---- Blocks on the way ---- */

enum { STACK_MAX = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY };

/* A walk through the tree over blocks, the nearest node at the top. Nobody resumes it, so it needs
 * no order of all that is ahead (tree_passage.h): boxes that motion has made large cost no more
 * than a look at each. */
typedef struct block_walk {
    const treelet_tree *tree;
    box_line slabs;
    double behind; /* boxes that the ray leaves before this t are of no interest */
    int held;
    tree_passage_node stack[STACK_MAX];
} block_walk;

static bool enter(const block_walk *w, tree_passage_node *node) {
    return tree_passage_enters(w->tree, &w->slabs, w->behind, node);
}

static void begin_walk(block_walk *w, const treelet_tree *tree, const ray *r, const hit *after) {
    tree_passage_node root = {.level = tree->levels - 1};
    w->tree = tree;
    w->slabs = box_line_of(r);
    w->behind = box_interval_behind(tree->bounds[tree->levels - 1][0], r, after);
    w->held = 0;
    if (enter(w, &root))
        w->stack[w->held++] = root;
}

/* Push what the ray enters of a node's children, the farthest first. */
static void push_children(block_walk *w, const tree_passage_node *node, double limit) {
    uint32_t count, first = treelet_tree_children(w->tree, node->level, node->i, &count);
    const int bottom = w->held;
    for (uint32_t c = 0; c < count; c++) {
        tree_passage_node child = {.level = node->level - 1, .i = first + c};
        if (!enter(w, &child) || child.t_in > limit)
            continue;
        int at = w->held++;
        for (; at > bottom && w->stack[at - 1].t_in < child.t_in; at--)
            w->stack[at] = w->stack[at - 1];
        w->stack[at] = child;
    }
}

/* Returns the next block that the ray enters at `limit` or before; LEAF_NO_TREELET: none is left.
 */
static uint32_t next_block(block_walk *w, double limit, ray_counters *counters) {
    while (w->held > 0) {
        const tree_passage_node node = w->stack[--w->held];
        if (node.t_in > limit)
            continue;
        if (node.level == 0)
            return node.i;
        counters->nodes++;
        push_children(w, &node, limit);
    }
    return LEAF_NO_TREELET;
}

bool triangle_walk_hits(const triangle_blocks *b, bool coloured, const ray *r, trace_state *state,
                        ray_counters *counters) {
    block_walk w;
    box_line line = box_line_of(r);
    triangle best;
    uint32_t at;
    bool changed = false;
    line.t0 = -INFINITY;
    line.t1 = INFINITY;
    begin_walk(&w, &b->tree, r, &state->after);
    while ((at = next_block(&w, state->best.t, counters)) != LEAF_NO_TREELET) {
        for (unsigned left = b->active[at]; left; left &= left - 1) {
            const uint32_t i = TRIANGLE_BLOCK * at + (uint32_t)__builtin_ctz(left);
            const uint64_t number = triangle_blocks_number(b, i);
            const triangle x = triangle_walk_one(b, i);
            /* A flat piece that the ray begins on is met nowhere else. */
            if (number == state->origin || !passes_box(&line, &x) ||
                !meet(&x, number, r, state, counters))
                continue;
            best = x;
            changed = true;
            if (state->any)
                return true;
        }
    }
    if (changed)
        state->point = triangle_point(&best, r, &state->best, coloured);
    return changed;
}
