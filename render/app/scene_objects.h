/* scene_objects.h - the objects of a scene file, those of scenes in it, and where they are. */
#ifndef RENDER_APP_SCENE_OBJECTS_H
#define RENDER_APP_SCENE_OBJECTS_H

#include "render/app/scene_reading.h"

/* scene_objects_read() - read "objects". Scenes at one place are taken apart. What is at many is a
 * group: a scene, or in a scene at many places, or at more than LEAFCAST_VOLUMES_MAX of them, an
 * object. Sets objects, groups and paths of *r. */
CHECKED status scene_objects_read(scene_reading *r, json_t *top);

#endif
