/* refraction.h - where light goes at a surface, and how much of it: mirrored, or refracted.
 *
 * Snell's law and Fresnel's for light that is not polarised, in double, with + - * / sqrt alone:
 * the same bits on every CPU.
 */
#ifndef RENDER_SURFACE_REFRACTION_H
#define RENDER_SURFACE_REFRACTION_H

#include <stdbool.h>

#include "render/leafcast.h"

/* Unit directions, and the mirrored one's share. 1: total reflection, nothing is refracted. */
typedef struct refraction {
    double mirrored[3], refracted[3];
    double share;
} refraction;

/* refraction_bends() - whether rays through a surface are bent. */
static inline bool refraction_bends(const leafcast_surface *s) {
    return s->refraction > 0.0f && s->refraction != 1.0f && s->opacity < 1.0f;
}

/* refraction_mirror() - set `to` to the unit direction of the ray that a surface mirrors. normal:
 * of either side, any length above 0. */
void refraction_mirror(const double direction[3], const float normal[3], double to[3]);

/* refraction_of() - what becomes of a ray. direction: unit length. ratio: the index on the side
 * that it comes from, divided by that on the other. */
refraction refraction_of(const double direction[3], const float normal[3], double ratio);

#endif
