/* byte_stream.h - bytes in order, from a regular file, a pipe, standard input or another source,
 * through a fixed buffer.
 *
 * A packed file (see unpack_stream.h) is unpacked on the way, so that readers of formats need not
 * know. One thread per stream.
 */
#ifndef FORMATS_INPUT_BYTE_STREAM_H
#define FORMATS_INPUT_BYTE_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct byte_stream byte_stream;

enum { BYTE_STREAM_BUFFER = 1 << 16 };

/* byte_stream_open() - open a path, or "-" for standard input (which is not closed). Waits for a
 * named pipe (see wait.h); folders, devices and sockets are refused. A file that begins as packed
 * files do is unpacked if its name says so or if it has no name: raw samples might begin so, too.
 * byte_stream_open_stored() - open the bytes as they are stored. */
CHECKED status byte_stream_open(mem *m, const char *path, byte_stream **out);
CHECKED status byte_stream_open_stored(mem *m, const char *path, byte_stream **out);

/* Another source of bytes. */
typedef struct byte_source {
    /* Read at least one byte, at most size bytes; *got = 0 is the end. */
    status (*read)(void *ctx, void *to, size_t size, size_t *got);
    void (*close)(void *ctx);
    void *ctx;
} byte_source;

/* byte_stream_open_source() - open a source, which is taken over and closed in any case. name: for
 * messages; also what byte_stream_path() returns. */
CHECKED status byte_stream_open_source(mem *m, const char *name, const byte_source *from,
                                       byte_stream **out);
void byte_stream_close(byte_stream *s); /* NULL is fine */

/* byte_stream_name() - returns the name for messages: the path, or "standard input". */
const char *byte_stream_name(const byte_stream *s);

/* byte_stream_path() - returns the path as it was opened, or "-".
 * byte_stream_kind() - returns the path by whose end a format is recognised: without the suffix of
 * packed files. */
const char *byte_stream_path(const byte_stream *s);
const char *byte_stream_kind(const byte_stream *s);

/* byte_stream_drop_suffix() - cut the last suffix, which must be there, from the kind.
 * byte_stream_is_pipe() - returns whether it reads standard input or a named pipe.
 * byte_stream_is_file() - returns whether it reads a regular file as it is stored. */
void byte_stream_drop_suffix(byte_stream *s);
bool byte_stream_is_pipe(const byte_stream *s);
bool byte_stream_is_file(const byte_stream *s);

/* byte_stream_position() - returns the bytes taken so far.
 * byte_stream_left() - returns the bytes still to come; UINT64_MAX if unknown, as for pipes and
 * packed files. */
uint64_t byte_stream_position(const byte_stream *s);
uint64_t byte_stream_left(const byte_stream *s);

/* byte_stream_peek() - look at the bytes that come next: at least `want` (up to
 * BYTE_STREAM_BUFFER), fewer only at the end, 0 behind it. They are valid until the next call.
 * byte_stream_take() - move on by size of them. */
CHECKED status byte_stream_peek(byte_stream *s, size_t want, const uint8_t **data, size_t *size);
void byte_stream_take(byte_stream *s, size_t size);

/* byte_stream_read() - read size bytes into a buffer; *got is smaller only at the end. */
CHECKED status byte_stream_read(byte_stream *s, void *buffer, size_t size, size_t *got);

/* byte_stream_skip() - move on by size bytes; ST_CORRUPT when the end comes first. Seeks in files,
 * reads from pipes. */
CHECKED status byte_stream_skip(byte_stream *s, uint64_t size);

/* A line of text in a buffer that grows; start with {.m = budget}, end with
 * byte_stream_line_release(). */
typedef struct text_line {
    mem *m;
    char *text; /* without line feed, carriage return and the blanks before them; NUL-terminated */
    size_t length, room;
} text_line;

enum { TEXT_LINE_MAX = 1 << 26 };

/* byte_stream_line() - read the next line; *got is false at the end of the stream. The last line
 * may lack its line feed. ST_CORRUPT for a line above TEXT_LINE_MAX bytes or with a NUL in it: the
 * stream is no text. */
CHECKED status byte_stream_line(byte_stream *s, text_line *line, bool *got);
void byte_stream_line_release(text_line *line);

#endif
