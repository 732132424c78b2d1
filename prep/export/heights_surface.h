/* heights_surface.h - a part of a terrain as triangles, two a cell, treelet by treelet.
 *
 * A cell is cut from its first node to the one across, so that its edges are those of the patch
 * (formats/HEIGHTS.md); inside, the patch is off by at most a quarter of h00 - h10 - h01 + h11. A
 * cell that touches a node without data is a hole. Triangles are counterclockwise as seen from
 * above; vertices have no normals.
 */
#ifndef PREP_EXPORT_HEIGHTS_SURFACE_H
#define PREP_EXPORT_HEIGHTS_SURFACE_H

#include "prep/export/grid_part.h"
#include "prep/export/piece.h"

/* heights_surface_create() - release *out. The first of `count` sets are the elevations; values of
 * all of them are at the vertices. part and sets must outlive it. */
CHECKED status heights_surface_create(mem *m, leaf_file *f, const grid_part *part,
                                      const uint32_t *sets, uint32_t count, int threads,
                                      piece_source *out);

/* heights_surface_worker() - bytes that each thread needs besides its piece. */
uint64_t heights_surface_worker(const leaf_file *f, uint32_t count);

#endif
