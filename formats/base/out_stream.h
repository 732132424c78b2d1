/* out_stream.h - an output written front to back: a file that appears when it is complete, or
 * standard output; compressed by gzip if asked for.
 */
#ifndef FORMATS_BASE_OUT_STREAM_H
#define FORMATS_BASE_OUT_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/sample.h"
#include "formats/base/status.h"

typedef struct out_stream out_stream;

/* out_stream_create() - begin the file path ("-": standard output); errors as of out_file_create().
 * gzip: compress. The same input gives the same bytes: no time is stored. */
CHECKED status out_stream_create(mem *m, const char *path, bool force, bool gzip, out_stream **out);

/* out_stream_write() - write the next bytes. ST_NOSPACE, ST_IO, ST_STOPPED.
 * out_stream_text() - write a string.
 * out_stream_samples() - write count samples, given in native byte order, as little endian. */
CHECKED status out_stream_write(out_stream *s, const void *data, size_t size);
CHECKED status out_stream_text(out_stream *s, const char *text);
CHECKED status out_stream_samples(out_stream *s, sample_type type, const void *samples,
                                  size_t count);

/* out_stream_is_file() - whether it is an uncompressed file. Only then may out_stream_patch() be
 * called.
 * out_stream_patch() - overwrite bytes that were written before. Errors as of
 * out_stream_write(). */
bool out_stream_is_file(const out_stream *s);
CHECKED status out_stream_patch(out_stream *s, uint64_t offset, const void *data, size_t size);

/* out_stream_commit() - finish the output, and give the file its name. Consumes s in any case. */
CHECKED status out_stream_commit(out_stream *s);

/* out_stream_discard() - leave nothing behind. NULL is fine. */
void out_stream_discard(out_stream *s);

#endif
