/* leafcast_scene.h - the volumes of a scene, as rays see them. */
#ifndef RENDER_DOOR_LEAFCAST_SCENE_H
#define RENDER_DOOR_LEAFCAST_SCENE_H

#include "render/door/leafcast_volume.h"
#include "render/frame/frame.h"
#include "render/look/scene_facts.h"

_Static_assert(LEAFCAST_VOLUMES_MAX < UINT16_MAX, "ray_record.volume");

/* scene_objects() - returns how many objects a scene shows. scene_object() - returns the i-th one
 * of a scene that is passed with volume v. `surfaces` and `place` still point into the caller's
 * memory, or into v. */
static inline int scene_objects(const leafcast_scene *scene) {
    return scene->volume_count > 0 ? scene->volume_count : 1;
}
leafcast_shown scene_object(const leafcast *v, const leafcast_scene *scene, int i);

/* scene_is_coloured() - whether another volume colours surfaces of an object. scene_lookups() - of
 * how many objects of a picture. scene_lookup() - that volume, as an object without surfaces. */
static inline bool scene_is_coloured(const leafcast_shown *s) {
    return s->colour_by && s->count > 0;
}
int scene_lookups(const leafcast_scene *scene);
leafcast_shown scene_lookup(const leafcast_shown *s);

/* scene_check() - whether the objects of a scene that is passed with volume v can be shown
 * together. Sets `listed` of their volumes: the first object that shows it. The scene has passed
 * arguments_check_scene(). Needs the device's lock. */
CHECKED status scene_check(leafcast *v, const leafcast_scene *scene);

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
