/* glass_truth.h - balls and solids with flat faces, of glass, before a wall, traced in long double:
 * what is seen through a pixel, by Snell's and Fresnel's laws. Shares no code with the renderer.
 */
#ifndef TESTS_SUPPORT_GLASS_TRUTH_H
#define TESTS_SUPPORT_GLASS_TRUTH_H

#include "render/leafcast.h"

typedef long double glass_real;

glass_real glass_dot(const glass_real a[3], const glass_real b[3]);
void glass_unit(glass_real v[3]); /* make it of unit length */

/* glass_laws() - what becomes of a ray, by angles. normal: on the side that it comes from. Returns
 * the mirrored share; 1: nothing is refracted. */
glass_real glass_laws(const glass_real d[3], const glass_real normal[3], glass_real ratio,
                      glass_real mirrored[3], glass_real refracted[3]);

enum { GLASS_FACES = 5, GLASS_SHAPES = 3 };

/* A ball, or what is behind all faces: n . p <= d. */
typedef struct glass_shape {
    int faces; /* 0: a ball */
    glass_real face[GLASS_FACES][4], radius;
    glass_real end; /* there is nothing of it at x and y beyond; 0: there is */
    leafcast_surface look;
} glass_shape;

/* Shapes before a wall: an opaque triangle whose colours are its barycentric coordinates. */
typedef struct glass_truth {
    int count;
    glass_shape shapes[GLASS_SHAPES];
    glass_real wall[3][3];
    int bounces, layers_max;
    glass_real least; /* what a ray counts for at least */
    float background[4];
} glass_truth;

typedef struct glass_ray {
    glass_real o[3], d[3];
} glass_ray;

/* glass_truth_pixel() - the colour of a pixel, premultiplied. */
void glass_truth_pixel(const glass_truth *w, const glass_ray *r, glass_real rgba[4]);

#endif
