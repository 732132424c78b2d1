/* quadratic_meet.h - where a ray meets isosurfaces in a quadratic tet, mostly without crossing its
 * faces.
 *
 * As in hex_meet.h, three forms are 0 there, which the inverse of their slopes in the middle makes
 * parameters and a bent rest. If the rest is too small to bring the point that the slopes say into
 * the tet, there is none. All others go by faces (quadratic_path.h) and path_roots.h, as all could.
 */
#ifndef RENDER_CURVED_QUADRATIC_MEET_H
#define RENDER_CURVED_QUADRATIC_MEET_H

#include "formats/curved/quadratic_path.h"
#include "render/curved/path_roots.h"

/* quadratic_meet_roots() - as path_roots(). sense: quadratic_sense(). */
int quadratic_meet_roots(const quadratic_tet *c, int sense, const sheared_ray *r, double isovalue,
                         path_root out[PATH_ROOTS], path_counts *counts);

#endif
