/* preintegrated_integrator.h - media in equal steps, each looked up by the values at its two ends
 * (preintegrated_table.h).
 *
 * Steps begin where a ray enters the volume's box. At a gap between two pieces a step ends, and the
 * next one begins behind the gap. Such shorter steps let through their share of a whole step, and
 * their light is dimmed to match. The value is looked up once a step, and the four channels are
 * computed together.
 */
#ifndef RENDER_EXPERIMENTS_PREINTEGRATED_INTEGRATOR_H
#define RENDER_EXPERIMENTS_PREINTEGRATED_INTEGRATOR_H

#include "render/experiments/preintegrated_table.h"
#include "render/experiments/stepping_ray.h"

/* frame.look */
typedef struct preintegrated_look {
    stepping_look steps; /* must be first: stepping_ray.h uses it as frame.look */
    preintegrated_table table;
} preintegrated_look;

extern const integrator preintegrated_integrator;

#endif
