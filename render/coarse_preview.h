/* coarse_preview.h - a mesh's coarse grid, drawn where a preview's treelets are not there yet.
 *
 * The grid that is embedded in the mesh's file (leaf.h, COARSE) is a volume of its own, with a
 * loader of its own, on the mesh's device, inside an eighth of its budget. A primary ray that meets
 * an absent treelet of the mesh is traced through the grid instead, as far as the grid's levels are
 * there, and its pixel is provisional; all others are exact. So the picture becomes the exact one
 * as treelets come.
 */
#ifndef RENDER_COARSE_PREVIEW_H
#define RENDER_COARSE_PREVIEW_H

#include "render/leafcast_volume.h"

/* coarse_preview_begin() - before a picture of v: *tr for rays through the coarse grid of the set
 * and the surfaces that it shows, *out = tr; *out = NULL where the scene is no preview, the file
 * has no such grid, or the budget no room for it. Its coarsest level is there, the others are on
 * their way. */
CHECKED status coarse_preview_begin(leafcast *v, const leafcast_scene *scene,
                                    const leafcast_shown *shown, tracer *tr, const tracer **out);

/* coarse_preview_bytes() - of v's budget that are the grid's; 0 without one. coarse_preview_end() -
 * give them back. */
size_t coarse_preview_bytes(const leafcast *v);
void coarse_preview_end(leafcast *v);

/* coarse_preview_stats() - add what reading the grid took. */
void coarse_preview_stats(const leafcast *v, leafcast_stats *stats);

#endif
