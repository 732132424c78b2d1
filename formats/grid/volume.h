/* volume.h - any known input as a stream of z slices.
 *
 * volume_open() recognises the format (NRRD, MHD/MHA, raw with a JSON beside it or dimensions in
 * its name), reads its header and checks it against the file's length before anything is allocated
 * for samples. volume_read() then hands out slices front to back. No reader holds more than it was
 * asked for, plus fixed buffers, gzip included. One thread per volume.
 *
 * Where the nodes lie: regular grids have everything in to_world. An axis with coordinates of its
 * own makes the grid rectilinear; its column of to_world is then a unit vector (coordinates replace
 * that axis' spacing), negated, like the coordinates, when they decrease (see grid_set_axis()). A
 * spacing hint scales that vector, and so the coordinates.
 */
#ifndef FORMATS_GRID_VOLUME_H
#define FORMATS_GRID_VOLUME_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/input/byte_stream.h"

typedef struct volume volume;

/* What the command line says about inputs that do not say it themselves. Zero/NULL = not given. */
typedef struct volume_hints {
    uint32_t dims[3]; /* raw: samples per axis */
    sample_type type; /* raw: sample type */
    bool big_endian;  /* raw */
    uint64_t skip;    /* raw: header bytes to skip */
    double
        spacing[3];   /* overrides the input's spacing, scales an axis' coordinates; may be negative
                       */
    double origin[3]; /* world position of node (0, 0, 0) */
    bool has_origin;
    bool has_missing; /* samples equal to `missing` are read as NaN, no data; integers are then
                         handed out as f32, and one that f32 cannot hold is ST_UNSUPPORTED */
    double missing;
    const char *axis_file[3]; /* rectilinear: a text file with one coordinate a line (or split by
                                 white space), per axis */
    const char *name;         /* of the data set, in place of the input's own */
} volume_hints;

/* volume_open() - path, or "-" for standard input: NRRD, MetaImage, or raw samples whose sizes and
 * type the hints give. hints may be NULL. ST_CORRUPT,
 * ST_UNSUPPORTED (also for a file of no known format) or ST_IO, naming file and line. */
CHECKED status volume_open(mem *m, const char *path, const volume_hints *hints, volume **out);

/* volume_open_stream() - the same of a stream of which nothing was taken; it is taken over, and
 * closed in any case. */
CHECKED status volume_open_stream(mem *m, byte_stream *s, const volume_hints *hints, volume **out);

/* Samples that come from elsewhere than a file. */
typedef struct volume_source {
    /* Slice z, grid_slice_bytes() of them: called for 0, 1, .. in order, by the thread that reads.
     * What is not ST_OK ends the reading, and is what volume_read() returns. */
    status (*read)(void *ctx, uint32_t z, void *slice);
    void *ctx;
} volume_source;

/* volume_open_source() - of such a grid, which passes grid_check(); it and its axes are taken over
 * (m: theirs, too), and released in any case. Of hints, which may be NULL, the missing value and
 * the name count. */
CHECKED status volume_open_source(mem *m, grid *g, const volume_source *from,
                                  const volume_hints *hints, volume **out);
void volume_close(volume *v); /* NULL is fine */

const grid *volume_grid(const volume *v);

/* volume_format() - what it was read as: "NRRD", "MetaImage", VOLUME_RAW_SAMPLES, or "slices" of a
 * volume_source. */
#define VOLUME_RAW_SAMPLES "raw samples"
const char *volume_format(const volume *v);

/* volume_read() - the next `count` z slices, native byte order, type volume_grid()->type, into
 * buffer (count * grid_slice_bytes()). ST_CORRUPT when the data ends early, naming slice and byte.
 * The caller does not ask for more slices than are left. */
CHECKED status volume_read(volume *v, uint32_t count, void *buffer);

/* volume_finish() - after the last slice: check what is behind it (a gzip checksum) and count the
 * bytes that follow, which are allowed up to VOLUME_TRAILING_MAX where they must be read to be
 * counted. trailing may be NULL. */
enum { VOLUME_TRAILING_MAX = 1 << 26 };
CHECKED status volume_finish(volume *v, uint64_t *trailing);

#endif
