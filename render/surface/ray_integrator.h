/* ray_integrator.h - rays that the caller gives: the first surface of each, or whether it has
 * any. */
#ifndef RENDER_SURFACE_RAY_INTEGRATOR_H
#define RENDER_SURFACE_RAY_INTEGRATOR_H

#include "render/frame/integrator.h"

/* Pixel i of the frame is ray i; pixels from `count` on do nothing. */
extern const integrator ray_integrator;

/* frame.look */
typedef struct ray_look {
    const leafcast_ray *rays;
    size_t count;
    leafcast_ray_hit *hits; /* or NULL, and then: */
    uint8_t *occluded;
    const int32_t *first_id; /* of each volume's surfaces */
} ray_look;

#endif
