/* preintegrated_integrator.h - media in equal steps, each looked up by the values at its two ends
 * (preintegrated_table.h).
 *
 * Steps begin where a ray enters the volume's box. Where there is nothing between two pieces of it,
 * the step in front ends, and the next one begins behind that: such shorter steps let through what
 * their share of a whole one would, and are as much less bright. The value is looked up once a
 * step, the four channels are computed together.
 */
#ifndef RENDER_EXPERIMENTS_PREINTEGRATED_INTEGRATOR_H
#define RENDER_EXPERIMENTS_PREINTEGRATED_INTEGRATOR_H

#include "render/experiments/preintegrated_table.h"
#include "render/experiments/stepping_ray.h"

/* frame.look */
typedef struct preintegrated_look {
    stepping_look steps; /* first: it is those rays' look, too */
    preintegrated_table table;
} preintegrated_look;

extern const integrator preintegrated_integrator;

#endif
