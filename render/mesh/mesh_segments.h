/* mesh_segments.h - finds one ray's pieces through the tets of a mesh, in order of t (segments.h).
 *
 * Treelets overlap, so pieces of several are merged. A piece is given out once every treelet that
 * the ray has yet to enter begins behind its start (mesh_passage.h). Until then it is kept, in
 * order, among the pieces ahead. If there is no room for one more, the last of them is dropped, and
 * everything behind it. The pieces before it are given out, and the ray begins once more behind
 * these. So any room, even of one piece, gives the same pieces; but each time it runs out, treelets
 * are entered again. A ray meets some 20 to 100 tets in a treelet of the usual size, and is in two
 * or three at a time.
 *
 * Errors: at the ends, as in tet_segment.h; between the ends the value is linear.
 */
#ifndef RENDER_MESH_MESH_SEGMENTS_H
#define RENDER_MESH_MESH_SEGMENTS_H

#include "render/mesh/tet_segment.h"
#include "render/ray/segments.h"

/* mesh_segments() - the row's `segments`. tr->own: a mesh_rays. */
segments_result mesh_segments(const tracer *tr, const ray *r, segments_state *state,
                              ray_counters *counters);

/* mesh_piece() - a tet's piece within the ray's [t0, t1]; cell and treelet are not set. False: it
 * has no length. */
bool mesh_piece(const tet *x, const ray *r, segment *s);

/* mesh_segments_error() - the row's `segments_error`: the errors above. A face lies in its
 * treelet's box. So along the ray it spans no more of t than the widest such box does, however
 * large the mesh is, and no more values than there are. */
segments_error mesh_segments_error(const tracer *tr, const ray *r, const double range[2]);

#endif
