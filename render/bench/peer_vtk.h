/* peer_vtk.h - VTK's flying edges and its fixed-point ray caster on the same field: a child process
 * (leafcast-peer-vtk, python3 with VTK) that is asked for one thing after the other. */
#ifndef RENDER_BENCH_PEER_VTK_H
#define RENDER_BENCH_PEER_VTK_H

#include "render/bench/peer_field.h"
#include "render/leafcast.h"

typedef struct peer_vtk peer_vtk;

/* peer_vtk_start() - hands the field over; ST_UNSUPPORTED when python3 or VTK is not there: says
 * what to install. The field's axes are taken to be regular. */
CHECKED status peer_vtk_start(mem *m, const peer_field *field, int threads, peer_vtk **out);
void peer_vtk_stop(peer_vtk *v); /* NULL is fine */

/* peer_vtk_extract() - points, normals from the gradient, triangles; *seconds as the child measured
 * it. */
CHECKED status peer_vtk_extract(peer_vtk *v, double isovalue, double *seconds, uint64_t *triangles);

/* peer_vtk_fill() - for pictures with the samples as numbers of this type ("float", "uint8",
 * "int16", "uint16"): a medium of `count` points whose extinction is the opacity over `length`, a
 * camera in the field's own frame, which begins at its first sample. */
typedef struct peer_vtk_scene {
    const char *type;
    const leafcast_transfer_point *points;
    int count;
    double length;
    leafcast_camera camera;
} peer_vtk_scene;
CHECKED status peer_vtk_fill(peer_vtk *v, const peer_vtk_scene *scene);

/* peer_vtk_cast() - a picture of what was filled, of that type, unshaded, a sample every
 * `distance`; *seconds as the child measured it; rgba: 4 numbers a pixel, premultiplied, as those
 * of leafcast_image. */
CHECKED status peer_vtk_cast(peer_vtk *v, const char *type, double distance, double *seconds,
                             double *rgba);

/* peer_vtk_version() - "9.1.0"; valid as long as v. */
const char *peer_vtk_version(const peer_vtk *v);

#endif
