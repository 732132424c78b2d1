/* scene_look.h - chooses the integrator for a scene, and makes the description that it gets.
 *
 * This is the only place that decides how a scene is drawn:
 *
 *   a projection       projection_integrator
 *   media              medium_integrator, with or without surfaces and shading
 *   media in steps     an experiment of the laboratory
 *   else, surfaces     surface_integrator
 */
#ifndef RENDER_DOOR_SCENE_LOOK_H
#define RENDER_DOOR_SCENE_LOOK_H

#include "render/door/leafcast_turn.h"
#include "render/frame/laboratory.h"
#include "render/medium/medium_integrator.h"
#include "render/projection/projection_integrator.h"

typedef struct scene_look {
    turn *turn;
    medium_look look; /* media and surfaces */
    projection_look projected;
    const laboratory *laboratory; /* media in steps: who draws them, and */
    void *stepped;                /* their look; else NULL */
    transfer *media;              /* one an object, as are: */
    transfer *colours;            /* of surfaces; without spans: by their own */
    surface_lookup *lookups;      /* whose values these are of, if not the surfaces' */
    double (*ranges)[2], *steepness;
    medium_shade shade;   /* for scene.shade_media */
    transfer cap_colours; /* without spans: caps have surfaces' colours */
} scene_look;

/* scene_look_choose() - set the integrator and the look of a described turn. Also sets which values
 * its volumes load in addition to isosurfaces. The caller has zeroed *l, and does not move it.
 * ST_USAGE: media in steps need one volume without isosurfaces. */
CHECKED status scene_look_choose(scene_look *l, turn *t);

/* scene_look_release() - free what scene_look_choose() took, also after an error. */
void scene_look_release(scene_look *l, mem *m);

#endif
