/* vtk_grid.h - a regular, rectilinear or structured grid of VTK whose arrays have been found, as a
 * source of slices.
 *
 * A scanner (vtk_grid_xml.c, vtk_grid_legacy.c) says where the grid lies, and adds its pieces with
 * the arrays in them; vtk_grid_open() chooses one array. Its samples are those of the nodes, or,
 * for an array of the cells, of the cells' centres: one fewer along each axis. Pieces lie side by
 * side and may overlap; those whose slices are being read are open, each with fixed buffers.
 */
#ifndef FORMATS_GRID_VTK_GRID_H
#define FORMATS_GRID_VTK_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/grid/slice_source.h"
#include "formats/grid/stored_samples.h"
#include "formats/grid/volume_hints.h"
#include "formats/vtk/vtk_cursor.h"
#include "formats/vtk/vtk_fields.h"
#include "formats/vtk/vtk_parts.h"

/* Nodes, the last one included: x, y, z from lo to hi. */
typedef struct vtk_extent {
    int64_t lo[3], hi[3];
} vtk_extent;

#define VTK_EXTENT_MAX ((int64_t)1 << 30)

/* vtk_extent_holds() - whether all nodes of `inner` are among those of `outer`. */
bool vtk_extent_holds(const vtk_extent *outer, const vtk_extent *inner);

/* vtk_extent_is_empty() - no nodes: what a writer without a share of the grid leaves behind. */
bool vtk_extent_is_empty(const vtk_extent *e);

/* Where a grid lies: node (i, j, k) at origin + direction * (spacing * (i, j, k)). */
typedef struct vtk_frame {
    vtk_extent whole;
    double origin[3], spacing[3];
    double direction[3][3]; /* [row][axis] */
    bool has_direction;     /* the file says it */
} vtk_frame;

/* vtk_frame_init() - unit spacing at the origin, no nodes. */
void vtk_frame_init(vtk_frame *f);

typedef enum vtk_geometry {
    VTK_REGULAR,     /* in the frame */
    VTK_RECTILINEAR, /* along the axes of the pieces */
    VTK_STRUCTURED   /* at the points of the pieces, which must make one of the others */
} vtk_geometry;

typedef struct vtk_grid_piece {
    const char *path; /* of the file it is in; the grid's */
    vtk_extent extent;
    vtk_fields fields;
    vtk_array axis[3]; /* rectilinear: the nodes' coordinates */
    vtk_array points;  /* structured: the nodes' places */

    /* vtk_grid.c's own */
    const vtk_array *field; /* the one chosen */
    vtk_cursor *samples;    /* while they are read */
} vtk_grid_piece;

typedef struct vtk_grid {
    mem *m;
    char **paths; /* of its files; the first is the one that was opened */
    size_t path_count, path_room;
    vtk_parts parts; /* where a collection names the file that was opened; else zeros */
    vtk_geometry geometry;
    vtk_frame frame;
    vtk_grid_piece *pieces;
    size_t count, room;

    /* vtk_grid.c's own */
    vtk_owner owner;         /* whose field was chosen, */
    const char *chosen;      /* and its name */
    stored_samples stored;   /* its numbers, */
    double rounding;         /* by what reading them rounded, */
    sample_type type;        /* what they become, */
    vtk_extent samples;      /* and how they are numbered: as the nodes or the cells */
    char *chunk;             /* some of them as they are stored; NULL: as the grid has them */
    size_t *order, ordered;  /* the pieces with samples by their first slices */
    size_t begun;            /* so many of them */
    size_t *active, actives; /* those that have the slice, in order */
    uint8_t *seen;           /* the samples of a slice that some piece has; NULL for one piece */
} vtk_grid;

CHECKED status vtk_grid_create(mem *m, vtk_grid **out);
void vtk_grid_close(vtk_grid *g); /* NULL is fine */

/* vtk_grid_add_path() - a copy of a path that lives as long as the grid. */
CHECKED status vtk_grid_add_path(vtk_grid *g, const char *path, const char **out);

/* vtk_grid_add_piece() - an empty one, valid until the next. */
CHECKED status vtk_grid_add_piece(vtk_grid *g, vtk_grid_piece **out);

/* vtk_grid_open() - a complete grid as a source, which then owns it. hints->field: an array of the
 * points, else one of the cells; without it the first of numbers. ST_USAGE, naming what there is,
 * when there is none; ST_CORRUPT where arrays do not fit the extents, or the file; then the grid is
 * the caller's. out->format is the caller's to set. */
CHECKED status vtk_grid_open(vtk_grid *g, const volume_hints *hints, slice_source *out);

#endif
