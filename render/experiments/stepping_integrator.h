/* stepping_integrator.h - media in equal steps, from the front to the back (stepping_batch.h). */
#ifndef RENDER_EXPERIMENTS_STEPPING_INTEGRATOR_H
#define RENDER_EXPERIMENTS_STEPPING_INTEGRATOR_H

#include "render/experiments/stepping_ray.h"

/* frame.look: a stepping_look */
extern const integrator stepping_integrator;

#endif
