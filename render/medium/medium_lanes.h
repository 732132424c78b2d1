/* medium_lanes.h - several filled volumes on one ray, laid over each other (overlay_ray.h,
 * medium_overlay.h), shaded or not. */
#ifndef RENDER_MEDIUM_MEDIUM_LANES_H
#define RENDER_MEDIUM_MEDIUM_LANES_H

#include "render/frame/integrator.h"
#include "render/medium/medium_ray.h"

/* medium_lanes_pass() - pass all filled volumes up to the surface. Returns true if a treelet is
 * missed: then it asks for that, and can be called again. medium_lanes_end() - end the walk. */
bool medium_lanes_pass(const frame *f, medium_ray *p, ray_question *q, ray_counters *counters);
void medium_lanes_end(medium_ray *p, int count);

#endif
