/* base64_stream.h - the bytes behind base64 text, in order.
 *
 * White space is passed over. A group that ends in '=' may be followed by more: parts that were
 * encoded one by one read as one. The text ends at a '<' or where the stream ends.
 */
#ifndef FORMATS_INPUT_BASE64_STREAM_H
#define FORMATS_INPUT_BASE64_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

/* Start with {.from = stream}, which must outlive it. The rest is its own. */
typedef struct base64_stream {
    byte_stream *from;
    uint32_t bits; /* of the group that is being read */
    int letters;   /* of that group, '=' included */
    int padding;   /* '=' among them */
    uint8_t held[3];
    int begin, end; /* of held[]: decoded, not handed out */
    bool ended;
} base64_stream;

/* base64_stream_read() - size bytes; *got is smaller only at the end of the text. ST_CORRUPT for
 * what is no base64, or ends inside a group. */
CHECKED status base64_stream_read(base64_stream *s, void *buffer, size_t size, size_t *got);

#endif
