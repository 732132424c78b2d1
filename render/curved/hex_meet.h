/* hex_meet.h - where a ray meets isosurfaces in a hexahedron, mostly without crossing its faces.
 *
 * On the ray at the isovalue, three trilinear forms are 0: two coordinates of the ray's space, and
 * the value less the isovalue. The inverse of their slopes in the middle makes of them the
 * parameters themselves and a bent rest. What the rest can be in the cell bounds where roots are:
 * mostly nowhere in it, or in a smaller box, and so on. Where the rest bends little the forms take
 * no triple twice: then Newton's method finds the one root there is, and it is in the cell or not.
 * What is too close to a face to tell, bends too much, or is folded goes by hex_path.h and
 * hex_roots.h, as all could.
 */
#ifndef RENDER_CURVED_HEX_MEET_H
#define RENDER_CURVED_HEX_MEET_H

#include "render/curved/hex_roots.h"

/* hex_meet_roots() - as hex_roots(). sense: hexahedron_sense(). counts: of what went there; may be
 * NULL. */
int hex_meet_roots(const hexahedron *cell, int sense, const sheared_ray *r, double isovalue,
                   path_root out[PATH_ROOTS], path_counts *counts);

/* hex_meet_crossed() - the same, by the faces alone. */
int hex_meet_crossed(const hexahedron *cell, int sense, const sheared_ray *r, double isovalue,
                     path_root out[PATH_ROOTS], path_counts *counts);

#endif
