/* walk.h - one ray through one treelet: the nearest hit with the selected isosurfaces.
 *
 * Descends the masks of active cells front to back; every active cell on the way goes to the
 * intersector.
 */
#ifndef RENDER_WALK_H
#define RENDER_WALK_H

#include <stdint.h>

#include "formats/sample.h"
#include "render/cell_kernel.h"
#include "render/ray.h"
#include "stream/loader.h"

/* Where a level's nodes and cells lie in grid space. Coarse levels reach past the volume's end. */
typedef struct level_planes {
    const double *at[3]; /* plane coordinates, node i of the level; enough for whole treelets */
    const double *inverse[3]; /* 1 / (at[i + 1] - at[i]) */
    uint32_t cells[3];
} level_planes;

typedef struct walk_counters {
    uint64_t nodes, cells, roots;
} walk_counters;

/* What does not change during a frame. */
typedef struct walk_scene {
    const level_planes *levels;
    const double *isovalues;
    int count;
    sample_type type;
    uint32_t halo;
    intersect_fn intersect;
} walk_scene;

/* walk_treelet() - lower *best to the first hit in this treelet that is strictly after `after`, if
 * there is a lesser one. [t_in, t_out] holds the ray's interval in the treelet; octants: which
 * eighths of it to look at (255: all). Returns whether *best changed. */
typedef bool (*walk_fn)(const walk_scene *scene, const treelet *tr, const ray *r, double t_in,
                        double t_out, unsigned octants, const hit *after, hit *best,
                        walk_counters *counters);

bool walk_treelet(const walk_scene *scene, const treelet *tr, const ray *r, double t_in,
                  double t_out, unsigned octants, const hit *after, hit *best,
                  walk_counters *counters);

/* The same result without the cells' masks, for experiment E1: down to 2^3 groups by masks (as if
 * the tree went on to 2^3), or to blocks, then cell by cell by the samples. */
bool walk_treelet_groups(const walk_scene *scene, const treelet *tr, const ray *r, double t_in,
                         double t_out, unsigned octants, const hit *after, hit *best,
                         walk_counters *counters);
bool walk_treelet_corners(const walk_scene *scene, const treelet *tr, const ray *r, double t_in,
                          double t_out, unsigned octants, const hit *after, hit *best,
                          walk_counters *counters);

/* walk_cell_box() - the planes of a cell of a level. */
cell_box walk_cell_box(const level_planes *planes, const uint32_t cell[3]);

/* walk_cell_samples() - its eight samples from its treelet. */
void walk_cell_samples(const walk_scene *scene, const treelet *tr, const uint32_t cell[3],
                       float samples[8]);

/* walk_sample() - the sample of a node (of the treelet's level) that its samples, halo included,
 * cover. */
float walk_sample(const walk_scene *scene, const treelet *tr, const int64_t node[3]);

static inline uint64_t walk_cell_index(const level_planes *planes, const uint32_t cell[3]) {
    return cell[0] + (uint64_t)planes->cells[0] * (cell[1] + (uint64_t)planes->cells[1] * cell[2]);
}

#endif
