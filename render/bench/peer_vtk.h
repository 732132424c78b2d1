/* peer_vtk.h - VTK's flying edges on the same field: a child process (leafcast-peer-vtk, python3
 * with VTK) that is asked for one extraction after the other. */
#ifndef RENDER_BENCH_PEER_VTK_H
#define RENDER_BENCH_PEER_VTK_H

#include "render/bench/peer_field.h"

typedef struct peer_vtk peer_vtk;

/* peer_vtk_start() - hands the field over; ST_UNSUPPORTED when python3 or VTK is not there: says
 * what to install. The field's axes are taken to be regular. */
CHECKED status peer_vtk_start(mem *m, const peer_field *field, int threads, peer_vtk **out);
void peer_vtk_stop(peer_vtk *v); /* NULL is fine */

/* peer_vtk_extract() - points, normals from the gradient, triangles; *seconds as the child measured
 * it. */
CHECKED status peer_vtk_extract(peer_vtk *v, double isovalue, double *seconds, uint64_t *triangles);

/* peer_vtk_version() - "9.1.0"; valid as long as v. */
const char *peer_vtk_version(const peer_vtk *v);

#endif
