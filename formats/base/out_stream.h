/* out_stream.h - an output written front to back: a file that appears when it is complete, or
 * standard output; packed by gzip if asked for.
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

/* out_stream_create() - begin the file path ("-": standard output), as out_file_create() with
 * force. gzip: what is written is packed; the same bytes for the same bytes, without a time. */
CHECKED status out_stream_create(mem *m, const char *path, bool force, bool gzip, out_stream **out);

/* out_stream_write() - the next bytes. ST_NOSPACE, ST_IO, ST_STOPPED. out_stream_text() - a string.
 * out_stream_samples() - count samples in native byte order, as little endian. */
CHECKED status out_stream_write(out_stream *s, const void *data, size_t size);
CHECKED status out_stream_text(out_stream *s, const char *text);
CHECKED status out_stream_samples(out_stream *s, sample_type type, const void *samples,
                                  size_t count);

/* out_stream_is_file() - whether it is a file that is not packed: then out_stream_patch() puts
 * bytes where others were written before. Errors as of out_stream_write(). */
bool out_stream_is_file(const out_stream *s);
CHECKED status out_stream_patch(out_stream *s, uint64_t offset, const void *data, size_t size);

/* out_stream_commit() - that was all: give the file its name. Consumes s in any case. */
CHECKED status out_stream_commit(out_stream *s);

/* out_stream_discard() - leave nothing behind. NULL is fine. */
void out_stream_discard(out_stream *s);

#endif
