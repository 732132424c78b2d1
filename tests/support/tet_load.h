/* tet_load.h - whole tetrahedral meshes from mesh streams (formats/MESH_STREAM.md) and from raw
 * arrays, for the reference; reads them by itself.
 */
#ifndef TESTS_SUPPORT_TET_LOAD_H
#define TESTS_SUPPORT_TET_LOAD_H

#include <stdbool.h>

#include "tests/support/tet_reference.h"

/* Little endian arrays without headers, each plain or NAME.zst. */
typedef struct tet_arrays {
    const char *points; /* x y z; f32, or f64 where the name has "f64" in it: rounded to float */
    const char *values; /* f32, one a point */
    const char *tets;   /* 4 x i32 from 0 */
} tet_arrays;

/* false: *why says what is the matter. Release it. */
bool tet_load_stream(const char *path, tet_ref_mesh *m, const char **why);
bool tet_load_arrays(const tet_arrays *from, tet_ref_mesh *m, const char **why);
void tet_unload(tet_ref_mesh *m);

/* tet_load_box() - around the points that tetrahedra use. */
void tet_load_box(const tet_ref_mesh *m, double lo[3], double hi[3]);

#endif
