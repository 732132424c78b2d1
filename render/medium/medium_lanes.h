/* medium_lanes.h - several filled volumes on one ray, laid over each other (overlay_ray.h,
 * medium_overlay.h), shaded or not. */
#ifndef RENDER_MEDIUM_MEDIUM_LANES_H
#define RENDER_MEDIUM_MEDIUM_LANES_H

#include "render/frame/integrator.h"
#include "render/medium/medium_ray.h"

/* medium_lanes_pass() - walk through all filled volumes up to the surface. Returns true if a
 * treelet is absent: *q then asks for it. Call again when it is resident. */
bool medium_lanes_pass(const frame *f, medium_ray *p, ray_question *q, ray_counters *counters);

/* medium_lanes_end() - end the walk. */
void medium_lanes_end(medium_ray *p, int count);

#endif
