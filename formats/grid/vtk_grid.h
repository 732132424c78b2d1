/* vtk_grid.h - a regular, rectilinear or structured grid of VTK whose arrays have been found, as a
 * source of slices.
 *
 * A scanner (vtk_grid_xml.c, vtk_grid_legacy.c) says where the grid lies, and adds its pieces with
 * their arrays. vtk_grid_open() chooses one array. Its samples are the nodes', or, for an array of
 * the cells, the cells' centres': one fewer along each axis. Pieces lie side by side and may
 * overlap. A piece is open, with fixed buffers, only while its slices are being read.
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
#include "formats/vtk/vtk_extent.h"
#include "formats/vtk/vtk_fields.h"
#include "formats/vtk/vtk_parts.h"

/* Where a grid lies: node (i, j, k) at origin + direction * (spacing * (i, j, k)). */
typedef struct vtk_frame {
    vtk_extent whole;
    double origin[3], spacing[3];
    double direction[3][3]; /* [row][axis] */
    bool has_direction;     /* the file gives the direction */
} vtk_frame;

/* vtk_frame_init() - set unit spacing at the origin, and no nodes. */
void vtk_frame_init(vtk_frame *f);

typedef enum vtk_geometry {
    VTK_REGULAR,     /* nodes lie as the frame says */
    VTK_RECTILINEAR, /* nodes lie along the axes of the pieces */
    VTK_STRUCTURED   /* nodes are the points of the pieces, which must make one of the above */
} vtk_geometry;

typedef struct vtk_grid_piece {
    const char *path; /* the file it is in; owned by the grid */
    vtk_extent extent;
    vtk_fields fields;
    vtk_array axis[3]; /* rectilinear: the nodes' coordinates */
    vtk_array points;  /* structured: the nodes' places */

    /* private to vtk_grid.c: */
    const vtk_array *field; /* the one chosen */
    vtk_cursor *samples;    /* while they are read */
} vtk_grid_piece;

typedef struct vtk_grid {
    mem *m;
    char **paths; /* paths of its files; the first is the one that was opened */
    size_t path_count, path_room;
    vtk_parts parts; /* set if a collection names the file that was opened; else zeros */
    vtk_geometry geometry;
    vtk_frame frame;
    vtk_grid_piece *pieces;
    size_t count, room;

    /* private to vtk_grid.c: */
    vtk_owner owner;         /* owner of the chosen field */
    const char *chosen;      /* its name */
    stored_samples stored;   /* its numbers */
    double rounding;         /* the largest rounding error while reading them */
    sample_type type;        /* type that they become */
    vtk_extent samples;      /* numbering of the samples: as the nodes' or the cells' */
    char *chunk;             /* some stored samples; NULL: they need no conversion */
    size_t *order, ordered;  /* pieces with samples, sorted by their first slices */
    size_t begun;            /* how many of them have been begun */
    size_t *active, actives; /* pieces that have the slice, in order */
    uint8_t *seen;           /* samples of a slice that some piece has; NULL for one piece */
} vtk_grid;

CHECKED status vtk_grid_create(mem *m, vtk_grid **out);
void vtk_grid_close(vtk_grid *g); /* NULL is fine */

/* vtk_grid_add_path() - keep a copy of a path for as long as the grid lives. */
CHECKED status vtk_grid_add_path(vtk_grid *g, const char *path, const char **out);

/* vtk_grid_add_piece() - add an empty piece. *out is valid until the next one is added. */
CHECKED status vtk_grid_add_piece(vtk_grid *g, vtk_grid_piece **out);

/* vtk_grid_open() - turn a complete grid into a source, which then owns it. hints->field: an array
 * of the points, else one of the cells; without it the first array of numbers. ST_USAGE, naming the
 * arrays there are, when there is no such array; ST_CORRUPT where arrays do not fit the extents or
 * the file. On failure the caller keeps the grid. The caller sets out->format. */
CHECKED status vtk_grid_open(vtk_grid *g, const volume_hints *hints, slice_source *out);

#endif
