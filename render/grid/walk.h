/* walk.h - one ray through one treelet: the nearest hit with the selected isosurfaces.
 *
 * Descends the masks of active cells front to back; every active cell on the way goes to
 * cell_next_hit().
 */
#ifndef RENDER_GRID_WALK_H
#define RENDER_GRID_WALK_H

#include <stdint.h>

#include "formats/base/sample.h"
#include "render/grid/cell_kernel.h"
#include "render/grid/level_planes.h"
#include "render/ray/counters.h"
#include "render/ray/ray.h"
#include "stream/grid_resident.h"
#include "stream/loader.h"

/* Cells along each axis of a block. */
enum { BLOCK_SIDE = 1 << LEAF_BLOCK_LOG2 };

typedef struct walk_scene walk_scene;

/* walk_treelet() - lower *best to the first hit in this treelet strictly after `after`, if that hit
 * is less than *best. [t_in, t_out] holds the ray's interval in the treelet; octants: which eighths
 * of it to look at (255: all). Returns whether *best changed. */
typedef bool (*walk_fn)(const walk_scene *scene, const resident_grid *tr, const ray *r, double t_in,
                        double t_out, unsigned octants, const hit *after, hit *best,
                        ray_counters *counters);

/* A grid, prepared for the rays of a frame. */
struct walk_scene {
    const level_planes *levels;
    const double *isovalues;
    int count;
    sample_type type;
    uint32_t halo;
    walk_fn walk;   /* for rays that walk alone */
    uint8_t packet; /* side, in pixels, of the squares of a tile that walk together: GRID_TILE or
                       less */
    bool by_cell;   /* a batch never holds ray-cells of more than one cell */
    bool analytic_normals; /* normals from the cell's own gradient, not from central differences */
    double narrowest[3];   /* width of the narrowest cell of level 0 on each axis, grid space */
};

bool walk_treelet(const walk_scene *scene, const resident_grid *tr, const ray *r, double t_in,
                  double t_out, unsigned octants, const hit *after, hit *best,
                  ray_counters *counters);

/* Both return the same result as walk_treelet(), without the masks of cells, for experiment E1.
 * walk_treelet_groups() uses masks down to groups of 2^3 cells, walk_treelet_corners() down to
 * blocks. Below that, each cell is tested by its samples. */
bool walk_treelet_groups(const walk_scene *scene, const resident_grid *tr, const ray *r,
                         double t_in, double t_out, unsigned octants, const hit *after, hit *best,
                         ray_counters *counters);
bool walk_treelet_corners(const walk_scene *scene, const resident_grid *tr, const ray *r,
                          double t_in, double t_out, unsigned octants, const hit *after, hit *best,
                          ray_counters *counters);

/* walk_cell_box() - returns the planes of a cell of a level. */
cell_box walk_cell_box(const level_planes *planes, const uint32_t cell[3]);

/* walk_cell_samples() - reads a cell's eight samples from its treelet: corner x + 2y + 4z. */
void walk_cell_samples(const walk_scene *scene, const resident_grid *tr, const uint32_t cell[3],
                       float samples[8]);

/* walk_cell_prefetch() - prefetches a cell's samples, which will be read soon. */
static inline void walk_cell_prefetch(const walk_scene *scene, const resident_grid *tr,
                                      const uint32_t cell[3]) {
    size_t at[3];
    for (int a = 0; a < 3; a++)
        at[a] = cell[a] - tr->first_cell[a] + scene->halo;
    const size_t size = sample_size(scene->type);
    const size_t row = size * tr->shape.samples[0], slice = row * tr->shape.samples[1];
    const char *first = (const char *)tr->samples + size * at[0] + row * at[1] + slice * at[2];
    __builtin_prefetch(first);
    __builtin_prefetch(first + row);
    __builtin_prefetch(first + slice);
    __builtin_prefetch(first + slice + row);
}

/* walk_children() - returns the mask of active children of a node of 2^size cells on a side. The
 * children of a block are its groups of 2^3 cells, the children of a group its cells. morton: the
 * node's place among the nodes of its size. walk_children_of() uses the given masks instead of the
 * treelet's. */
static inline unsigned walk_children_of(const resident_grid *tr, const active_masks *masks,
                                        uint32_t size, uint32_t morton) {
    if (size > LEAF_BLOCK_LOG2) {
        const uint32_t k = tr->shape.node_levels + LEAF_BLOCK_LOG2 - size;
        return k == 0 ? masks->root : masks->nodes[active_nodes_at(k) + morton];
    }
    const uint64_t cells = masks->cells[size == LEAF_BLOCK_LOG2 ? morton : morton >> 3];
    if (size < LEAF_BLOCK_LOG2)
        return (unsigned)(cells >> (8 * (morton & 7u))) & 255u;
    unsigned groups = 0;
    for (unsigned g = 0; g < 8; g++)
        groups |= (unsigned)((cells >> (8 * g) & 255u) != 0) << g;
    return groups;
}

static inline unsigned walk_children(const resident_grid *tr, uint32_t size, uint32_t morton) {
    return walk_children_of(tr, tr->masks, size, morton);
}

static inline uint64_t walk_cell_index(const level_planes *planes, const uint32_t cell[3]) {
    return cell[0] + (uint64_t)planes->cells[0] * (cell[1] + (uint64_t)planes->cells[1] * cell[2]);
}

#endif
