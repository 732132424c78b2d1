/* surface_vtk.h - VTK's polygonal data whose arrays have been found, on its way to a stream of
 * triangles; and its reader in legacy files (.vtk, DATASET POLYDATA), in text or binary.
 *
 * Polygons and strips are taken; vertices and lines are skipped and counted. Arrays of 3 or 4
 * unsigned chars, and COLOR_SCALARS of as many, are colours. Each array is read at its place in the
 * file, so the file must be regular. Pieces are joined in order.
 */
#ifndef FORMATS_SURFACE_SURFACE_VTK_H
#define FORMATS_SURFACE_SURFACE_VTK_H

#include "formats/mesh/mesh_reader.h"
#include "formats/surface/surface_choice.h"
#include "formats/vtk/vtk_fields.h"

/* In the order in which the data of cells come. */
typedef enum surface_vtk_kind {
    SURFACE_VTK_VERTICES,
    SURFACE_VTK_LINES,
    SURFACE_VTK_POLYGONS,
    SURFACE_VTK_STRIPS,
    SURFACE_VTK_KINDS
} surface_vtk_kind;

typedef struct surface_vtk_piece {
    uint64_t points;
    vtk_array position;
    vtk_lists cells[SURFACE_VTK_KINDS];
    vtk_fields fields;
} surface_vtk_piece;

typedef struct surface_vtk {
    surface_choice choice; /* first: it is the reader's state */
    mem *m;
    const mesh_source *source;
    surface_vtk_piece *pieces;
    size_t count, room;
    uint64_t points; /* of all pieces */
} surface_vtk;

/* surface_vtk_add_piece() - add an empty piece; *out is valid until the next one is added. */
CHECKED status surface_vtk_add_piece(surface_vtk *v, surface_vtk_piece **out);

/* A reader's functions. surface_vtk_open(): scan the file for its pieces, and check them. */
CHECKED status surface_vtk_open(mesh_source *source, status (*scan)(surface_vtk *v), void **state);
CHECKED status surface_vtk_take(void *state, const char *const *names, uint32_t count);
CHECKED status surface_vtk_read(void *state, mesh_feed *feed);
void surface_vtk_counts(const void *state, uint64_t *points, uint64_t *cells);
void surface_vtk_close(void *state);

extern const mesh_reader surface_vtk_reader;

#endif
