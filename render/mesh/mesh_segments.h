/* mesh_segments.h - finds one ray's pieces in the tets of a treelet (segments.h).
 *
 * Errors: at the ends, as in tet_segment.h; between the ends the value is linear.
 */
#ifndef RENDER_MESH_MESH_SEGMENTS_H
#define RENDER_MESH_MESH_SEGMENTS_H

#include "render/mesh/tet_segment.h"
#include "render/ray/segments.h"

/* mesh_pieces() - treelet_walks.pieces (walk/tree_walks.h). */
void mesh_pieces(const tracer *tr, const treelet *at, const ray *r, const hit *after,
                 segments_state *state, ray_counters *counters);

/* mesh_piece() - a tet's piece within the ray's [t0, t1]; cell and treelet are not set. False: it
 * has no length. */
bool mesh_piece(const tet *x, const ray *r, segment *s);

/* mesh_segments_error() - the row's `segments_error`: bounds of the errors above. A face lies in
 * its treelet's box. So its t differ by no more than the ray takes to cross the widest box of a
 * treelet, however large the mesh is. Its values differ by no more than the range. */
segments_error mesh_segments_error(const tracer *tr, const ray *r, const double range[2]);

#endif
