/* coarse_preview.h - a mesh's coarse grid, drawn where a preview's treelets are not there yet, or
 * in place of the mesh.
 *
 * The grid that is embedded in the mesh's file (leaf.h, COARSE) is a volume of its own, with a
 * loader of its own, on the mesh's device, inside an eighth of its budget. A primary ray that meets
 * an absent treelet of the mesh is traced through the grid instead, as far as the grid's levels are
 * there, and its pixel is provisional; all others are exact. So the picture becomes the exact one
 * as treelets come.
 *
 * The grid's levels are the mesh's coarse levels of detail: level 0 is the tets, level n the grid's
 * level n - 1. A preview that asks for such a level shows the grid alone, and all of it is
 * provisional.
 */
#ifndef RENDER_DOOR_COARSE_PREVIEW_H
#define RENDER_DOOR_COARSE_PREVIEW_H

#include "render/door/leafcast_volume.h"

/* coarse_preview_levels() - of the coarse grid of v's first field and step, and so of all; 0: there
 * is none that can be opened. */
uint32_t coarse_preview_levels(const leafcast *v);

/* coarse_preview_begin() - before a picture of v: *tr for rays through the coarse grid of the set
 * and the surfaces that it shows, *out = tr; *out = NULL where the scene is no preview, the file
 * has no such grid, the budget no room for it, or another set's is being drawn. Its coarsest level
 * is there, the others are on their way. */
CHECKED status coarse_preview_begin(leafcast *v, const leafcast_scene *scene,
                                    const leafcast_shown *shown, tracer *tr, const tracer **out);

/* coarse_preview_instead() - the coarse grid that a scene asks for in place of v, open; NULL where
 * it asks for the tets, the file has no such grid, the budget no room for it, or another set's is
 * being drawn. It stays v's, and open while its `frames` is above 0 or until another set is shown.
 */
CHECKED status coarse_preview_instead(leafcast *v, const leafcast_scene *scene,
                                      const leafcast_shown *shown, leafcast **out);

/* coarse_preview_show() - before a picture of that: *tr for rays through it. Its coarsest level is
 * there, those down to the one that is asked for are on their way. */
CHECKED status coarse_preview_show(leafcast *coarse, const leafcast_scene *scene,
                                   const leafcast_shown *shown, const interest *beside,
                                   const camera *c, tracer *tr);

/* coarse_preview_bytes() - of v's budget that are the grid's; 0 without one. coarse_preview_end() -
 * give them back, unless a frame draws it. */
size_t coarse_preview_bytes(const leafcast *v);
void coarse_preview_end(leafcast *v);

/* coarse_preview_stats() - add what reading the grid took. */
void coarse_preview_stats(const leafcast *v, leafcast_stats *stats);

#endif
