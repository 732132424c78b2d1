/* experiment_filter.h - E2: a float filter in front of the cell kernel. */
#ifndef RENDER_BENCH_EXPERIMENT_FILTER_H
#define RENDER_BENCH_EXPERIMENT_FILTER_H

#include "render/leafcast.h"

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
