/* peer_tets.h - a mesh's tetrahedra in memory, and their isosurfaces as triangles: what a mesh ray
 * tracer is given instead of the treelet file.
 *
 * Marching tetrahedra by the kernel's own isopolygons, a quadrilateral as its two triangles, each
 * triangle with vertices of its own and the normal of its tet: flat, as ours.
 */
#ifndef RENDER_BENCH_PEER_TETS_H
#define RENDER_BENCH_PEER_TETS_H

#include "formats/leaf/leaf_file.h"
#include "render/bench/peer_mesh.h"

typedef struct peer_tets {
    leaf_file *file;
    void **topology, **values; /* a payload a treelet */
    mem *m;
} peer_tets;

/* peer_tets_payload() - a payload of any file, in memory of its own; mem_free() in any case. */
CHECKED status peer_tets_payload(mem *m, leaf_file *f, uint32_t p, void **payload);

/* peer_tets_load() - peer_tets_release() in any case. */
CHECKED status peer_tets_load(mem *m, const char *path, pool *threads, peer_tets *tets);
void peer_tets_release(peer_tets *tets);

/* peer_tets_extract() - as peer_mesh_extract(). */
CHECKED status peer_tets_extract(mem *m, const peer_tets *tets, double isovalue, pool *threads,
                                 peer_mesh *mesh);

#endif
