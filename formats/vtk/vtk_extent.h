/* vtk_extent.h - a box of nodes of VTK's structured data. */
#ifndef FORMATS_VTK_VTK_EXTENT_H
#define FORMATS_VTK_VTK_EXTENT_H

#include <stdbool.h>
#include <stdint.h>

/* From lo to hi, hi included: x, y, z. */
typedef struct vtk_extent {
    int64_t lo[3], hi[3];
} vtk_extent;

#define VTK_EXTENT_MAX ((int64_t)1 << 30)

/* vtk_extent_holds() - returns whether all nodes of `inner` are nodes of `outer`. */
bool vtk_extent_holds(const vtk_extent *outer, const vtk_extent *inner);

/* vtk_extent_is_empty() - returns whether it has no nodes. A writer without a share of the grid
 * leaves an empty extent. */
bool vtk_extent_is_empty(const vtk_extent *e);

/* vtk_extent_nodes() - how many it has along each axis; below 1 where it is empty. */
static inline void vtk_extent_nodes(const vtk_extent *e, int64_t nodes[3]) {
    for (int a = 0; a < 3; a++)
        nodes[a] = e->hi[a] - e->lo[a] + 1;
}

#endif
