#include "render/grid/walk.h"

#include "render/grid/octree_step.h"

cell_box walk_cell_box(const level_planes *planes, const uint32_t cell[3]) {
    cell_box box;
    for (int a = 0; a < 3; a++) {
        box.lo[a] = planes->at[a][cell[a]];
        box.hi[a] = planes->at[a][cell[a] + 1];
        box.inv[a] = planes->inverse[a][cell[a]];
        box.last[a] = cell[a] + 1 == planes->cells[a];
    }
    return box;
}

#define SAMPLES_OF(NAME, TYPE)                                                                  \
    static void NAME(const void *base, size_t at, size_t row, size_t slice, float samples[8]) { \
        const TYPE *s = (const TYPE *)base + at;                                                \
        samples[0] = (float)s[0];                                                               \
        samples[1] = (float)s[1];                                                               \
        samples[2] = (float)s[row];                                                             \
        samples[3] = (float)s[row + 1];                                                         \
        samples[4] = (float)s[slice];                                                           \
        samples[5] = (float)s[slice + 1];                                                       \
        samples[6] = (float)s[slice + row];                                                     \
        samples[7] = (float)s[slice + row + 1];                                                 \
    }

SAMPLES_OF(samples_u8, uint8_t)
SAMPLES_OF(samples_i8, int8_t)
SAMPLES_OF(samples_u16, uint16_t)
SAMPLES_OF(samples_i16, int16_t)
SAMPLES_OF(samples_f32, float)

static void samples_at(sample_type type, const void *base, size_t at, size_t row, size_t slice,
                       float samples[8]) {
    switch (type) {
    case SAMPLE_U8: samples_u8(base, at, row, slice, samples); return;
    case SAMPLE_I8: samples_i8(base, at, row, slice, samples); return;
    case SAMPLE_U16: samples_u16(base, at, row, slice, samples); return;
    case SAMPLE_I16: samples_i16(base, at, row, slice, samples); return;
    default: samples_f32(base, at, row, slice, samples);
    }
}

void walk_cell_samples(const walk_scene *scene, const resident_grid *tr, const uint32_t cell[3],
                       float samples[8]) {
    size_t at[3];
    for (int a = 0; a < 3; a++)
        at[a] = cell[a] - tr->first_cell[a] + scene->halo;
    const size_t row = tr->shape.samples[0], slice = row * tr->shape.samples[1];
    samples_at(scene->type, tr->samples, at[0] + row * at[1] + slice * at[2], row, slice, samples);
}

/* Lower *best to the first hit of any selected isosurface in one active cell. Returns whether *best
 * changed. */
static bool intersect_cell(const walk_scene *scene, const resident_grid *tr, const ray *r,
                           const uint32_t cell[3], const hit *after, hit *best,
                           ray_counters *counters) {
    const level_planes *planes = &scene->levels[tr->level];
    const cell_box box = walk_cell_box(planes, cell);
    cell_visit visit;
    counters->cells++;
    if (!cell_visit_of(r, &box, &visit))
        return false;
    float samples[8];
    walk_cell_samples(scene, tr, cell, samples);
    const uint64_t index = walk_cell_index(planes, cell);
    bool changed = false;
    for (int i = 0; i < scene->count; i++) {
        hit found;
        if (!cell_next_hit(r, &visit, samples, scene->isovalues[i], i, index, after, &found))
            continue;
        counters->roots++;
        if (hit_less(&found, best)) {
            *best = found;
            changed = true;
        }
    }
    return changed;
}

/* A node still to be visited: a cube of 2^size cells, the first at `cell` of the level. A byte of
 * the masks tells its active children. */
typedef struct pending {
    double t_in, t_out;
    uint32_t cell[3];
    uint32_t morton; /* its place among the nodes of its size, in Morton order */
    uint32_t size;
} pending;

/* How far down masks are used; below, cells are found by their samples. Pictures use FINEST_CELL
 * only; experiment E1 compares it with the others. */
