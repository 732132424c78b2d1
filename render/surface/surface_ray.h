/* surface_ray.h - a ray's way from surface to surface, as a small state machine: find the next
 * surface of any volume, then for each light whether it is seen. Rays are made anew from the pixel
 * and the current hit whenever the state is taken up. Integrators that draw surfaces have it in
 * their records.
 */
#ifndef RENDER_SURFACE_SURFACE_RAY_H
#define RENDER_SURFACE_SURFACE_RAY_H

#include "render/surface/surface_integrator.h"
#include "render/surface/surface_search.h"

/* Legs of a ray's way: from the eye, then towards each light. */
enum { SURFACE_PRIMARY = 0 };

typedef struct surface_ray {
    ray_record head;       /* volume: the one that is being searched */
    int32_t layers;        /* surfaces composited so far */
    bool provisional;      /* something on the way was drawn coarser than asked for */
    bool shadow;           /* a ray towards the leg's light is under way */
    float visibility;      /* of that light */
    float rgb[3];          /* shading of the current surface so far */
    surface_search search; /* for the current surface, and for what hides it from a light */
} surface_ray;

void surface_ray_begin(uint32_t pixel, surface_ray *p);

/* surface_ray_primary() - the ray from the eye, which is followed all the way. */
world_ray surface_ray_primary(const frame *f, uint32_t pixel);

/* surface_ray_find() - what is to be known before the next surface is certain. False: it is,
 * p->search.found; hit_none() if there is none. surface_ray_meet() - then: the planes of the first
 * surface are written, its lighting begins. False: there is none. */
bool surface_ray_find(const frame *f, surface_ray *p, ray_question *q);
bool surface_ray_meet(const frame *f, surface_ray *p, ray_counters *counters);

/* surface_ray_light() - what is to be known before p->rgb is what the lights make of the surface.
 * False: it is. */
bool surface_ray_light(const frame *f, surface_ray *p, ray_question *q, ray_counters *counters);

/* surface_ray_opacity() - of the current surface. surface_ray_pass() - go on behind it. False: as
 * many surfaces as count have been met. */
float surface_ray_opacity(const frame *f, const surface_ray *p);
bool surface_ray_pass(const frame *f, surface_ray *p);

/* surface_ray_answer() - to a question of the above. */
void surface_ray_answer(const frame *f, surface_ray *p, trace_result result);

/* surface_ray_bundle() - of all rays on a leg: an integrator's `bundle`. */
ray_bundle surface_ray_bundle(const frame *f, uint32_t leg);

/* surface_ray_write() - the pixel's colour, premultiplied, the background in it. */
void surface_ray_write(const frame *f, const surface_ray *p, const float rgba[4],
                       ray_counters *counters);

#endif
