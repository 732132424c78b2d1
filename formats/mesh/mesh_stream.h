/* mesh_stream.h - the mesh stream: the simplest mesh format, for pipes and for everything else.
 *
 * A header of text, then arrays, little endian; see MESH_STREAM.md. The same calls give the same
 * bytes on every machine.
 */
#ifndef FORMATS_MESH_MESH_STREAM_H
#define FORMATS_MESH_MESH_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/mesh/mesh_reader.h"
#include "formats/mesh/mesh_sink.h"

enum { MESH_STREAM_FIELDS_MAX = 1000 };
#define MESH_STREAM_CELLS_MAX ((uint64_t)1 << 56)
enum { MESH_STREAM_POLYHEDRON_MAX = 1 << 16 }; /* numbers of a polyhedron, the first one too */

typedef struct mesh_stream_header {
    char name[MESH_NAME_MAX + 1], field[MESH_NAME_MAX + 1]; /* "": none; printable, one line */
    uint64_t points, tets; /* points <= MESH_POINTS_MAX; tets <= MESH_STREAM_CELLS_MAX */
    /* What version 1 has not. If there is any of it, version 2 is written. */
    bool bare;                   /* no values at all, and no `field` */
    uint64_t cells[CELL_SHAPES]; /* further ones, by cell_shape; 0 of CELL_VOXEL and CELL_TET */
    uint64_t polyhedra, numbers; /* and how many numbers these take */
    uint64_t middles; /* points that they add: mesh_polyhedron_middles() of those that have points
                         alone */
    const char *const *fields; /* further ones, if `field` is one, as that */
    uint32_t field_count;      /* < MESH_STREAM_FIELDS_MAX */
    uint64_t by_corners;       /* of these cells: linear in place of those of a higher order */
    uint64_t skipped;          /* cells of fewer dimensions that are not here */
} mesh_stream_header;

typedef struct mesh_stream_writer mesh_stream_writer;

/* mesh_stream_create() - begin the file `path` ("-": standard output) and write its header. force:
 * see out_file_create(). */
CHECKED status mesh_stream_create(mem *m, const char *path, bool force, const mesh_stream_header *h,
                                  mesh_stream_writer **out);

/* Write all points, then all values, field by field, then all tets, pyramids, wedges, hexahedra,
 * quadratic tets and polyhedra, in runs of any length. Another order, or more than the header says,
 * fails an assert. Without a field, version 1 has values all the same. mesh_stream_cells(): ids of
 * `count` cells of a shape, as cell_shape.h orders them. mesh_stream_numbers(): of polyhedra, as
 * MESH_STREAM.md orders them. */
CHECKED status mesh_stream_points(mesh_stream_writer *w, size_t count, const float (*xyz)[3]);
CHECKED status mesh_stream_values(mesh_stream_writer *w, size_t count, const float *values);
CHECKED status mesh_stream_tets(mesh_stream_writer *w, size_t count, const uint32_t (*ids)[4]);
CHECKED status mesh_stream_cells(mesh_stream_writer *w, cell_shape shape, size_t count,
                                 const uint32_t *ids);
CHECKED status mesh_stream_numbers(mesh_stream_writer *w, size_t count, const uint32_t *numbers);

/* mesh_stream_commit() - give the file its name. Everything must have been written (an assert).
 * Consumes w in any case. */
CHECKED status mesh_stream_commit(mesh_stream_writer *w);

/* mesh_stream_discard() - leave nothing behind. NULL is fine. */
void mesh_stream_discard(mesh_stream_writer *w);

/* The reader, for mesh_input.c. */
extern const mesh_reader mesh_stream_reader;

#endif
