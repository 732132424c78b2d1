/* coarse_preview.h - the coarse grid of a volume whose kind has no levels of detail, drawn where a
 * preview's treelets are not resident yet, or in place of the volume.
 *
 * The grid is embedded in the volume's file (leaf.h, COARSE). It is a volume with its own loader,
 * on the same device, inside an eighth of the device's budget. A primary ray that meets an absent
 * treelet is traced through the grid instead, as far as the grid's levels are resident. Its pixel
 * is provisional; all others are exact. So the picture becomes exact as treelets come.
 *
 * Between two steps it is what lies between the grids of both (coarse_pair.h); where points move,
 * or the grids are no samples, the nearest step's.
 *
 * The grid's levels are the volume's coarse levels of detail: level 0 is its cells, level n the
 * grid's level n - 1. Of a curvilinear grid level 1 may be one with fewer nodes, and the further
 * levels those of a regular grid inside that one's file. A preview that asks for level 1 or more
 * shows the grid alone, and all of it is provisional.
 */
#ifndef RENDER_DOOR_COARSE_PREVIEW_H
#define RENDER_DOOR_COARSE_PREVIEW_H

#include "render/door/leafcast_volume.h"

/* coarse_preview_levels() - returns the levels of the first set's coarse grid, with those of the
 * one inside it, and notes in v its kind and cell_levels. Others may lack the one inside: their
 * last level stands for what is missing. 0: there is no grid that can be opened. */
uint32_t coarse_preview_levels(leafcast *v);

/* coarse_preview_begin() - call before a picture of v. Sets *tr up for rays through the coarse grid
 * of the set and surfaces shown, and *out = tr. *out = NULL where the scene is no preview, the file
 * has no such grid, the budget has no room for it, or another set's grid is being drawn. The grid's
 * coarsest level is then resident; the others are queued. */
CHECKED status coarse_preview_begin(leafcast *v, const leafcast_scene *scene,
                                    const leafcast_shown *shown, tracer *tr, const tracer **out);

/* coarse_preview_instead() - open the coarse grid that a scene asks for in place of v. *out = NULL
 * where the scene asks for the cells, the file has no such grid, the budget has no room for it, or
 * another set's grid is being drawn. v owns the grid. It stays open while its `frames` is above 0,
 * else until another set is shown. */
CHECKED status coarse_preview_instead(leafcast *v, const leafcast_scene *scene,
                                      const leafcast_shown *shown, leafcast **out);

/* coarse_preview_shown() - what is shown of such a grid where that is shown of v. */
leafcast_shown coarse_preview_shown(leafcast *coarse, const leafcast_shown *shown);

/* coarse_preview_show() - call before a picture of such a grid. Sets *tr up for rays through it.
 * Its coarsest level is then resident; the levels down to the one asked for are queued. */
CHECKED status coarse_preview_show(leafcast *coarse, const leafcast_scene *scene,
                                   const leafcast_shown *shown, const interest *beside,
                                   const camera *c, tracer *tr);

/* coarse_preview_bytes() - returns the grid's share of v's budget; 0 without a grid.
 * coarse_preview_held() - the same, but 0, too, of a grid that coarse_preview_end() would close.
 * coarse_preview_end() - close the grid and give its share back, unless a frame draws the grid. */
size_t coarse_preview_bytes(const leafcast *v);
size_t coarse_preview_held(const leafcast *v);
void coarse_preview_end(leafcast *v);

/* coarse_preview_stats() - add the bytes read and resident for the grid. */
void coarse_preview_stats(const leafcast *v, leafcast_stats *stats);

#endif
