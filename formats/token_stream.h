/* token_stream.h - words of a text, split by blanks and line ends, and the numbers they are. */
#ifndef FORMATS_TOKEN_STREAM_H
#define FORMATS_TOKEN_STREAM_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/status.h"
#include "formats/byte_stream.h"

enum { TOKEN_STREAM_MAX = 64 }; /* bytes of a word, NUL included */

/* token_stream_next() - the next word; "" at the end of the stream, or where a '<' follows, which
 * stays. ST_CORRUPT for a longer one. */
CHECKED status token_stream_next(byte_stream *s, char token[TOKEN_STREAM_MAX]);

/* token_stream_skip() - pass over count words of any length; *got is smaller at the end, or before
 * a word that starts with a letter no number starts with, which stays. */
CHECKED status token_stream_skip(byte_stream *s, uint64_t count, uint64_t *got);

/* token_stream_double() - the number that a word is, correctly rounded, also nan and inf; false
 * when it is none. */
bool token_stream_double(const char *token, double *out);

/* token_stream_whole() - the whole number that a word is; UINT64_MAX for a negative or larger one;
 * false when it is none. */
bool token_stream_whole(const char *token, uint64_t *out);

#endif
