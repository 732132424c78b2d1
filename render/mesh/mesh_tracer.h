/* mesh_tracer.h - one ray's hits in a treelet of a mesh.
 *
 * Hits are ordered by (t, iso, entering, tet). A crossing that several tets share (at a face's
 * edge, a vertex) has the same t bits, isovalue and direction in all of them. It counts as a hit of
 * the first of these tets; the next hit differs in t, iso or entering (tet_kernel.h).
 */
#ifndef RENDER_MESH_MESH_TRACER_H
#define RENDER_MESH_MESH_TRACER_H

#include "render/ray/tracer.h"

/* tracer.own of a mesh: what its rays need during a frame. */
typedef struct mesh_rays {
    bool smooth;     /* interpolate normals from gradients at vertices, which its treelets have */
    unsigned packet; /* rays on a side of a packet (mesh_packet.h); 0: tiles instead */
} mesh_rays;

static inline const mesh_rays *mesh_rays_of(const tracer *tr) {
    return tr->own;
}

/* mesh_hits() - treelet_walks.hits (walk/tree_walks.h). */
bool mesh_hits(const tracer *tr, const treelet *at, const ray *r, trace_state *state,
               ray_counters *counters);

/* mesh_tracer_surface() - the surface point of hit h on ray r, in tet h->cell of this treelet. */
surface_point mesh_tracer_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h);

#endif
