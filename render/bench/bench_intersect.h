/* bench_intersect.h - the six intersectors against the truth, and against the clock, on the same
 * ray-cells.
 *
 * A ray-cell is an active cell that a ray visits. The truth is computed here, in long double: the
 * cubic along the visit, parted by its extrema, each part bisected. It shares nothing with the
 * intersectors but where the visit begins and ends.
 */
#ifndef RENDER_BENCH_BENCH_INTERSECT_H
#define RENDER_BENCH_BENCH_INTERSECT_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/bench/bench_table.h"
#include "render/grid/cell_kernel.h"
#include "render/leafcast.h"

typedef struct bench_ray_cell {
    ray r;
    cell_visit visit;
    float samples[8];
    double iso;
    cell_box box; /* of a grid of unit cells, */
    bool unit;    /* where it is one, and the level the finest */
} bench_ray_cell;

typedef struct bench_ray_cells {
    bench_ray_cell *cells;
    uint32_t count, max;
} bench_ray_cells;

/* bench_ray_cells_record() - those that drawing this picture comes by, in that order, up to max of
 * them. The volume was opened with one thread, surfaces are selected. mem_free() cells. */
CHECKED status bench_ray_cells_record(mem *m, leafcast *volume, const leafcast_scene *scene,
                                      const leafcast_camera *camera, uint32_t max,
                                      bench_ray_cells *out);

/* bench_ray_cells_make() - max of them from a built-in field, "marschner-lobb" (41^3, M08's test
 * signal) or "noise" (every sample at random), hit from the standard view's eye. ST_USAGE for
 * another name. */
CHECKED status bench_ray_cells_make(mem *m, const char *field, uint32_t max, bench_ray_cells *out);

/* bench_intersect() - add one row an intersector: what it missed, what it made up, how far off it
 * was, how long it took alone, after the visit. For the exact one also sixteen at a time with the
 * visit (cell_batch.h) for every ISA there is, with the number of lanes whose bits differ from the
 * scalar ones. */
CHECKED status bench_intersect(mem *m, const char *name, const bench_ray_cells *c, int runs,
                               bench_table *t);

extern const char bench_intersect_headings[];

#endif
