/* leafcast_scene.h - the volumes of a scene, as rays see them. */
#ifndef RENDER_DOOR_LEAFCAST_SCENE_H
#define RENDER_DOOR_LEAFCAST_SCENE_H

#include "render/door/leafcast_volume.h"
#include "render/frame/frame.h"
#include "render/look/scene_facts.h"

_Static_assert((int)LEAFCAST_VOLUMES_MAX == (int)FRAME_VOLUMES_MAX,
               "as many in a frame as in a scene");

/* scene_volumes() - list the *count volumes that a scene passed with volume v shows, and check that
 * they can be shown together. The scene has passed arguments_check_scene(). `surfaces` still points
 * into the caller's memory, or into v. Needs the device's lock. */
CHECKED status scene_volumes(leafcast *v, const leafcast_scene *scene,
                             leafcast_shown shown[LEAFCAST_VOLUMES_MAX], int *count);

/* How many intervals an interest holds at most, in addition to the isovalues. */
enum { SCENE_BESIDE_MAX = (int)INTEREST_MAX - (int)LEAFCAST_SURFACES_MAX };

/* scene_level() - returns the level of detail of v that the scene shows, at most the coarsest
 * of which v has samples.
 * Nothing else reads leafcast_scene.lod_level to find treelets or cells. */
static inline uint32_t scene_level(const leafcast_scene *scene, const leafcast *v) {
    const uint32_t asked = scene->lod == LEAFCAST_LOD_LEVEL ? scene->lod_level : 0,
                   last = v->file->layout.sampled - 1;
    return asked < last ? asked : last;
}

#endif
