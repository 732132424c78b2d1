/* scene_tiles.h - tiles of a scene: square parts of a landscape, laid side by side so that their
 * borders match (Wang tiles: M08 5.2.1), each as often as it takes, on the ground.
 *
 * Row by row, a cell of the ground gets one of the tiles whose western edge is named as the eastern
 * one of the cell before, and whose southern edge as the northern one of the cell below; which, a
 * hash of the cell says. A tile is sheared along z: to the plane that is nearest to the ground at
 * its four corners. What stands on it stays upright.
 */
#ifndef RENDER_APP_SCENE_TILES_H
#define RENDER_APP_SCENE_TILES_H

#include "render/app/scene_reading.h"

typedef struct scene_tiles scene_tiles;

enum { SCENE_TILES_MAX = 256 }; /* different ones */

/* scene_tiles_read() - read an object with "tiles", what: its place. *out is kept by *r, too.
 * ST_USAGE. scene_tiles_free() - all that lie in a list. */
CHECKED status scene_tiles_read(scene_reading *r, json_t *value, const char *what,
                                scene_tiles **out);
void scene_tiles_free(mem *m, scene_tiles *list);

/* scene_tiles_count() - how many tiles there are. scene_tiles_scene() - the scene on tile k, as the
 * file names it. scene_tiles_ground() - the path of the ground; NULL: it is flat, at z of the
 * origin. */
int scene_tiles_count(const scene_tiles *t);
const char *scene_tiles_scene(const scene_tiles *t, int k);
const char *scene_tiles_ground(const scene_tiles *t);

/* scene_tiles_place() - find where tiles lie, and which: (*which)[i] at place i. Both are the
 * caller's to free. ground: what is shown of it, or NULL. ST_USAGE: no tile fits a cell. */
CHECKED status scene_tiles_place(const scene_tiles *t, mem *m, const leafcast_shown *ground,
                                 render_places *places, uint16_t **which);

#endif
