/* placement.h - where a volume's own world lies in the world of the scene (leafcast_shown.place).
 *
 * A ray of the scene is taken to the volume's own world once, and keeps its t. There it is as any
 * other ray, so kinds know nothing of places. What it finds is taken back: gradients and normals by
 * the inverse transpose, lengths by a bound, and the error of a hit's position grows by what the
 * two ways round.
 */
#ifndef RENDER_RAY_PLACEMENT_H
#define RENDER_RAY_PLACEMENT_H

#include <stdbool.h>

#include "formats/base/status.h"
#include "render/ray/affine.h"
#include "render/ray/surface_point.h"

typedef struct placement {
    bool moved;    /* false: both worlds are the same, and nothing else is set */
    affine space;  /* from the volume's own world to the scene's */
    double shrink; /* no length becomes shorter than this times itself, */
    double grow;   /* or longer than this times itself */
    double size;   /* the cube root of what volumes grow by */
} placement;

/* placement_check() - ST_USAGE unless a place is NULL, or invertible as leafcast_shown.place says.
 * Its numbers are finite. */
CHECKED status placement_check(const double *place);

/* placement_of() - place: 12 numbers that passed, or NULL. */
placement placement_of(const double *place);

/* placement_follow() - let place[] be followed by `next`: both are 12 numbers. */
void placement_follow(double place[12], const double next[12]);

/* placement_point(), placement_vector() - take a point, or a vector, of the scene's world to the
 * volume's own: into own[], which is returned; or `scene` where both are the same. */
const double *placement_point(const placement *p, const double scene[3], double own[3]);
const double *placement_vector(const placement *p, const double scene[3], double own[3]);

/* placement_to_scene() - take a point of the volume's own world to the scene's. */
void placement_to_scene(const placement *p, const double own[3], double scene[3]);

/* placement_widen() - widen a box of the scene's world to hold a point of the volume's own, by
 * rounding more. placement_box() - such a box around one of the volume's own. */
void placement_widen(const placement *p, const double own[3], double scene[2][3]);
void placement_box(const placement *p, const double own[2][3], double scene[2][3]);

/* placement_take_back() - take a point of a surface to the scene's world. reach: bounds of the
 * magnitudes of the hit, and of the ray's start, on each axis of the volume's own world. */
void placement_take_back(const placement *p, const double reach[3], surface_point *point);

#endif
