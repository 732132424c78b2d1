/* leafcast_scene.h - the volumes of a scene, as rays see them. */
#ifndef RENDER_LEAFCAST_SCENE_H
#define RENDER_LEAFCAST_SCENE_H

#include "render/leafcast_volume.h"

_Static_assert((int)LEAFCAST_VOLUMES_MAX == (int)FRAME_VOLUMES_MAX,
               "as many in a frame as in a scene");

/* scene_volumes() - what a scene that is passed with volume v shows: *count of them, checked. What
 * surfaces points at stays the caller's, or v's. With the device's lock held. */
CHECKED status scene_volumes(leafcast *v, const leafcast_scene *scene,
                             leafcast_shown shown[LEAFCAST_VOLUMES_MAX], int *count);

/* scene_intersector() - the exact one, but for experiments. */
static inline leafcast_intersector scene_intersector(const leafcast_scene *scene) {
    return scene->experiments ? scene->experiments->intersector : LEAFCAST_MARMITT;
}

#endif
