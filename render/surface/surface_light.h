/* surface_light.h - lights and shadows on surfaces that rays have met.
 *
 * A shadow ray starts at the surface, on the side that the ray came from, and ends at the light, or
 * as far as ambient light is looked for. Roots that are within the error of the surface's position
 * count as the surface itself (DESIGN 5.7). Each surface on the way dims the light.
 */
#ifndef RENDER_SURFACE_SURFACE_LIGHT_H
#define RENDER_SURFACE_SURFACE_LIGHT_H

#include "render/ray/ray_batch.h"
#include "render/surface/shade.h"
#include "render/surface/surface_integrator.h"

/* light_from() - set `to` to the unit direction from a point to a light, the same everywhere unless
 * the light is a point. Returns the light's distance. */
double light_from(const leafcast_light *light, const double at[3], double to[3]);

/* light_towards() - set `at` to the point at t on a pixel's ray, and `to` to the unit direction
 * from there to a light. Returns the light's distance. */
double light_towards(const frame *f, uint32_t pixel, double t, const leafcast_light *light,
                     double at[3], double to[3]);

typedef struct lit_surface {
    double at[3];
    double direction[3]; /* of the ray that has met it, unit length */
    uint16_t volume;
    uint32_t object; /* of that volume */
    const hit *found;
    const surface_point *point;
} lit_surface;

/* lit_shading() - the shade_point of a surface: see shade.h. */
shade_point lit_shading(const frame *f, const lit_surface *s);

/* lit_at() - set `at` to the point at t on a pixel's ray. */
void lit_at(const frame *f, uint32_t pixel, double t, double at[3]);

/* lit_faces() - whether a light in direction `to` is on the side of the surface that the ray came
 * from, where the shadow ray starts. If not, the surface itself hides the light. */
bool lit_faces(const lit_surface *s, const double to[3]);

/* lit_behind() - returns the t on a ray in direction `to` up to which roots count as the surface
 * itself, by its error. */
double lit_behind(const lit_surface *s, const double to[3]);

/* lit_ill_conditioned() - whether a shadow ray may be wrong near the surface, because the error of
 * its start is more than a cell. */
bool lit_ill_conditioned(const lit_surface *s, const double to[3]);

/* lit_search() - returns the initial search of a shadow ray in an object. */
trace_state lit_search(const frame *f, const lit_surface *s, uint32_t object, const double to[3]);

/* lit_dim() - dim *visibility by a surface of volume v that a shadow ray has met. Returns false
 * when no light is left. */
bool lit_dim(const frame *f, uint16_t v, const hit *met, float *visibility);

/* ---- Many surfaces of a frame's first volume ---- */

typedef struct lit_batch {
    unsigned count; /* at most RAY_BATCH surfaces */
    hit found[RAY_BATCH];
    surface_point point[RAY_BATCH]; /* normals are not used */
    double at[RAY_BATCH][3];
    /* For one light: */
    bool reaches[RAY_BATCH]; /* shade_reaches(): set by the caller; */
    float visibility[RAY_BATCH];
    bool needed[RAY_BATCH],
        ill_conditioned[RAY_BATCH]; /* of shadow rays; both false if none is needed */
    bool undone[RAY_BATCH];         /* unknown, because treelets are absent; */
    uint32_t absent[RAY_BATCH];     /* this one is, except in previews */
    uint8_t of[RAY_BATCH];          /* surface of each ray under way */
} lit_batch;

/* lit_batch_trace() - find how much of a light arrives at each surface, by batches of shadow rays.
 * *rays and scratch: room, see ray_batch.h. */
void lit_batch_trace(const frame *f, lit_batch *b, const leafcast_light *light, ray_batch *rays,
                     void *scratch, ray_counters *counters);

#endif
