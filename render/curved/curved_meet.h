/* curved_meet.h - where a ray meets isosurfaces in a curved cell, mostly without crossing its
 * faces.
 *
 * On the ray at the isovalue, three forms are 0: two coordinates of the ray's space, and the value
 * less the isovalue. They are trilinear, or quadratic. The inverse of their slopes in the middle
 * makes of them the parameters themselves and a bent rest. What the rest can be in the cell bounds
 * where roots are: mostly nowhere in it, or in a smaller box, and so on. Where the rest bends
 * little the forms take no triple twice: then Newton's method finds the one root there is, and it
 * is in the cell or not. What is too close to a face to tell, bends too much, or is folded goes by
 * the faces and path_roots.h, as all could.
 */
#ifndef RENDER_CURVED_CURVED_MEET_H
#define RENDER_CURVED_CURVED_MEET_H

#include "formats/curved/curved_cell.h"
#include "formats/curved/sheared_ray.h"
#include "render/curved/path_roots.h"

/* curved_meet_roots() - as path_roots(). counts: of what went there; may be NULL. */
int curved_meet_roots(const curved_cell *cell, const sheared_ray *r, double isovalue,
                      path_root out[PATH_ROOTS], path_counts *counts);

/* curved_meet_crossed() - the same, by the faces alone. */
int curved_meet_crossed(const curved_cell *cell, const sheared_ray *r, double isovalue,
                        path_root out[PATH_ROOTS], path_counts *counts);

#endif
