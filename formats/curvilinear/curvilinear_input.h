/* curvilinear_input.h - any known curvilinear grid as planes of nodes, in any order.
 *
 * curvilinear_input_open() recognises the format (PLOT3D, VTK, CGNS, netCDF, a stream) and reads
 * its head; curvilinear_input_source() then hands over planes. Readers hold buffers of fixed size,
 * or a plane. Only regular files, as they are stored, are read where they lie; a stream from
 * elsewhere, and what an importer writes, goes into a file without a name first. One thread per
 * grid.
 *
 * Positions are floats. Doubles are rounded once, to nearest; ST_CORRUPT naming the node if the
 * result is not finite. Values may be NaN or inf: no data.
 */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_INPUT_H
#define FORMATS_CURVILINEAR_CURVILINEAR_INPUT_H

#include "formats/base/mem.h"
#include "formats/curvilinear/curvilinear_hints.h"
#include "formats/curvilinear/curvilinear_source.h"
#include "formats/input/byte_stream.h"

typedef struct curvilinear_input curvilinear_input;

/* curvilinear_input_recognise() - finds out whether a stream holds a curvilinear grid: a regular
 * file, by its first bytes and its size. Takes nothing from the stream. */
CHECKED status curvilinear_input_recognise(byte_stream *s, bool *known);

/* curvilinear_input_is_asked() - returns whether the hints make any file a curvilinear grid: they
 * say how PLOT3D is written, or name what goes with it. */
bool curvilinear_input_is_asked(const curvilinear_hints *hints);

/* curvilinear_input_open() - open a path. hints may be NULL; its text must live as long as the
 * grid. ST_CORRUPT, ST_UNSUPPORTED (also for a file of no known format) or ST_IO, naming file and
 * place. ST_USAGE when no field fits the hints, naming the fields there are, and when only a hint
 * can tell how the file is written. curvilinear_input_open_stream() - open a grid on a stream,
 * which is taken over and closed in any case. */
CHECKED status curvilinear_input_open(mem *m, const char *path, const curvilinear_hints *hints,
                                      curvilinear_input **out);
CHECKED status curvilinear_input_open_stream(mem *m, byte_stream *s, const curvilinear_hints *hints,
                                             curvilinear_input **out);
void curvilinear_input_close(curvilinear_input *x); /* NULL is fine */

/* curvilinear_input_source() - returns the grid as planes, with the fields that are taken: the
 * hints' one, else the first. A grid without any field tells one, of zeros. Valid until the next
 * take, or the close. */
const curvilinear_source *curvilinear_input_source(const curvilinear_input *x);

/* curvilinear_input_format() - returns the format that it is read as: "PLOT3D".
 * curvilinear_input_name() - returns the name of the data set: from the hints, else the grid's own,
 * else "".
 * curvilinear_input_file() - returns the path for messages. */
const char *curvilinear_input_format(const curvilinear_input *x);
const char *curvilinear_input_name(const curvilinear_input *x);
const char *curvilinear_input_file(const curvilinear_input *x);

/* curvilinear_input_fields() - returns the number of fields that can be asked for.
 * curvilinear_input_field() - returns the name of one of them, as valid UTF-8, and its number of
 * components. The first is the default. The name is valid until the next call. */
uint32_t curvilinear_input_fields(const curvilinear_input *x);
const char *curvilinear_input_field(curvilinear_input *x, uint32_t field, uint32_t *components);

/* curvilinear_input_take() - choose these fields, in order, each as curvilinear_hints.field.
 * ST_USAGE as for curvilinear_input_open(). curvilinear_input_taken() - returns the name of the
 * field that was taken as number `field`, "": the grid has none; *component: 0: its magnitude, or
 * it has but one. Valid until the next call. */
CHECKED status curvilinear_input_take(curvilinear_input *x, const char *const *names,
                                      uint32_t count);
const char *curvilinear_input_taken(curvilinear_input *x, uint32_t field, uint32_t *component);

/* curvilinear_input_names_files() - returns whether files of its format name other files.
 * curvilinear_input_has_library() - returns whether a library reads it, which may find other files
 * and parts that are missing.
 * curvilinear_input_is_placed() - returns whether its nodes were placed as hints.to says.
 * curvilinear_input_may_have_steps() - returns whether inputs of its format may have several time
 * steps. curvilinear_input_steps() - returns how many it has, 1 or more; *times: the time of each,
 * in no order; NULL: not known.
 * curvilinear_input_time_unit() - returns the unit of these times; "": unknown.
 * curvilinear_input_still() - returns whether it says that nodes are the same at all steps. */
bool curvilinear_input_names_files(const curvilinear_input *x);
bool curvilinear_input_has_library(const curvilinear_input *x);
bool curvilinear_input_is_placed(const curvilinear_input *x);
bool curvilinear_input_may_have_steps(const curvilinear_input *x);
uint32_t curvilinear_input_steps(const curvilinear_input *x, const double **times);
const char *curvilinear_input_time_unit(const curvilinear_input *x);
bool curvilinear_input_still(const curvilinear_input *x);

/* curvilinear_input_seek() - go to another step, as if it had been opened with hints of that step:
 * nodes and fields may be others. Errors as of curvilinear_input_open(); then it can only be
 * closed. */
CHECKED status curvilinear_input_seek(curvilinear_input *x, uint32_t step);

/* curvilinear_input_conditions() - returns what is said of the flow in the first zone: Mach number,
 * angle of attack in degrees, Reynolds number, time; NULL: nothing. */
const double *curvilinear_input_conditions(const curvilinear_input *x);

#endif
