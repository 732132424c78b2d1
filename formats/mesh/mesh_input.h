/* mesh_input.h - any known tetrahedral mesh as a stream of points, values and tets.
 *
 * mesh_input_open() recognises the format (mesh stream, TetGen, VTK, Gmsh) and reads its header;
 * mesh_input_read() then hands everything over, once, in chunks. A reader holds fixed buffers, a
 * map of vertex numbers if the format chooses them freely, and sums if cell data are averaged. All
 * of it counts in the budget. Hexes, wedges, pyramids and voxels become tets on the way (see
 * mesh_split.h). One thread per mesh.
 *
 * Vertex ids are 0-based and below MESH_POINTS_MAX. Positions are floats. Doubles are rounded once,
 * here; ST_CORRUPT if the result is not finite. Values may be NaN or inf: no data.
 */
#ifndef FORMATS_MESH_MESH_INPUT_H
#define FORMATS_MESH_MESH_INPUT_H

#include "formats/base/mem.h"
#include "formats/input/byte_stream.h"
#include "formats/input/input_trust.h"
#include "formats/mesh/mesh_sink.h"

typedef struct mesh_input mesh_input;

/* mesh_input_recognise() - finds out whether a stream holds a mesh, by its first bytes or the
 * suffix of its name. Takes nothing from the stream. */
CHECKED status mesh_input_recognise(byte_stream *s, bool *known);

/* mesh_input_open() - open a path, or "-" for standard input. hints may be NULL; its text must live
 * as long as the mesh. ST_CORRUPT, ST_UNSUPPORTED (also for a file of no known format) or ST_IO,
 * naming file and place. ST_USAGE when no array fits the hints, naming the arrays there are, and
 * when there is no such step.
 * mesh_input_open_stream() - open a mesh on a stream, which is taken over and closed in any case.
 */
CHECKED status mesh_input_open(mem *m, const char *path, const mesh_hints *hints, mesh_input **out);
CHECKED status mesh_input_open_stream(mem *m, byte_stream *s, const mesh_hints *hints,
                                      mesh_input **out);

/* mesh_input_recognise_by(), mesh_input_open_by() - the same by another table of readers
 * (mesh_reader.h), such as that of surfaces. */
struct mesh_readers;
CHECKED status mesh_input_recognise_by(const struct mesh_readers *by, byte_stream *s, bool *known);
CHECKED status mesh_input_open_by(mem *m, const struct mesh_readers *by, byte_stream *s,
                                  const mesh_hints *hints, mesh_input **out);

/* A mesh in memory. The caller owns it and must not change it while the mesh is open. */
typedef struct mesh_arrays {
    uint64_t points, tets;
    const float (*xyz)[3];
    const float *values; /* NULL: the mesh has no field */
    const uint32_t (*ids)[4];
    const char *field; /* name of the values; NULL: none */
} mesh_arrays;

/* mesh_input_open_arrays() - open a mesh in memory. name: the data set's name, or NULL. */
CHECKED status mesh_input_open_arrays(mem *m, const mesh_arrays *arrays, const char *name,
                                      mesh_input **out);
void mesh_input_close(mesh_input *x); /* NULL is fine */

/* mesh_input_name() - returns the name of the data set: from the hints, else the mesh's own, else
 * "". It is never the file's name: renaming the input does not change what is made of it. */
const char *mesh_input_name(const mesh_input *x);

/* mesh_input_format() - returns the format that it is read as: "TetGen". */
const char *mesh_input_format(const mesh_input *x);

/* mesh_input_share() - returns how much mesh_input_read() has handed over, 0 to 1, for a sink that
 * shows progress. Never less than before. */
double mesh_input_share(mesh_input *x);

/* mesh_input_fields() - give `take` the name and number of components of each array that can be
 * asked for, in the order of the file: arrays of the points, or of the cells if the hints say so. A
 * name may come again: each time step has one array. The first array is the default. Call
 * before mesh_input_read(). */
void mesh_input_fields(const mesh_input *x, mesh_field_taker *take, void *ctx);

/* mesh_input_counts() - returns whether the header says how many points and cells there are, and
 * how many. A reader of surfaces counts polygons and strips as the file has them. */
bool mesh_input_counts(const mesh_input *x, uint64_t *points, uint64_t *cells);

/* mesh_input_names_files() - returns whether files of its format name other files.
 * mesh_input_by_library() - returns whether an importer reads it, which asks what may be trusted.
 * mesh_input_may_have_steps() - returns whether files of its format may have several time steps. */
bool mesh_input_by_library(const mesh_input *x);
bool mesh_input_names_files(const mesh_input *x);
bool mesh_input_may_have_steps(const mesh_input *x);

/* mesh_input_file() - returns the path for messages: its file, or the first file of a collection's
 * step. */
const char *mesh_input_file(const mesh_input *x);

/* mesh_input_steps() - returns how many time steps its file has, 1 or more.
 * mesh_input_times() - returns the time of each step, as the file has it; NULL if it has none. */
uint32_t mesh_input_steps(const mesh_input *x);
const double *mesh_input_times(const mesh_input *x);

/* mesh_input_take() - choose these fields, each as mesh_hints.field, instead of the hints' one.
 * Call before mesh_input_read(). ST_USAGE as for mesh_input_open(). */
CHECKED status mesh_input_take(mesh_input *x, const char *const *names, uint32_t count);

/* mesh_input_read() - hand the whole mesh to the sink; call once. ST_CORRUPT names file, place and
 * what was expected. */
CHECKED status mesh_input_read(mesh_input *x, const mesh_sink *sink, mesh_report *report);

#endif
