/* surface_ray.h - a ray's way from surface to surface, as a small state machine: find the next
 * surface of any volume; for each light, and for ambient light, how much of it is seen; then what
 * the surface mirrors, and what is seen through it if it bends rays, whose surfaces are lit
 * likewise. The ray is computed anew from the pixel and the current hit whenever the state resumes.
 * It is part of the records of integrators that draw surfaces; what soft looks need more lies at
 * the records' end.
 */
#ifndef RENDER_SURFACE_SURFACE_RAY_H
#define RENDER_SURFACE_SURFACE_RAY_H

#include "render/surface/surface_integrator.h"
#include "render/surface/surface_search.h"

/* Legs of a ray's way: from the eye, then towards each light, about the surface for ambient light,
 * rays that begin on it, and the value that colours the surface. */
enum { SURFACE_PRIMARY = 0 };

typedef struct surface_ray {
    ray_record head;       /* volume: being searched now */
    int32_t layers;        /* surfaces composited so far */
    bool provisional;      /* something on the way was coarser than asked, or absent */
    bool shadow;           /* a ray towards the leg's light is under way, */
    uint8_t sample;        /* the one with this number */
    uint8_t depth;         /* rays from surfaces under way: the surface is the last one's */
    float visibility;      /* of that light, by that ray */
    float rgb[3];          /* shading of the current surface so far */
    surface_search search; /* for the current surface, and for what hides it from a light. While
                              the value that colours it is looked up, search.state.blocked is the
                              treelet that may hold it */
} surface_ray;

/* surface_ray_more() - bytes of frame.record_more that soft looks need, the last ones of a record.
 */
size_t surface_ray_more(const surface_look *look);

void surface_ray_begin(const frame *f, uint32_t pixel, surface_ray *p);

/* surface_ray_primary() - the ray from the eye, not cut. */
world_ray surface_ray_primary(const frame *f, uint32_t pixel);

/* surface_ray_find() - search for the next surface: set *q to the next question. Returns false once
 * the result, p->search.found, is certain; it is hit_none() if there is no surface. */
bool surface_ray_find(const frame *f, surface_ray *p, ray_question *q);

/* surface_ray_meet() - call it then: writes the planes of the ray's first surface, and begins the
 * lighting. Returns false if there is no surface. */
bool surface_ray_meet(const frame *f, surface_ray *p, ray_counters *counters);

/* surface_ray_light() - set *q to the next question of the lighting. Returns false when p->rgb is
 * the lit colour of the surface. */
bool surface_ray_light(const frame *f, surface_ray *p, ray_question *q, ray_counters *counters);

/* surface_ray_composite() - composite the current surface behind the colour that rgba holds, and
 * what is seen through it if it bends rays; then go on behind it. Returns false if nothing more
 * behind it counts, or the scene's limit of surfaces is reached. */
bool surface_ray_composite(const frame *f, surface_ray *p, float rgba[4]);

/* surface_ray_opacity() - returns the opacity of the current surface. */
float surface_ray_opacity(const frame *f, const surface_ray *p);

/* surface_ray_pass() - go on behind the current surface. Returns false if the scene's limit of
 * surfaces is reached. */
bool surface_ray_pass(const frame *f, surface_ray *p);

/* surface_ray_answer() - take the answer to a question of the above functions. */
void surface_ray_answer(const frame *f, surface_ray *p, trace_result result);

/* surface_ray_bundle() - the bundle of all rays on a leg: an integrator's `bundle`. */
ray_bundle surface_ray_bundle(const frame *f, uint32_t leg);

/* surface_ray_write() - write the pixel's colour: premultiplied, with the background. */
void surface_ray_write(const frame *f, const surface_ray *p, const float rgba[4],
                       ray_counters *counters);

#endif
