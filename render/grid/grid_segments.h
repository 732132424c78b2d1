/* grid_segments.h - one ray's pieces through the cells of a grid, in order of t (segments.h).
 *
 * What cell_visit_of() says of a cell is its piece, as far as it has a length; the value there is
 * the cubic of cell_values(). Crossings of planes are the same (plane - o) / d for both cells, for
 * their nodes and their treelets, so that pieces adjoin to the bit and everything else is skipped
 * by exact comparison.
 *
 * Errors, with u = 2^-53, about the ray in grid space: t of a plane is right to 2u of itself. A
 * value errs by at most
 *
 *     range * sum over the axes of 8u (|t d| + |plane - o|) / width  +  16u * (largest |sample|)
 *
 * where range is that of the cell's samples: the coordinate in the cell collects 2u of t, and one
 * rounding for each of t d, plane - o, their difference, 1 / width and the product; the trilinear
 * form has three steps of three roundings.
 */
#ifndef RENDER_GRID_GRID_SEGMENTS_H
#define RENDER_GRID_GRID_SEGMENTS_H

#include "render/ray/segments.h"

/* grid_segments() - the row's `segments`. tr->own: a walk_scene. */
segments_result grid_segments(const tracer *tr, const ray *r, segments_state *state,
                              ray_counters *counters);

/* grid_segments_error() - the row's `segments_error`: the above, of the narrowest cell. */
segments_error grid_segments_error(const tracer *tr, const ray *r, const double range[2]);

#endif
