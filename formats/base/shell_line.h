/* shell_line.h - a command line, as printed, that can be typed or pasted into a shell.
 *
 * An incomplete line is of no use. Once a text or word does not fit, nothing more is added, and the
 * line is `full`. It always ends with a NUL.
 */
#ifndef FORMATS_BASE_SHELL_LINE_H
#define FORMATS_BASE_SHELL_LINE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct shell_line {
    char *text; /* the caller's buffer of `room` bytes */
    size_t room, length;
    bool full; /* something is missing: do not print it */
} shell_line;

/* shell_line_begin() - an empty line in the caller's text; room is at least 1. */
shell_line shell_line_begin(char *text, size_t room);

/* shell_line_put() - append text as it is. */
void shell_line_put(shell_line *l, const char *text);

/* shell_line_word() - append one word, in quotes unless it is plain. */
void shell_line_word(shell_line *l, const char *word);

/* shell_line_path() - append a file's name as one word that cannot be mistaken for an option. */
void shell_line_path(shell_line *l, const char *path);

#endif
