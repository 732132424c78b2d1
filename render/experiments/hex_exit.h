/* hex_exit.h - through which face a ray leaves a hexahedron, and where on it, by the two methods of
 * M08 6.4.2: Pluecker tests alone, or with bilinear patches.
 *
 * All of it in the ray's space (formats/curved/sheared_ray.h), where its line is an axis: there a
 * Pluecker test, the permuted inner product of ray and edge (M08 eq. 6.3), is a determinant of two
 * by two, and depends on the edge's ends alone.
 *
 * Faces are numbered as of hexahedron.h; the corners of a face are in the order (0,0), (1,0),
 * (0,1), (1,1) of its parameters, which rise with those of the grid. So both cells of a face see
 * the same patch, and the same two triangles, which meet between (0,0) and (1,1).
 *
 * Both methods take cells whose faces are convex as the ray sees them, and where the face opposite
 * of the entry is not turned away from it: in wide wedges it may be. In others they choose a face
 * that the ray does not cross: it is lost.
 */
#ifndef RENDER_EXPERIMENTS_HEX_EXIT_H
#define RENDER_EXPERIMENTS_HEX_EXIT_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/hexahedron.h"

/* A cell as the ray sees it. */
typedef struct hex_view {
    double q[HEX_CORNERS][3]; /* corners in the ray's space */
    int sense;                /* 1: right-handed there; -1 */
    int entry;                /* face */
    double t;                 /* where it enters */
    bool placed;              /* asked for: where it leaves */
    uint64_t tests, patches;  /* counted */
} hex_view;

/* A point of a face: t, and the weights of the face's corners. */
typedef struct hex_point {
    double t, weight[4];
} hex_point;

/* hex_exit_pluecker(), hex_exit_hybrid() - the face that a ray leaves by; -1: it is lost. out:
 * where on it, if asked for; patches tell in any case. */
typedef int hex_exit(hex_view *v, hex_point *out);
int hex_exit_pluecker(hex_view *v, hex_point *out);
int hex_exit_hybrid(hex_view *v, hex_point *out);

/* hex_exit_triangles() - a point of a face by its two triangles (M08 6.4.3). q: its corners in the
 * ray's space. turn: 1 where these turn around a ray that crosses like a right-handed screw; -1.
 * False: the ray misses both.
 * hex_exit_patch() - the same by the patch (M08 6.2.2), at the first crossing from t on. */
typedef enum hex_met { HEX_OFF, HEX_EDGE /* within rounding of an edge */, HEX_ON } hex_met;
bool hex_exit_triangles(const double *const q[4], int turn, hex_point *out);
hex_met hex_exit_patch(const double *const q[4], double t, hex_point *out);

#endif