typedef enum finest { FINEST_CELL, FINEST_GROUP, FINEST_BLOCK } finest;

/* Returns whether a cell exists and is active, by its samples. */
static bool cell_is_active(const walk_scene *scene, const resident_grid *tr,
                           const uint32_t cell[3]) {
    for (int a = 0; a < 3; a++)
        if (cell[a] - tr->first_cell[a] >= tr->shape.cells[a])
            return false;
    float s[8];
    walk_cell_samples(scene, tr, cell, s);
    for (int i = 0; i < scene->count; i++) {
        int inside = 0;
        for (int c = 0; c < 8; c++)
            inside += (double)s[c] >= scene->isovalues[i];
        if (inside != 0 && inside != 8)
            return true;
    }
    return false;
}

enum { STACK_MAX = 4 * (LEAF_CELLS_LOG2_MAX + 1) };

static inline bool walk_to(finest known, const walk_scene *scene, const resident_grid *tr,
                           const ray *r, double t_in, double t_out, unsigned octants,
                           const hit *after, hit *best, ray_counters *counters) {
    const level_planes *planes = &scene->levels[tr->level];
    pending stack[STACK_MAX];
    int top = 0;
    stack[top++] = (pending){t_in,
                             t_out,
                             {tr->first_cell[0], tr->first_cell[1], tr->first_cell[2]},
                             0,
                             tr->shape.node_levels + LEAF_BLOCK_LOG2};
    bool changed = false;
    unsigned wanted = octants;
    while (top > 0) {
        const pending node = stack[--top];
        /* Nodes come front to back: nothing behind can come before the best hit any more. */
        if (node.t_in > best->t)
            break;
        if (node.size == 0) {
            if (known == FINEST_CELL || cell_is_active(scene, tr, node.cell))
                changed |= intersect_cell(scene, tr, r, node.cell, after, best, counters);
            continue;
        }
        counters->nodes++;
        const unsigned mask =
            (node.size <= (uint32_t)known ? 255u : walk_children(tr, node.size, node.morton)) &
            wanted;
        wanted = 255u;
        if (!mask)
            continue;
        const uint32_t half = 1u << (node.size - 1);
        const double middle[3] = {planes->at[0][node.cell[0] + half],
                                  planes->at[1][node.cell[1] + half],
                                  planes->at[2][node.cell[2] + half]};
        octree_child children[4];
        for (int i = octree_step(r, middle, node.t_in, node.t_out, children); i-- > 0;) {
            const unsigned o = children[i].octant;
            if (!(mask >> o & 1u))
                continue;
            stack[top++] =
                (pending){children[i].t_in,
                          children[i].t_out,
                          {node.cell[0] + (o & 1u ? half : 0), node.cell[1] + (o & 2u ? half : 0),
                           node.cell[2] + (o & 4u ? half : 0)},
                          node.morton << 3 | o,
                          node.size - 1};
        }
    }
    return changed;
}

bool walk_treelet(const walk_scene *scene, const resident_grid *tr, const ray *r, double t_in,
                  double t_out, unsigned octants, const hit *after, hit *best,
                  ray_counters *counters) {
    return walk_to(FINEST_CELL, scene, tr, r, t_in, t_out, octants, after, best, counters);
}

bool walk_treelet_groups(const walk_scene *scene, const resident_grid *tr, const ray *r,
                         double t_in, double t_out, unsigned octants, const hit *after, hit *best,
                         ray_counters *counters) {
    return walk_to(FINEST_GROUP, scene, tr, r, t_in, t_out, octants, after, best, counters);
}

bool walk_treelet_corners(const walk_scene *scene, const resident_grid *tr, const ray *r,
                          double t_in, double t_out, unsigned octants, const hit *after, hit *best,
                          ray_counters *counters) {
    return walk_to(FINEST_BLOCK, scene, tr, r, t_in, t_out, octants, after, best, counters);
}
