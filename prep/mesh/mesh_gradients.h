/* mesh_gradients.h - the gradient at each vertex of a mesh: the mean of the gradients of the tets
 * around it, by their volumes (M08 eq. 6.7).
 *
 * Over the whole mesh, so that treelets have the same at the vertices they share. Sums are double
 * and take a vertex's tets in the order in which these come: the bits depend on that order alone,
 * neither on memory nor on threads.
 *
 * A tet has no say if one of its values is not finite, or if it is too flat to have a gradient: its
 * volume less than 2^-36 of the terms that it is the sum of, where the renderer takes none either
 * (render/mesh/tet_kernel.h). A vertex without such tets around it has the gradient 0, which stands
 * for none. A gradient that no float can hold is scaled down: it is the direction that counts.
 *
 * Vertices go in bands of as many as there is room for, and the tets pass by once for each band:
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

/* What is held at a time. */
typedef struct mesh_gradients_plan {
    uint64_t band;                         /* vertices */
    uint64_t points_window, values_window; /* bytes of each thread's window on spilled ones */
} mesh_gradients_plan;

/* mesh_gradients_plan_make() - for so many vertices the fastest plan that takes up to `room` bytes,
 * or else the one that takes least. paged: points and values will be in files.
 * mesh_gradients_memory() - bytes that one takes. */
mesh_gradients_plan mesh_gradients_plan_make(const mesh_spool *points, const mesh_spool *values,
                                             uint64_t vertices, bool paged, int threads,
                                             uint64_t room);
uint64_t mesh_gradients_memory(const mesh_gradients_plan *plan, int threads);

typedef struct mesh_gradients mesh_gradients;

/* mesh_gradients_create() - points, values: float[3] and float of every vertex, perhaps of several
 * steps or sets one behind the other; ended. All these must outlive it. */
CHECKED status mesh_gradients_create(mem *m, pool *workers, mesh_spool *points, mesh_spool *values,
                                     uint64_t vertices, const mesh_gradients_plan *plan,
                                     mesh_gradients **out);
void mesh_gradients_destroy(mesh_gradients *g); /* NULL is fine */

uint64_t mesh_gradients_bands(const mesh_gradients *g);

/* mesh_gradients_begin() - vertex 0 is points' element `point` and values' element `value`. */
void mesh_gradients_begin(mesh_gradients *g, uint64_t band, uint64_t point, uint64_t value);

/* mesh_gradients_add() - tets of four different vertices each. Fails only where reading points or
 * values does. */
CHECKED status mesh_gradients_add(mesh_gradients *g, const mesh_record *records, size_t count);

/* mesh_gradients_end() - append the band's gradients, float[3] each, in order of ids. */
CHECKED status mesh_gradients_end(mesh_gradients *g, mesh_spool *to);

#endif
