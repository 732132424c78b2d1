/* mesh_input.h - any known tetrahedral mesh as a stream of points, values and tets.
 *
 * mesh_input_open() recognises the format (mesh stream, TetGen, VTK, Gmsh) and reads its header;
 * mesh_input_read() then hands everything over, once, in chunks. A reader holds fixed buffers, plus
 * a map of vertex numbers where the format chooses them freely, plus sums when cell data are
 * averaged; all of it counted in the budget. Hexes, wedges, pyramids and voxels become tets on the
 * way (see mesh_split.h). One thread per mesh.
 *
 * Vertex ids are 0-based and below MESH_POINTS_MAX. Positions are floats; doubles are rounded once,
 * here, and one that is not finite then is ST_CORRUPT. Values may be NaN or inf: no data.
 */
#ifndef FORMATS_MESH_MESH_INPUT_H
#define FORMATS_MESH_MESH_INPUT_H

#include "formats/base/mem.h"
#include "formats/input/byte_stream.h"
#include "formats/input/input_trust.h"
#include "formats/mesh/mesh_sink.h"

typedef struct mesh_input mesh_input;

/* mesh_input_recognise() - whether a stream, of which nothing is taken, is of a mesh: by its first
 * bytes, or the suffix of its name. */
CHECKED status mesh_input_recognise(byte_stream *s, bool *known);

/* mesh_input_open() - path, or "-" for a mesh on standard input. hints may be NULL; its text must
 * live as long as the mesh. ST_CORRUPT, ST_UNSUPPORTED (also for a file of no known format) or
 * ST_IO, naming file and place; ST_USAGE when there is no array as the hints want, naming those
 * there are, and when there is no such step. mesh_input_open_stream() - of a stream, which is taken
 * over, and closed in any case.
 */
CHECKED status mesh_input_open(mem *m, const char *path, const mesh_hints *hints, mesh_input **out);
CHECKED status mesh_input_open_stream(mem *m, byte_stream *s, const mesh_hints *hints,
                                      mesh_input **out);

/* A mesh in memory: the caller's, and as it is as long as the mesh is open. */
typedef struct mesh_arrays {
    uint64_t points, tets;
    const float (*xyz)[3];
    const float *values; /* NULL: there is no field */
    const uint32_t (*ids)[4];
    const char *field; /* name of the values; NULL: none */
} mesh_arrays;

/* mesh_input_open_arrays() - name: of the data set, or NULL. */
CHECKED status mesh_input_open_arrays(mem *m, const mesh_arrays *arrays, const char *name,
                                      mesh_input **out);
void mesh_input_close(mesh_input *x); /* NULL is fine */

/* mesh_input_name() - of the data set: the hints', or its own, or "". Never the file's: the same
 * mesh is the same data set. */
const char *mesh_input_name(const mesh_input *x);

/* mesh_input_format() - what it was read as: "TetGen". */
const char *mesh_input_format(const mesh_input *x);

/* mesh_input_share() - how much of it mesh_input_read() has handed over, 0 to 1; for a sink that
 * wants to tell. Never less than before. */
double mesh_input_share(mesh_input *x);

/* mesh_input_fields() - give `take` the name of each array that could have been asked for, and how
 * many numbers it has a point, in the order of the file: of the points, or of the cells where the
 * hints say so. A name may come again: of several steps the first is taken.
 * The first is the one that is taken when none is asked for. Before mesh_input_read(). */
void mesh_input_fields(const mesh_input *x, mesh_field_taker *take, void *ctx);

/* mesh_input_names_files() - whether its format is one whose files name others, and may have steps.
 */
bool mesh_input_names_files(const mesh_input *x);

/* mesh_input_file() - for messages: its file, or of a collection the first one of the step. */
const char *mesh_input_file(const mesh_input *x);

/* mesh_input_steps() - how many time steps its file has, 1 or more; mesh_input_times() - of each,
 * ascending; NULL: it tells none. */
uint32_t mesh_input_steps(const mesh_input *x);
const double *mesh_input_times(const mesh_input *x);

/* mesh_input_take() - take these fields, each as mesh_hints.field, in place of the hints' one;
 * before mesh_input_read(). ST_USAGE as mesh_input_open(). */
CHECKED status mesh_input_take(mesh_input *x, const char *const *names, uint32_t count);

/* mesh_input_read() - hand it all over; once. ST_CORRUPT names file, place and what was expected.
 */
CHECKED status mesh_input_read(mesh_input *x, const mesh_sink *sink, mesh_report *report);

#endif
