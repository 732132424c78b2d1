/* mesh_segments.h - one ray's pieces through the tets of a mesh, in order of t (segments.h).
 *
 * Treelets overlap, so that pieces of several are merged: a piece comes next when no treelet that
 * the ray has yet to enter begins before it (mesh_passage.h). Until then it is held among those
 * ahead, in order. Where there is no room for one more, the last of them is dropped, and with it
 * everything behind it: what comes before is given out, and the ray begins once more behind that.
 * So any room does, of one piece even, and gives the same pieces; each time it runs out, treelets
 * are entered again. A ray meets some 20 to 100 tets in a treelet of the usual size, and is in two
 * or three at a time.
 *
 * Errors: those of tet_segment.h at the ends; between them the value is their mean.
 */
#ifndef RENDER_MESH_MESH_SEGMENTS_H
#define RENDER_MESH_MESH_SEGMENTS_H

#include "render/mesh/tet_segment.h"
#include "render/ray/segments.h"

/* mesh_segments() - the row's `segments`. tr->own: a mesh_rays. */
segments_result mesh_segments(const tracer *tr, const ray *r, segments_state *state,
                              ray_counters *counters);

/* mesh_piece() - a tet's piece within the ray's [t0, t1]: all but where it is from. False: it has
 * no length. */
bool mesh_piece(const tet *x, const ray *r, segment *s);

/* mesh_segments_error() - the row's `segments_error`: the above. A face lies in its treelet's box,
 * so that it spans no more of t than the widest of these do along the ray, however large the mesh
 * is; nor more values than there are. */
segments_error mesh_segments_error(const tracer *tr, const ray *r, const double range[2]);

#endif
