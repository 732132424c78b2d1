/* experiment.h - hooks into an open volume for benchmarks and experiments; not installed, not part
 * of the public interface. */
#ifndef RENDER_EXPERIMENT_H
#define RENDER_EXPERIMENT_H

#include "render/grid/cell_kernel.h"
#include "render/leafcast.h"

/* experiment_intersect() - draw with this cell intersector instead of the scene's; NULL: with the
 * scene's again. */
void experiment_intersect(leafcast *volume, intersect_fn intersect);

/* E2: the cell kernel in double throughout, against a float filter with a proven bound in front of
 * it. */
typedef struct experiment_filter_result {
    uint64_t ray_cells;            /* recorded while drawing, in that order */
    uint64_t surfaces;             /* of them with a hit */
    uint64_t fallbacks;            /* of them not decided by the filter */
    uint64_t disagreements;        /* decided otherwise than by the kernel; must be 0 */
    double ns_double, ns_filtered; /* per 16 ray-cells, medians of interleaved runs */
} experiment_filter_result;

/* experiment_filter() - record up to max ray-cells of a picture (drawn by one thread) and time both
 * ways. */
leafcast_status experiment_filter(leafcast *volume, const leafcast_scene *scene,
                                  const leafcast_camera *camera, uint32_t max,
                                  experiment_filter_result *result);

#endif
