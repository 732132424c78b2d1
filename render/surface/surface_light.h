/* surface_light.h - surfaces that pixels' rays have met, as lights see them, and what lies between.
 *
 * A shadow ray starts at the surface, on the side that the pixel's ray came from, and ends at the
 * light. Roots within the error of the surface's own are the surface itself (DESIGN 5.7). What
 * arrives is what the surfaces on the way let through, one after the other.
 */
#ifndef RENDER_SURFACE_SURFACE_LIGHT_H
#define RENDER_SURFACE_SURFACE_LIGHT_H

#include "render/ray/ray_batch.h"
#include "render/surface/shade.h"
#include "render/surface/surface_integrator.h"

/* light_from() - the unit direction from a point to a light, which is the same from everywhere
 * unless the light is a point itself; returns its distance. */
double light_from(const leafcast_light *light, const double at[3], double to[3]);

/* light_towards() - the point at t on a pixel's ray, and the unit direction from there to a light;
 * returns its distance. */
double light_towards(const frame *f, uint32_t pixel, double t, const leafcast_light *light,
                     double at[3], double to[3]);

typedef struct lit_surface {
    uint32_t pixel;
    uint16_t volume;
    const hit *found;
    const surface_point *point;
} lit_surface;

/* lit_shading() - see shade.h. */
shade_point lit_shading(const frame *f, const lit_surface *s);

/* lit_at() - where a pixel's ray is at t. */
void lit_at(const frame *f, uint32_t pixel, double t, double at[3]);

/* lit_faces() - whether a light in direction `to` is on the side of the surface that the pixel's
 * ray came from: the shadow ray starts there, and a light on the other one is behind the surface
 * itself.
 */
bool lit_faces(const lit_surface *s, const double to[3]);

/* lit_needs_ray() - whether it takes a shadow ray to say what arrives of a light in direction `to`.
 * *visibility is 1 then, else what there is to say. */
bool lit_needs_ray(const frame *f, const lit_surface *s, const double to[3], float *visibility);

/* lit_ill_conditioned() - whether a shadow ray may be wrong about what is near the surface: the
 * error of its start is more than a cell. */
bool lit_ill_conditioned(const lit_surface *s, const double to[3]);

/* lit_search() - how a shadow ray begins in volume v. */
trace_state lit_search(const frame *f, const lit_surface *s, uint16_t v, const double to[3]);

/* lit_dim() - a shadow ray has met a surface of volume v. False: no light is left. */
bool lit_dim(const frame *f, uint16_t v, const hit *met, float *visibility);

/* ---- Many surfaces of a frame's first volume ---- */

typedef struct lit_batch {
    unsigned count; /* at most RAY_BATCH surfaces */
    hit found[RAY_BATCH];
    surface_point point[RAY_BATCH]; /* normals do not matter */
    double at[RAY_BATCH][3];
    /* Of a light: */
    bool reaches[RAY_BATCH]; /* shade_reaches(): set by the caller; */
    float visibility[RAY_BATCH];
    bool needed[RAY_BATCH], ill_conditioned[RAY_BATCH]; /* of shadow rays: none, without a need */
    bool undone[RAY_BATCH];                             /* not known, for want of treelets; */
    uint32_t absent[RAY_BATCH];                         /* this one, unless it is a preview */
    uint8_t of[RAY_BATCH]; /* surfaces of the rays that are on their way */
} lit_batch;

/* lit_batch_trace() - what arrives of a light, by batches of shadow rays. *rays and scratch: room,
 * see ray_batch.h. */
void lit_batch_trace(const frame *f, lit_batch *b, const leafcast_light *light, ray_batch *rays,
                     void *scratch, ray_counters *counters);

#endif
