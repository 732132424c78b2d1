/* peer_surface.h - the triangles of a file that is a surface itself: what a mesh ray tracer is
 * given instead of the treelet file.
 *
 * Vertices are those of the treelets, so few are there twice. There are no normals: each triangle
 * has its own, as ours.
 */
#ifndef RENDER_BENCH_PEER_SURFACE_H
#define RENDER_BENCH_PEER_SURFACE_H

#include "render/bench/peer_mesh.h"

/* peer_surface_load() - the first step. ST_UNSUPPORTED: it is another kind of file, or has more
 * than 2^32 - 2 vertices. peer_mesh_release() in any case. */
CHECKED status peer_surface_load(mem *m, const char *path, pool *threads, peer_mesh *mesh);

#endif
