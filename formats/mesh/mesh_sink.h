/* mesh_sink.h - where a mesh goes that is read, what is asked of it, and what is told of it: what
 * mesh_input.h and its readers share.
 */
#ifndef FORMATS_MESH_MESH_SINK_H
#define FORMATS_MESH_MESH_SINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/input_trust.h"

enum { MESH_NAME_MAX = 63 }; /* bytes, without the NUL */
#define MESH_POINTS_MAX ((uint64_t)UINT32_MAX - 1)

/* Where a mesh goes. Points and values come in order of id, each vertex once; points, values and
 * tets in any order among each other, and so do the values of several fields. What is handed over
 * is valid during the call. A status other than ST_OK ends the reading and is what
 * mesh_input_read() returns. */
typedef struct mesh_sink {
    void *ctx;
    status (*points)(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]);
    /* of the one field asked for; zeros for a mesh without any. Of several, mesh_input_take(), the
     * k-th one's begin at `first' = k * points; each field's come in order. */
    status (*values)(void *ctx, uint64_t first, size_t count, const float *values);
    /* any orientation; four different ids, each that of a point. May be flat or inverted. */
    status (*tets)(void *ctx, size_t count, const uint32_t (*ids)[4]);
} mesh_sink;

/* What the command line says. Zero/NULL = not given. */
typedef struct mesh_hints {
    const char *field; /* the array's name; else the first of the points, or the first at all */
    int component;     /* of a vector array: 1, 2, ..; 0: its magnitude */
    bool
        cells_to_points; /* take cell data, averaged to the points: the mean over a point's cells */
    const char *name;    /* of the data set, in place of the mesh's own */
    uint32_t step;       /* of a file of several time steps, from 0 on */
    input_trust trust;
} mesh_hints;

/* The cells that are split, by the number of their vertices' arrangement; also indexes
 * mesh_report.split. */
typedef enum mesh_cell {
    MESH_HEX,     /* 8 vertices: bottom quad around, then the top one above it (VTK_HEXAHEDRON) */
    MESH_WEDGE,   /* 6: a triangle, then the opposite one; edges 0-3, 1-4, 2-5 */
    MESH_PYRAMID, /* 5: quad around, then the apex */
    MESH_VOXEL,   /* 8: x fastest (VTK_VOXEL) */
    MESH_SPLIT_KINDS,
    MESH_TET = MESH_SPLIT_KINDS /* 4 */
} mesh_cell;

typedef struct mesh_report {
    uint64_t points, tets;            /* handed over */
    uint64_t split[MESH_SPLIT_KINDS]; /* cells that were split; tets counts what came of them */
    uint64_t bad_indices;             /* cells left out: an id that is no point */
    uint64_t repeated;                /* tets left out: the same vertex twice */
    uint64_t skipped; /* cells of fewer dimensions (vertices, edges, triangles, ..) passed over */
    uint64_t ghosts;  /* cells left out: another piece of the mesh has them, or they are hidden */
    char field[MESH_NAME_MAX + 1]; /* the first array taken; "" for a mesh without any */
} mesh_report;

/* A field that could be taken, and how many numbers it has a point: see mesh_input_fields(). */
typedef void mesh_field_taker(void *ctx, const char *name, int components);

#endif
