/* inflate_stream.h - the decompressed bytes of gzip (any number of members) or zlib data, in order,
 * through fixed buffers.
 *
 * Each member's checksum and length is checked where it ends.
 */
#ifndef FORMATS_INPUT_INFLATE_STREAM_H
#define FORMATS_INPUT_INFLATE_STREAM_H

#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

typedef struct inflate_stream inflate_stream;

/* No deflate stream gives more bytes than this for each of its own: a bound on what a file can
 * hold, before reading it. */
enum { INFLATE_STREAM_RATIO = 1032 };

/* inflate_stream_open() - decompress what comes next in `from`, which must outlive the stream and
 * stays the caller's. */
CHECKED status inflate_stream_open(mem *m, byte_stream *from, inflate_stream **out);
void inflate_stream_close(inflate_stream *s); /* NULL is fine */

/* inflate_stream_read() - size bytes; *got is smaller only at the end of the last member.
 * ST_CORRUPT when the data is damaged or ends inside a member. Bytes behind the last member stay in
 * `from`. */
CHECKED status inflate_stream_read(inflate_stream *s, void *buffer, size_t size, size_t *got);

#endif
