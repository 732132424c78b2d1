/* text_stream.h - samples written as decimal numbers, split by blanks, line ends or commas. */
#ifndef FORMATS_INPUT_TEXT_STREAM_H
#define FORMATS_INPUT_TEXT_STREAM_H

#include <stddef.h>

#include "formats/base/sample.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

/* text_stream_read() - read count samples of a type, in native byte order; *got is smaller only at
 * the end. ST_CORRUPT for a word that is no number of this type. There is no text of f16. */
CHECKED status text_stream_read(byte_stream *s, sample_type type, void *samples, size_t count,
                                size_t *got);

#endif
