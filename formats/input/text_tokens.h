/* text_tokens.h - the words of a text file, one by one, with the line they stand on.
 *
 * Nothing is taken from the stream beyond the word asked for, so binary data may follow a line. For
 * formats where lines matter (columns may be missing) and for those where they do not, and for
 * numbers in the middle of a file.
 */
#ifndef FORMATS_INPUT_TEXT_TOKENS_H
#define FORMATS_INPUT_TEXT_TOKENS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

enum { TEXT_TOKEN_MAX = 255 };

/* Start with {.s = stream, .line = 1}; without a line, messages name the byte. */
typedef struct text_tokens {
    byte_stream *s;
    uint64_t line; /* on which the stream stands, from 1; 0: not known */
    char comment;  /* what begins a comment up to the line's end; 0: nothing does */
    char stop;     /* words end before it, and none follow: '<'; 0: there is no such */
    bool commas;   /* commas and semicolons are blanks */
    char token[TEXT_TOKEN_MAX + 1]; /* the last one; "" when there was none */
} text_tokens;

/* text_tokens_next() - the next word into token, on whatever line; "" at the end of the stream, or
 * where `stop` comes next. ST_CORRUPT for one above TEXT_TOKEN_MAX bytes or with a NUL in it. */
CHECKED status text_tokens_next(text_tokens *t);

/* text_tokens_skip() - pass over count words of any length; *got is smaller at the end, or before a
 * word that starts with a letter no number starts with, which stays. Not for text with comments. */
CHECKED status text_tokens_skip(text_tokens *t, uint64_t count, uint64_t *got);

/* text_tokens_more() - whether another word stands on this line. */
CHECKED status text_tokens_more(text_tokens *t, bool *more);

/* text_tokens_rest() - the rest of this line, without blanks around it, at most size - 1 bytes
 * (ST_CORRUPT above it); the stream then stands on the next one. */
CHECKED status text_tokens_rest(text_tokens *t, char *text, size_t size);

/* text_tokens_end_line() - the line ends here, or ST_CORRUPT; the stream then stands on the next
 * one, in front of its first byte. */
CHECKED status text_tokens_end_line(text_tokens *t);

/* The next word as a number; `what` says what is expected ("x of point 3" is for the reader to
 * tell). The second: a whole number in lo .. hi. The numbers of words: text_number.h. */
CHECKED status text_tokens_double(text_tokens *t, const char *what, double *out);
CHECKED status text_tokens_int(text_tokens *t, const char *what, int64_t lo, int64_t hi,
                               int64_t *out);

/* The next word of this line as a number. The first: ST_CORRUPT where the line ends before it; the
 * second: *out is then `absent`. */
CHECKED status text_tokens_double_here(text_tokens *t, const char *what, double *out);
CHECKED status text_tokens_int_here(text_tokens *t, const char *what, int64_t lo, int64_t hi,
                                    int64_t absent, int64_t *out);

/* text_tokens_fault() - ST_CORRUPT: file, line, the last word, and what was expected in its place.
 */
status text_tokens_fault(const text_tokens *t, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

#endif
