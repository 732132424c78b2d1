/* tetrahedralize.h - points to a Delaunay mesh, closed surfaces to a quality mesh: a mesh stream.
 *
 * Points are rounded to floats first, so that the mesh is the Delaunay mesh of what is written;
 * those of a surface after meshing, so that its facets stay plane. Points at one place become one.
 *
 * Values: of points, the field asked for, or the first there is, or zeros. Of a surface, the
 * distance to the nearest facet: 0 on it, computed of the points as they are written, in doubles;
 * or, when a field is asked for, its values at the surface's points, and elsewhere those of the
 * nearest place on the surface, linear in between.
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
        *field;         /* NULL: see plc_hints; "distance" is computed, unless it is there */
    const char *output; /* "-": standard output */
    bool force;
    bool points;         /* facets are left aside */
    bool meshing;        /* ratio or max_volume were asked for: points alone are no input */
    double ratio, angle; /* see tetgen_options */
    double max_volume;
    uint64_t memory; /* of the whole job; 0: what the machine has */
    double seconds;  /* TetGen may take; 0: any */
    int threads;
} tetrahedralize_options;

typedef struct tetrahedralize_report {
    bool surface;
    uint64_t points_in, facets_in; /* as read, cleaned */
    plc_report cleaned;
    uint64_t points, tets; /* of the mesh */
    uint64_t unused;       /* points in no tet */
    uint64_t flat; /* tets without volume, or turned over, by positions being rounded to floats */
    double volume; /* of all tets */
    char field[MESH_NAME_MAX + 1]; /* "": none */
} tetrahedralize_report;

CHECKED status tetrahedralize(mem *m, const tetrahedralize_options *options, const progress *p,
                              tetrahedralize_report *report);

#endif
