/* mesh_gradients.h - gradients at the vertices of a mesh: the mean of the gradients of the tets
 * around a vertex, weighted by their volumes (M08 eq. 6.7).
 *
 * The whole mesh is used, so that treelets have the same gradients at shared vertices. Sums are
 * double and add a vertex's tets in the order given. The bits depend on that order alone, not on
 * memory or threads.
 *
 * A tet is left out if one of its values is not finite, or if it is too flat to have a gradient:
 * its volume is less than 2^-36 of the terms that are summed for it. The renderer uses the same
 * limit (render/mesh/tet_kernel.h). A vertex with no tet left around it has the gradient 0, which
 * stands for none. A gradient that no float can hold is scaled down: the direction counts.
 *
 * Vertices are processed in bands of as many as there is room for. The tets are passed once for
 * each band:
 *
 *     for (uint64_t band = 0; st == ST_OK && band < mesh_gradients_bands(g); band++) {
 *         mesh_gradients_begin(g, band, 0, 0);
 *         for all records, some at a time: mesh_gradients_add(g, records, count)
 *         mesh_gradients_end(g, gradients)
 *     }
 */
#ifndef PREP_MESH_MESH_GRADIENTS_H
#define PREP_MESH_MESH_GRADIENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/pool.h"
#include "prep/mesh/mesh_pages.h"
#include "prep/mesh/mesh_sort.h"

/* Sizes of what is held at a time. */
typedef struct mesh_gradients_plan {
    uint64_t band;                         /* vertices */
    uint64_t points_window, values_window; /* bytes of each thread's window on spilled points and
                                              values */
} mesh_gradients_plan;

/* mesh_gradients_plan_make() - the fastest plan for so many vertices that takes at most `room`
 * bytes, or else the smallest one. paged: points and values will be in files.
 * mesh_gradients_memory() - bytes that a plan takes. */
mesh_gradients_plan mesh_gradients_plan_make(const mesh_spool *points, const mesh_spool *values,
                                             uint64_t vertices, bool paged, int threads,
                                             uint64_t room);
uint64_t mesh_gradients_memory(const mesh_gradients_plan *plan, int threads);

typedef struct mesh_gradients mesh_gradients;

/* mesh_gradients_create() - points, values: float[3] and float of every vertex, perhaps of several
 * steps or sets one after the other; complete. All these must outlive it. */
CHECKED status mesh_gradients_create(mem *m, pool *workers, mesh_spool *points, mesh_spool *values,
                                     uint64_t vertices, const mesh_gradients_plan *plan,
                                     mesh_gradients **out);
void mesh_gradients_destroy(mesh_gradients *g); /* NULL is fine */

uint64_t mesh_gradients_bands(const mesh_gradients *g);

/* mesh_gradients_begin() - begin a band. Vertex 0 is element `point` of points and element `value`
 * of values. */
void mesh_gradients_begin(mesh_gradients *g, uint64_t band, uint64_t point, uint64_t value);

/* mesh_gradients_add() - add tets of four different vertices each. Fails only if reading points or
 * values does. */
CHECKED status mesh_gradients_add(mesh_gradients *g, const mesh_record *records, size_t count);

/* mesh_gradients_end() - append the band's gradients to `to`, float[3] each, in order of ids. */
CHECKED status mesh_gradients_end(mesh_gradients *g, mesh_spool *to);

#endif
