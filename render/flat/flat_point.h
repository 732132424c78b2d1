/* flat_point.h - what is known of a point where a ray has met a flat piece of a surface. */
#ifndef RENDER_FLAT_FLAT_POINT_H
#define RENDER_FLAT_FLAT_POINT_H

#include "render/ray/ray.h"
#include "render/ray/surface_point.h"

/* A direction across a surface, a unit vector or the gradient, and its error bounds. */
typedef struct flat_across {
    double direction[3], error[3];
} flat_across;

/* flat_normal() - the unit normal of a polygon, from its diagonals, or of a triangle, whose last
 * point comes twice, from two edges. Returns false if it is 0. */
bool flat_normal(const double p[4][3], flat_across *out);

/* flat_normal_against() - the unit vector against a gradient; 0 if that has no direction. */
void flat_normal_against(const double gradient[3], float normal[3]);

/* What all rays that hit a polygon have in common. */
typedef struct flat_facts {
    double at[3];        /* a point of the polygon */
    double slack;        /* error bound of its value; INFINITY: there is no polygon */
    double error[3];     /* of the gradient */
    surface_point point; /* without its error */
} flat_facts;

/* flat_point_at() - the point of a hit, with its error. */
surface_point flat_point_at(const flat_facts *f, const ray *r, const hit *h);

#endif
