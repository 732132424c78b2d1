/* tet_meshes.h - small tetrahedral meshes by name, each a trap for a ray tracer, and rays that seek
 * it: through vertices, along edges, in faces.
 *
 * All are Kuhn meshes (six tetrahedra a cube of a grid), put in hostile places, with hostile
 * values, and damaged. Vertex ids are shuffled.
 */
#ifndef TESTS_SUPPORT_TET_MESHES_H
#define TESTS_SUPPORT_TET_MESHES_H

#include "tests/support/fields.h"
#include "tests/support/tet_reference.h"

typedef struct lab_mesh {
    const char *name;
    size_t point_count, tet_count;
    float (*points)[3];
    float *values;
    uint32_t (*tets)[4];
    double lo[3], hi[3]; /* a box around the points */
    double iso;          /* a value worth looking at */
    bool closed; /* it has no gap, and all outside it and its whole boundary lie below iso: no way
                    leads in or out but through a surface */
    bool sound;  /* no two tetrahedra overlap, none is flat */
} lab_mesh;

/* lab_mesh_count(), lab_mesh_name() - all that there are: sphere, plateau, needle, flat, ... */
int lab_mesh_count(void);
const char *lab_mesh_name(int index);

/* lab_mesh_make() - of n^3 cubes (2 <= n <= 64); false when the name is unknown. Release it. */
bool lab_mesh_make(lab_mesh *m, const char *name, int n, uint64_t seed);
void lab_mesh_release(lab_mesh *m);

/* lab_mesh_reference() - for the reference; points into m. */
tet_ref_mesh lab_mesh_reference(const lab_mesh *m);

/* lab_mesh_kuhn() - n[0] * n[1] * n[2] cubes of side `step` from `origin` on, ids in order (x
 * fastest), values f(position). */
void lab_mesh_kuhn(lab_mesh *m, const int n[3], const double origin[3], double step,
                   double (*f)(const double p[3]));

typedef enum lab_ray {
    LAB_RAY_RANDOM,    /* towards a random point in a tetrahedron */
    LAB_RAY_AXIS,      /* the same, parallel to an axis */
    LAB_RAY_AT_VERTEX, /* through it, as exactly as the kind of place allows */
    LAB_RAY_AT_EDGE,   /* through its middle, or a quarter of it */
    LAB_RAY_AT_FACE,   /* through the middle between a vertex and the opposite edge's middle */
    LAB_RAY_IN_EDGE,   /* along it */
    LAB_RAY_IN_FACE,   /* in its plane, through it */
    LAB_RAY_INSIDE,    /* begins in a tetrahedron */
    LAB_RAY_ON_VERTEX, /* begins there */
    LAB_RAY_KINDS
} lab_ray;
const char *lab_ray_name(lab_ray kind);

/* lab_mesh_ray() - t = 1 (LAB_RAY_INSIDE, _ON_VERTEX: 0) is what it is aimed at; all but those two
 * begin outside the mesh. */
ref_ray lab_mesh_ray(const lab_mesh *m, lab_ray kind, field_random *r);

#endif
