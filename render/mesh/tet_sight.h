/* tet_sight.h - a tetrahedron as a ray sees it: on which side the ray passes its edges (Pluecker
 * tests, M08 6.2.1), which faces it crosses, and where.
 *
 * Sides are found when they are asked for, once an edge, exactly, of the ray moved as
 * tet_segment.h says. From a tet into its neighbour what is known of their face goes along: M08
 * 6.3.2.
 */
#ifndef RENDER_MESH_TET_SIGHT_H
#define RENDER_MESH_TET_SIGHT_H

#include "formats/base/exact.h"
#include "render/mesh/tet_kernel.h"

enum { TET_FACES = 4, TET_SIDE_UNKNOWN = 2 };

/* Faces by their vertices, then their edges 01, 02 and 12, as numbered in tet_kernel.h; whether
 * the fourth vertex, 3 - face, lies along the face's normal where the tet is positively oriented.
 */
typedef struct tet_face {
    uint8_t vertex[3], edge[3];
    int8_t inwards;
} tet_face;
extern const tet_face tet_faces[TET_FACES];

typedef struct tet_sight {
    const ray *r;
    double p[4][3], a[4][3], f[4];  /* its vertices; relative to the ray's origin; their values */
    exact_estimate edge[TET_EDGES]; /* the edge functions, from the lower id to the higher; */
    int side[TET_EDGES];            /* their signs, or TET_SIDE_UNKNOWN */
    uint64_t tests;                 /* sides that were found */
} tet_sight;

/* tet_sight_begin() - nothing is known yet; s->tests stays. */
void tet_sight_begin(tet_sight *s, const tet *x, const ray *r);

/* tet_sight_crosses() - whether the ray crosses a face; of such, tet_sight_enters() - whether it
 * comes in there, by the orientation of the tet (exact_orientation(), not 0), and tet_sight_meet()
 * - where, and at what value. */
bool tet_sight_crosses(tet_sight *s, int face);
bool tet_sight_enters(const tet_sight *s, int face, int orientation);
void tet_sight_meet(tet_sight *s, int face, double *t, double *f);

/* tet_sight_leaves_by() - the face by which the ray leaves that crosses `entered`: two tests, and a
 * third one where these leave two faces. */
int tet_sight_leaves_by(tet_sight *s, int entered);

/* tet_sight_go() - over a crossed face into the neighbour whose face `entered` it is; x: that tet.
 */
void tet_sight_go(tet_sight *s, int left, const tet *x, int entered);

#endif
