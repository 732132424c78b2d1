/* nrrd_writer.h - a volume written as NRRD, sample by sample: attached header, raw, little endian.
 *
 * The same grid and samples give the same bytes on every machine. Space directions and origin hold
 * the placement. The key/value pairs that nrrd.h reads hold rectilinear axes, how much is absent,
 * a note, and what an importer tells.
 */
#ifndef FORMATS_GRID_NRRD_WRITER_H
#define FORMATS_GRID_NRRD_WRITER_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/out_stream.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"

/* nrrd_write_header() - write all that stands before the samples of a grid. Its name must have no
 * control characters. */
CHECKED status nrrd_write_header(out_stream *out, const grid *g);

typedef struct nrrd_writer nrrd_writer;

/* nrrd_writer_create() - begin the file `path` ("-": standard output) and write its header. force:
 * see out_file_create(). */
CHECKED status nrrd_writer_create(mem *m, const char *path, bool force, const grid *g,
                                  nrrd_writer **out);

/* nrrd_writer_append() - write the next count samples of type g->type in native byte order, x
 * fastest. */
CHECKED status nrrd_writer_append(nrrd_writer *w, const void *samples, size_t count);

/* nrrd_writer_commit() - give the file its name. All samples must have been written (an assert).
 * Consumes w in any case. */
CHECKED status nrrd_writer_commit(nrrd_writer *w);

/* nrrd_writer_discard() - leave nothing behind. NULL is fine. */
void nrrd_writer_discard(nrrd_writer *w);

#endif
