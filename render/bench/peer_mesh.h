/* peer_mesh.h - an isosurface as triangles: what a mesh ray tracer is given instead of the volume.
 *
 * Marching cubes with shared vertices, row by row, in the manner of flying edges (Schroeder,
 * Maynard, Geveci 2015), parallel throughout: a first sweep turns the samples into bits (inside is
 * f >= isovalue), a second one counts the cut edges and triangles that begin in each row, a third
 * one writes them where the counts say. Where four cut edges meet on a face, the inside corners are
 * kept apart, from both sides alike: the mesh is closed but for the faces of the volume.
 */
#ifndef RENDER_BENCH_PEER_MESH_H
#define RENDER_BENCH_PEER_MESH_H

#include "render/bench/peer_field.h"

typedef struct peer_mesh {
    double origin[3]; /* world space; positions relate to it, so that floats suffice */
    float *positions; /* x y z of each vertex, and room for one more */
    float *normals;   /* unit, towards lower values: central differences at the nodes, interpolated;
                         0 where there is no gradient; NULL: the triangles' own */
    uint32_t *corners; /* three vertices a triangle */
    size_t vertices, triangles;
    mem *m;
} peer_mesh;

/* peer_mesh_extract() - ST_UNSUPPORTED beyond 2^32 - 2 vertices. peer_mesh_release() in any case.
 */
CHECKED status peer_mesh_extract(mem *m, const peer_field *field, double isovalue, pool *threads,
                                 peer_mesh *mesh);
void peer_mesh_release(peer_mesh *mesh);

#endif
