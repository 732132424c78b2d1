/* tetrahedralize.h - meshes points (Delaunay) or closed surfaces (with quality bounds) into a mesh
 * stream.
 *
 * Points are rounded to floats first, so that the result is the Delaunay mesh of what is written.
 * Points of a surface are rounded after meshing, so that its facets stay plane. Points at one place
 * become one.
 *
 * Values of points: the field asked for, else the first there is, else zeros. Values of a surface:
 * the distance to the nearest facet, 0 on it, computed in doubles from the points as written. Or,
 * if a field is asked for, its values at the surface's points; elsewhere the value of the nearest
 * place on the surface, interpolated linearly.
 */
#ifndef PREP_TETRAHEDRALIZE_TETRAHEDRALIZE_H
#define PREP_TETRAHEDRALIZE_TETRAHEDRALIZE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/surface/plc_clean.h"

#define TETRAHEDRALIZE_DISTANCE "distance"

typedef struct tetrahedralize_options {
    const char *input; /* "-": standard input */
    const char *format,
        *field;         /* NULL: see plc_hints; "distance" is computed unless the input has it */
    const char *output; /* "-": standard output */
    bool force;
    bool points;         /* ignore facets */
    bool meshing;        /* ratio or max_volume are given: points alone are refused */
    double ratio, angle; /* see tetgen_options */
    double max_volume;
    uint64_t memory; /* budget of the whole job; 0: the machine's memory */
    double seconds;  /* time limit for TetGen; 0: none */
    int threads;
} tetrahedralize_options;

typedef struct tetrahedralize_report {
    bool surface;
    uint64_t points_in, facets_in; /* after reading and cleaning */
    plc_report cleaned;
    uint64_t points, tets;         /* of the mesh */
    uint64_t unused;               /* points in no tet */
    uint64_t flat;                 /* tets that rounding to floats made flat or inverted */
    double volume;                 /* of all tets */
    char field[MESH_NAME_MAX + 1]; /* "": none */
} tetrahedralize_report;

CHECKED status tetrahedralize(mem *m, const tetrahedralize_options *options, const progress *p,
                              tetrahedralize_report *report);

#endif
