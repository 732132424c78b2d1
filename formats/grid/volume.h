/* volume.h - any known input as a stream of z slices.
 *
 * volume_open() recognises the format (NRRD, MHD/MHA, VTK, raw with a JSON beside it or dimensions
 * in its name), reads its header and checks it against the file's length before anything is
 * allocated for samples. volume_read() then hands out slices front to back. A reader holds no more
 * than the slices asked for and fixed buffers, gzip included. One thread per volume.
 *
 * Where the nodes lie: regular grids have everything in to_world. An axis with coordinates of its
 * own makes the grid rectilinear; its column of to_world scales and directs them, and both are
 * negated where they decrease (see grid_set_axis()). The others then count 0, 1, .., times a column
 * that is their spacing. Coordinates of a hint replace a spacing: their column is a unit vector. A
 * spacing hint sets the length of any column.
 */
#ifndef FORMATS_GRID_VOLUME_H
#define FORMATS_GRID_VOLUME_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/grid/sample_place.h"
#include "formats/grid/slice_source.h"
#include "formats/grid/volume_hints.h"
#include "formats/input/byte_stream.h"

typedef struct volume volume;

/* volume_open() - open a path, "-" for standard input, or a folder, of any format in volume.c's
 * table. hints may be NULL. ST_CORRUPT, ST_UNSUPPORTED (also for a file of no known format) or
 * ST_IO, naming file and line. */
CHECKED status volume_open(mem *m, const char *path, const volume_hints *hints, volume **out);

/* volume_is_folder() - returns whether a path is a folder, whose files may be the slices. */
bool volume_is_folder(const char *path);

/* volume_open_stream() - open a stream from which nothing was taken. It is taken over, and closed
 * in any case. */
CHECKED status volume_open_stream(mem *m, byte_stream *s, const volume_hints *hints, volume **out);

/* volume_open_slices() - open any source, which is taken over, and closed in any case. hints may be
 * NULL; all apply but those of raw samples. */
CHECKED status volume_open_slices(mem *m, slice_source *from, const volume_hints *hints,
                                  volume **out);
void volume_close(volume *v); /* NULL is fine */

const grid *volume_grid(const volume *v);

/* volume_format() - returns the format that it is read as: "NRRD", VOLUME_RAW_SAMPLES;
 * VOLUME_COLLECTION where all of several steps are meant. */
#define VOLUME_RAW_SAMPLES "raw samples"
#define VOLUME_COLLECTION  "a collection of VTK grids"
const char *volume_format(const volume *v);

/* volume_has_fields() - returns whether its format has several fields, steps or components, from
 * which the hints choose. */
bool volume_has_fields(const volume *v);

/* volume_fields() - tell all the fields that can be asked for, which one was taken, and their
 * numbers of steps. Call before volume_rest(). Where the format has no names, the one field is
 * called "". */
CHECKED status volume_fields(const volume *v, const slice_fields *to);

/* volume_importer() - returns "vdb" where leafcast-import-vdb reads it; NULL: this process does. */
const char *volume_importer(const volume *v);

/* volume_read() - read the next `count` z slices, in native byte order and of type
 * volume_grid()->type, into buffer (count * grid_slice_bytes()). ST_CORRUPT when the data ends
 * early, naming slice and byte. The caller must not ask for more slices than are left. */
CHECKED status volume_read(volume *v, uint32_t count, void *buffer);

/* volume_skips() - whether volume_skip() can move on by so many slices without reading them. It
 * must not be called else. */
bool volume_skips(const volume *v);
CHECKED status volume_skip(volume *v, uint32_t count);

/* volume_place() - where the samples lie in a file, as they are; call it before any is read.
 * Returns false if they are packed, in several files, in no file, or in another order. */
bool volume_place(const volume *v, sample_place *out);

/* volume_quiet() - returns whether large parts of v may be one value that its source marks. sample:
 * out, that value, of type volume_grid()->type. Then volume_read_tiles() reads as volume_read(),
 * with a map for each slice (slice_tiles.h): on entry it says what buffer holds, on return what has
 * been read. */
bool volume_quiet(const volume *v, uint8_t sample[SLICE_SAMPLE_MAX]);
CHECKED status volume_read_tiles(volume *v, uint32_t count, void *buffer, uint8_t *busy);

/* volume_rounding() - returns the largest rounding error of a sample so far, against the file's
 * number and slope; 0: samples are exact. */
double volume_rounding(const volume *v);

/* volume_finish() - check what is behind the last slice (a gzip checksum), and set *trailing to the
 * number of bytes that follow. If they must be read to be counted, more than VOLUME_TRAILING_MAX
 * are an error. trailing may be NULL. */
enum { VOLUME_TRAILING_MAX = 1 << 26 };
CHECKED status volume_finish(volume *v, uint64_t *trailing);

/* volume_next_step() - go on to the slices of the next step, which must exist. Call after
 * volume_finish(), if the hints had all_steps. Returns false if the step has to be opened anew,
 * with another hint. */
bool volume_next_step(volume *v);

/* volume_rest() - nothing more will be read: free what reading takes, end an importer. What is
 * known of the volume stays. May be called again. */
void volume_rest(volume *v);
bool volume_rests(const volume *v);

#endif
