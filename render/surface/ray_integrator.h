/* ray_integrator.h - rays of the caller's own: each one's first surface, or whether it has any. */
#ifndef RENDER_SURFACE_RAY_INTEGRATOR_H
#define RENDER_SURFACE_RAY_INTEGRATOR_H

#include "render/frame/integrator.h"

/* Pixel i of the frame is ray i; those beyond `count` are nothing. */
extern const integrator ray_integrator;

/* frame.look */
typedef struct ray_look {
    const leafcast_ray *rays;
    size_t count;
    leafcast_ray_hit *hits; /* or NULL: */
    uint8_t *occluded;
    const int32_t *first_id; /* a volume: of its surfaces */
} ray_look;

#endif
