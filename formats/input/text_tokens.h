/* text_tokens.h - the words of a text file, one by one, with their lines.
 *
 * Nothing is taken from the stream beyond the word asked for, so binary data may follow a line.
 * Serves formats where lines matter (columns may be missing), formats where they do not, and
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

/* Start with {.s = stream, .line = 1}. With line 0, messages name the byte instead. */
typedef struct text_tokens {
    byte_stream *s;
    uint64_t line;                  /* line on which the stream stands, from 1; 0: unknown */
    char comment;                   /* starts a comment up to the line's end; 0: nothing does */
    char stop;                      /* ends the words: none follow it, as '<'; 0: nothing does */
    bool commas;                    /* commas and semicolons are blanks */
    char token[TEXT_TOKEN_MAX + 1]; /* the last word; "" when there was none */
} text_tokens;

/* text_tokens_next() - read the next word into token, on whatever line; "" at the end of the
 * stream, or where `stop` comes next. ST_CORRUPT for a word above TEXT_TOKEN_MAX bytes or with a
 * NUL in it. */
CHECKED status text_tokens_next(text_tokens *t);

/* text_tokens_skip() - skip up to `count` words of any length; *got: how many were skipped. Stops
 * early at the end of the stream, at `stop`, and before a word whose first letter cannot begin a
 * number ("nan" and "inf" are numbers), which can still be read. t->comment must be 0. */
CHECKED status text_tokens_skip(text_tokens *t, uint64_t count, uint64_t *got);

/* text_tokens_more() - finds out whether another word stands on this line. */
CHECKED status text_tokens_more(text_tokens *t, bool *more);

/* text_tokens_rest() - read the rest of this line, without blanks around it: at most size - 1
 * bytes, else ST_CORRUPT. The stream then stands on the next line. */
CHECKED status text_tokens_rest(text_tokens *t, char *text, size_t size);

/* text_tokens_end_line() - check that the line ends here, else ST_CORRUPT. The stream then stands
 * in front of the next line's first byte. */
CHECKED status text_tokens_end_line(text_tokens *t);

/* Read the next word as a double, or as a whole number in lo .. hi; text_number.h says which words
 * are numbers. what: what is expected, for the message. The caller makes texts such as "x of point
 * 3". */
CHECKED status text_tokens_double(text_tokens *t, const char *what, double *out);
CHECKED status text_tokens_int(text_tokens *t, const char *what, int64_t lo, int64_t hi,
                               int64_t *out);

/* Read the next word of this line as a number. Where the line ends before it, the first returns
 * ST_CORRUPT, the second sets *out to `absent`. */
CHECKED status text_tokens_double_here(text_tokens *t, const char *what, double *out);
CHECKED status text_tokens_int_here(text_tokens *t, const char *what, int64_t lo, int64_t hi,
                                    int64_t absent, int64_t *out);

/* text_tokens_fault() - return ST_CORRUPT, naming file, line, the last word, and what was expected
 * in its place. */
status text_tokens_fault(const text_tokens *t, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

#endif
