/* text.h - text from outside, made fit to be kept and to be printed.
 *
 * Names come from file names, headers and command lines, and may hold any bytes. Where a name
 * enters, text_name() makes it valid UTF-8 without control characters, so that JSON can hold it and
 * a terminal obeys no codes in it. Paths must stay as they are, and messages may quote anything:
 * text_printable() escapes them where they are printed. Pure; any thread.
 */
#ifndef FORMATS_BASE_TEXT_H
#define FORMATS_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* text_name() - copy `from` to `to` as valid UTF-8, cut to less than room bytes between two
 * characters. Each control character, and each byte that is part of no character, becomes U+FFFD.
 * `from` may be `to`. room: up to TEXT_NAME_MAX. */
enum { TEXT_NAME_MAX = 1024 };
void text_name(char *to, size_t room, const char *from);

/* text_stem() - where a file's own name begins in its path, behind the folder; *length: its length
 * without the last suffix. A dot at its beginning starts no suffix. */
const char *text_stem(const char *path, size_t *length);

/* text_file_name() - the stem of a path for people, cleaned by text_name(). room as there. */
void text_file_name(char *to, size_t room, const char *path);

/* text_ends_in() - whether a path ends in a suffix (".vtu"), in upper or lower case. */
bool text_ends_in(const char *path, const char *suffix);

/* text_same_name() - whether text_name() makes the same name of both texts. */
bool text_same_name(const char *a, const char *b, size_t room);

/* text_add() - append to a text like printf(). room: of the whole text; it must be enough. Not for
 * text from outside. */
void text_add(char *to, size_t room, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

/* text_printable() - copy a text for people, in one line. Control characters and bytes that are not
 * UTF-8 become \n, \t or \xNN; all else stays. Cut to less than room bytes between two characters.
 * Returns to, which must not be `from`. A signal handler may call it. */
char *text_printable(char *to, size_t room, const char *from);

#endif
