/* leafcast_scene.h - the volumes of a scene, as rays see them. */
#ifndef RENDER_DOOR_LEAFCAST_SCENE_H
#define RENDER_DOOR_LEAFCAST_SCENE_H

#include "render/door/leafcast_volume.h"
#include "render/frame/frame.h"
#include "render/look/scene_facts.h"

_Static_assert((int)LEAFCAST_VOLUMES_MAX == (int)FRAME_VOLUMES_MAX,
               "as many in a frame as in a scene");

/* scene_volumes() - what a scene that is passed with volume v shows: *count of them, checked. What
 * surfaces points at stays the caller's, or v's. With the device's lock held. */
CHECKED status scene_volumes(leafcast *v, const leafcast_scene *scene,
                             leafcast_shown shown[LEAFCAST_VOLUMES_MAX], int *count);

/* Intervals of values that matter beside isovalues, at most. */
enum { SCENE_BESIDE_MAX = (int)INTEREST_MAX - (int)LEAFCAST_SURFACES_MAX };

/* scene_level() - the level of detail of v that the scene shows: where it asks for more, the last.
 * Nothing else reads leafcast_scene.lod_level to find treelets or cells. */
static inline uint32_t scene_level(const leafcast_scene *scene, const leafcast *v) {
    const uint32_t asked = scene->lod == LEAFCAST_LOD_LEVEL ? scene->lod_level : 0,
                   last = v->file->layout.levels - 1;
    return asked < last ? asked : last;
}

#endif
