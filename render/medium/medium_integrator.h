/* medium_integrator.h - media, with surfaces in them. A ray sees the medium up to the next surface,
 * then the surface, then the medium behind it, and so on (medium_stretch.h, surface_ray.h). Pieces
 * of one filled volume
 * come in batches with those of other rays (medium_take.h). Several filled volumes are laid over
 * each other ray by ray (medium_lanes.h). Either may be shaded.
 *
 * A preview does not wait for absent treelets. It draws a guess there, with a bound of its error
 * (medium_doubt.h). Where surfaces are not certain, or several media are at one place, the bound
 * covers anything that could be seen.
 */
#ifndef RENDER_MEDIUM_MEDIUM_INTEGRATOR_H
#define RENDER_MEDIUM_MEDIUM_INTEGRATOR_H

#include "render/frame/integrator.h"
#include "render/medium/medium_look.h"
#include "stream/homogeneous.h"

extern const integrator medium_integrator;

/* medium_record_more() - frame.record_more for this look, in a preview or not. */
size_t medium_record_more(const medium_look *look, bool preview);

/* medium_homogeneous() - returns which ranges of values of volume v, the only filled one, are
 * homogeneous (medium_whole.h). longest: at least the world length of any ray in it; threshold: 0,
 * or as in leafcast_experimental.h. */
homogeneous medium_homogeneous(const medium_look *look, int v, double longest, bool integers,
                               double threshold);

#endif
