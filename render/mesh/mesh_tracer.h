/* mesh_tracer.h - one ray through a whole mesh, treelet by treelet, resumable: tracer_next() for
 * tetrahedra.
 *
 * Treelets overlap, so that no order of them is front to back. A ray takes them in the order of
 * (the t at which it enters their box, index): a hit is final when the next active one begins
 * behind it. Where the ray goes on after it was suspended is then that pair, and nothing else.
 *
 * Hits are ordered by (t, iso, entering, tet). One crossing that several tets share (through a
 * face's edge, a vertex) has the same t bits, isovalue and direction in all of them: it is the hit
 * of the first of these tets, and the next hit differs in one of the three (tet_kernel.h).
 */
#ifndef RENDER_MESH_MESH_TRACER_H
#define RENDER_MESH_MESH_TRACER_H

#include "render/tracer.h"

/* mesh_tracer_next() - as tracer_next(). */
trace_result mesh_tracer_next(const tracer *tr, const ray *r, trace_state *state,
                              ray_counters *counters);

/* mesh_tracer_surface() - the point of a hit that lies in tet h->cell of this treelet. */
surface_point mesh_tracer_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h);

#endif
