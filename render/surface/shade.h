/* shade.h - the colour of a hit, and how hits along a ray become a pixel.
 *
 * Pure functions of their arguments, in float, with + - * / sqrt alone: the same bits on every CPU.
 * A hit is coloured light by light, so that shadow rays may come and go in between:
 *
 *     shade_point p = shade_point_of(scene, surface.rgb, normal, towards_eye);
 *     float rgb[3];
 *     shade_ambient(&p, rgb);
 *     for each light l: (light_count == 0: one white light towards the eye, never shadowed)
 *         if (shade_reaches(&p, towards_light))             else: no shadow ray is needed
 *             shade_light(&p, towards_light, l.rgb, visibility, rgb);
 *     shade_composite(rgba, rgb, surface.opacity);          nearest hit first, rgba from zeros
 *     ...
 *     shade_background(rgba, scene->background);            once, behind the last hit
 *
 * Vectors have unit length and point away from the hit. Colours may exceed 1 where lights add up;
 * nothing is clamped here.
 */
#ifndef RENDER_SURFACE_SHADE_H
#define RENDER_SURFACE_SHADE_H

#include "render/leafcast.h"

typedef struct shade_point {
    float normal[3]; /* on the eye's side */
    float eye[3];    /* towards the eye */
    float rgb[3];
    float ambient, specular;
    int shininess;
    leafcast_shading shading;
} shade_point;

/* shade_point_of() - returns a hit, prepared for shading by lights.
 *
 * normal       of either side (it is turned to the eye: both sides of a surface look alike);
 *              any length, 0 counts as facing the eye
 * towards_eye  unit length
 */
shade_point shade_point_of(const leafcast_scene *scene, const float rgb[3], const float normal[3],
                           const float towards_eye[3]);

/* shade_ambient() - set *out to the part that does not depend on lights: k_a D, or D for flat
 * shading. */
void shade_ambient(const shade_point *p, float out[3]);

/* shade_reaches() - returns whether a light in this direction can contribute: it is on the eye's
 * side of the surface, and the scene's shading uses lights. */
bool shade_reaches(const shade_point *p, const float towards_light[3]);

/* shade_light() - add one light to out: (1 - k_a) (N . L) D of M08 eq. 4.6 and, for Phong, specular
 * (R . V)^shininess of the light's colour; both times visibility, the share of the light that
 * arrives, in [0, 1]. Adds nothing when !shade_reaches(). */
void shade_light(const shade_point *p, const float towards_light[3], const float light_rgb[3],
                 float visibility, float out[3]);

/* shade_composite() - composite a colour behind the colour that rgba holds (premultiplied). */
void shade_composite(float rgba[4], const float rgb[3], float opacity);

/* shade_behind() - composite what is premultiplied itself. */
void shade_behind(float rgba[4], const float behind[4]);

/* shade_background() - the same for the background, whose alpha is its opacity. */
void shade_background(float rgba[4], const float background[4]);

/* shade_normal() - the unit vector opposite to a gradient. Returns false, and leaves normal
 * untouched, where the gradient has no direction: it is 0, or its components' sum is not finite. */
bool shade_normal(const double gradient[3], float normal[3]);

#endif
