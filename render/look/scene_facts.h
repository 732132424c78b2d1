/* scene_facts.h - facts that follow from a scene alone. */
#ifndef RENDER_LOOK_SCENE_FACTS_H
#define RENDER_LOOK_SCENE_FACTS_H

#include "render/leafcast.h"
#include "render/leafcast_experimental.h"

/* scene_is_filled() - whether the scene shows more than surfaces: media or a projection. */
static inline bool scene_is_filled(const leafcast_scene *scene) {
    return scene->media_count > 0 || scene->project != LEAFCAST_PROJECT_NONE;
}

/* scene_is_certified() - whether the scene shows media with a bound of the error. */
static inline bool scene_is_certified(const leafcast_scene *scene) {
    return scene->media_count > 0 && scene->project == LEAFCAST_PROJECT_NONE &&
           !scene->shade_media &&
           (!scene->experiments || scene->experiments->summing == LEAFCAST_CERTIFIED);
}

/* scene_filled() - how many volumes are filled with a medium. */
static inline int scene_filled(const leafcast_scene *scene) {
    int filled = 0;
    for (int i = 0; i < scene->media_count; i++)
        filled += scene->media[i].count > 0;
    return filled;
}

/* scene_intersector() - the exact one, unless experiments choose another. */
static inline leafcast_intersector scene_intersector(const leafcast_scene *scene) {
    return scene->experiments ? scene->experiments->intersector : LEAFCAST_MARMITT;
}

#endif
