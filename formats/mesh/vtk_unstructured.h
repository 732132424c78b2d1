/* vtk_unstructured.h - an unstructured VTK grid whose arrays have been found, on its way to a mesh.
 *
 * A scanner (mesh_vtk.c, mesh_vtu.c) adds pieces and the arrays in them. vtk_unstructured_read()
 * then reads the arrays that it needs, each at its place in the file, so the file must be regular.
 * Pieces are joined in order: the points of the second come behind those of the first.
 */
#ifndef FORMATS_MESH_VTK_UNSTRUCTURED_H
#define FORMATS_MESH_VTK_UNSTRUCTURED_H

#include "formats/mesh/mesh_feed.h"
#include "formats/mesh/mesh_reader.h"
#include "formats/mesh/vtk_cells.h"
#include "formats/vtk/vtk_fields.h"
#include "formats/vtk/vtk_parts.h"

typedef struct vtk_piece {
    const char *path; /* the file it is in; not owned */
    uint64_t points;
    uint64_t middles; /* points that its polyhedra add, once counted */
    vtk_array position;
    vtk_cells_source cells;
    vtk_fields fields;
} vtk_piece;

typedef struct vtk_unstructured {
    mem *m;
    const mesh_source *source;
    vtk_piece *pieces;
    size_t count, room;
    vtk_parts parts; /* the files that the source names */
    char **paths;    /* of the files with pieces */
    size_t path_count, path_room;
    uint64_t points;         /* of all pieces */
    vtk_owner owner;         /* whose fields are taken */
    const vtk_array **taken; /* each as found in one of the pieces */
    uint32_t taken_count;    /* 0: the mesh has no field */
} vtk_unstructured;

/* vtk_unstructured_add_path() - keep a copy of a path for as long as the grid lives. */
CHECKED status vtk_unstructured_add_path(vtk_unstructured *g, const char *path, const char **out);

/* vtk_unstructured_add_piece() - add an empty piece of a file. *out is valid until the next one is
 * added. path must live as long as the grid. */
CHECKED status vtk_unstructured_add_piece(vtk_unstructured *g, const char *path, vtk_piece **out);

/* vtk_unstructured_field() - returns the k-th taken array in a piece; NULL if an empty piece lacks
 * it. */
const vtk_array *vtk_unstructured_field(const vtk_unstructured *g, const vtk_piece *p, uint32_t k);

/* vtk_unstructured_open() - open a file's grid as a reader's state: scan it and check its pieces.
 * ST_UNSUPPORTED if the file is not regular.
 * vtk_unstructured_take() - choose the fields. ST_USAGE, naming the fields there are, when there is
 * no such field. */
CHECKED status vtk_unstructured_open(mesh_source *source,
                                     status (*scan)(vtk_unstructured *g, byte_stream *data),
                                     void **state);
CHECKED status vtk_unstructured_take(void *state, const char *const *names, uint32_t count);
CHECKED status vtk_unstructured_read(void *state, mesh_feed *feed);
void vtk_unstructured_close(void *state); /* NULL is fine */
void vtk_unstructured_fields(const void *state, mesh_field_taker *take, void *ctx);

#endif
