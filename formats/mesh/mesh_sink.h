/* mesh_sink.h - types that mesh_input.h and its readers share: the sink, hints and report of a mesh
 * that is read. */
#ifndef FORMATS_MESH_MESH_SINK_H
#define FORMATS_MESH_MESH_SINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/cell_row.h"
#include "formats/base/cell_shape.h"
#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/input_trust.h"

enum { MESH_NAME_MAX = 63 }; /* bytes, without the NUL */
#define MESH_POINTS_MAX ((uint64_t)UINT32_MAX - 1)

/* Callbacks that receive a mesh. Points come in order of id, and so do each field's values, each
 * vertex once. Points, tets and the values of several fields may interleave in any order. Arrays
 * are valid during the call. A status other than ST_OK ends the reading, and mesh_input_read()
 * returns it. */
typedef struct mesh_sink {
    void *ctx;
    status (*points)(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]);
    /* Values of the one field asked for; zeros for a mesh without any. Of several fields
     * (mesh_input_take()), the k-th begins at `first` = k * points; each field's values come in
     * order. */
    status (*values)(void *ctx, uint64_t first, size_t count, const float *values);
    /* Four different ids, each a point's, in any orientation. Tets may be flat or inverted. */
    status (*tets)(void *ctx, size_t count, const uint32_t (*ids)[4]);
    /* NULL, or taken in the place of tets: cells of all shapes, none of them split, as rows of ids
     * (cell_row.h), four or more of them different. */
    status (*cells)(void *ctx, size_t count, const uint32_t (*ids)[CELL_ROW]);
    /* Taken in the place of tets by inputs that are surfaces: three ids, each a point's; all
     * different. */
    status (*triangles)(void *ctx, size_t count, const uint32_t (*ids)[3]);
    /* NULL, or taken beside triangles where the file has them: the normals of the points
     * (triangle_normal.h), in order, all of them or none. */
    status (*normals)(void *ctx, uint64_t first, size_t count, const uint32_t *codes);
    bool corners; /* tets() takes quadratic ones, too, as linear ones of their corners; else they
                     are refused without cells() */
} mesh_sink;

/* What the command line says. Zero/NULL = not given. */
typedef struct mesh_hints {
    const char *field; /* the array's name; NULL: the first one */
    int component;     /* component of a vector array: 1, 2, ..; 0: its magnitude */
    bool
        cells_to_points; /* take cell data, averaged to the points: the mean over a point's cells */
    bool by_corners;     /* take cells of higher order as linear ones of their corners, without
                            what they hold in between; else they are refused */
    const char *name;    /* name of the data set, in place of the mesh's own */
    uint32_t step;       /* which of the file's time steps, from 0 */
    input_trust trust;
} mesh_hints;

typedef struct mesh_report {
    uint64_t whole[CELL_SHAPES]; /* by cell_shape: cells handed over as they are, or quadratic tets
                                    by their corners; `tets` counts all of them */
    uint64_t points, tets;       /* handed over; of surfaces, `tets` counts triangles */
    uint64_t split[CELL_SPLIT_SHAPES]; /* by cell_shape: cells that were split; `tets` counts the
                                          tets they gave */
    uint64_t normals;     /* of points, that the file has; those without a direction, too */
    uint64_t polyhedra;   /* cells of many faces, handed over in parts (mesh_polyhedron.h), which
                             `tets` counts */
    uint64_t polygons;    /* of four or more corners, which were cut into triangles */
    uint64_t fanned;      /* those of them that were cut without a look at their corners */
    uint64_t by_corners;  /* cells of higher order that were taken as linear ones */
    uint64_t bad_indices; /* cells left out: an id is outside the points */
    uint64_t repeated;    /* tets left out: a vertex comes twice */
    uint64_t skipped;     /* cells skipped: fewer dimensions (vertices, edges, triangles, ..) */
    uint64_t ghosts; /* cells left out: another piece of the mesh has them, or they are hidden */
    char field[MESH_NAME_MAX + 1]; /* the first array taken; "" for a mesh without any */
} mesh_report;

/* Receives a field that could be taken and its number of components, with a minus where it is not
 * taken unasked: see mesh_input_fields(). */
typedef void mesh_field_taker(void *ctx, const char *name, int components);

#endif
