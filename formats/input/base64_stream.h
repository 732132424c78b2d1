/* base64_stream.h - the bytes behind base64 text, in order.
 *
 * White space is skipped. More groups may follow one that ends in '=': parts that were encoded one
 * by one read as one. The text ends at a '<' or where the stream ends.
 */
#ifndef FORMATS_INPUT_BASE64_STREAM_H
#define FORMATS_INPUT_BASE64_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

/* Start with {.from = stream}. The stream must outlive it. The other fields are private. */
typedef struct base64_stream {
    byte_stream *from;
    uint32_t bits; /* bits of the group that is being read */
    int letters;   /* letters of that group, '=' included */
    int padding;   /* '=' among them */
    uint8_t held[3];
    int begin, end; /* range of held[] that is decoded but not handed out */
    bool ended;
} base64_stream;

/* base64_stream_read() - read size bytes; *got is smaller only at the end of the text. ST_CORRUPT
 * if the text is not base64, or ends inside a group. */
CHECKED status base64_stream_read(base64_stream *s, void *buffer, size_t size, size_t *got);

#endif
