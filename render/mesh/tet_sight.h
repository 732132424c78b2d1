/* tet_sight.h - a ray and a tetrahedron: on which side the ray passes each edge (Pluecker tests,
 * M08 6.2.1), which faces it crosses, and where.
 *
 * The side of an edge is computed only when needed, once, and exactly; the ray is moved as
 * tet_segment.h says. When the ray goes from a tet into its neighbour, all that is known of their
 * common face is kept (M08 6.3.2).
 */
#ifndef RENDER_MESH_TET_SIGHT_H
#define RENDER_MESH_TET_SIGHT_H

#include "formats/base/exact.h"
#include "render/mesh/tet_kernel.h"

enum { TET_FACES = 4, TET_SIDE_UNKNOWN = 2 };

/* A face's vertices, then its edges 01, 02 and 12, as numbered in tet_kernel.h. inwards: whether
 * (1, else -1) the fourth vertex, 3 - face, lies along the face's normal if the tet is positively
 * oriented. */
typedef struct tet_face {
    uint8_t vertex[3], edge[3];
    int8_t inwards;
} tet_face;
extern const tet_face tet_faces[TET_FACES];

typedef struct tet_sight {
    const ray *r;
    double p[4][3], a[4][3], f[4];  /* vertices; the same relative to the ray's origin; values */
    exact_estimate edge[TET_EDGES]; /* the edge functions, from the lower id to the higher; */
    int side[TET_EDGES];            /* their signs, or TET_SIDE_UNKNOWN */
    uint64_t tests;                 /* how many sides were found */
} tet_sight;

/* tet_sight_begin() - starts with a tet of which nothing is known; s->tests stays. */
void tet_sight_begin(tet_sight *s, const tet *x, const ray *r);

/* tet_sight_crosses() - returns whether the ray crosses a face. The other two are for faces that it
 * crosses. tet_sight_enters() - returns whether the ray comes in there; orientation: of the tet, by
 * exact_orientation(), not 0. tet_sight_meet() - set *t and *f to the ray's t and the value there.
 */
bool tet_sight_crosses(tet_sight *s, int face);
bool tet_sight_enters(const tet_sight *s, int face, int orientation);
void tet_sight_meet(tet_sight *s, int face, double *t, double *f);

/* tet_sight_leaves_by() - returns the face by which the ray leaves, if it crosses `entered`. Takes
 * two tests, and a third if these leave two faces. */
int tet_sight_leaves_by(tet_sight *s, int entered);

/* tet_sight_go() - goes on to the neighbour x beyond the crossed face `left`. entered: the number
 * of this face in x. */
void tet_sight_go(tet_sight *s, int left, const tet *x, int entered);

#endif
