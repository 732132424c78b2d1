/* grid_segments.h - one ray's pieces through the cells of a grid, in order of t (segments.h).
 *
 * A cell's piece is its visit by cell_visit_of(), if that has a length; the value there is the
 * cubic of cell_values(). Neighbouring cells, their nodes and their treelets compute the crossing
 * of a plane alike, as (plane - o) / d. So pieces adjoin to the bit, and exact comparison skips
 * everything else.
 *
 * Errors, with u = 2^-53, about the ray in grid space: t of a plane errs by at most 2u of itself. A
 * value errs by at most
 *
 *     range * sum over the axes of 8u (|t d| + |plane - o|) / width  +  16u * (largest |sample|)
 *
 * where range is the range of the cell's samples. The coordinate in the cell collects 2u of t, and
 * one rounding for each of t d, plane - o, their difference, 1 / width and the product. The
 * trilinear form has three steps of three roundings.
 */
#ifndef RENDER_GRID_GRID_SEGMENTS_H
#define RENDER_GRID_GRID_SEGMENTS_H

#include "render/ray/segments.h"

/* grid_segments() - the kind's `segments` (kind.h). tr->own: a walk_scene. */
segments_result grid_segments(const tracer *tr, const ray *r, segments_state *state,
                              ray_counters *counters);

/* grid_segments_error() - the kind's `segments_error`: the bounds above, for the narrowest cell. */
segments_error grid_segments_error(const tracer *tr, const ray *r, const double range[2]);

#endif
