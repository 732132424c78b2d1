/* text.h - text from outside, made fit to be kept and to be printed.
 *
 * Names come from file names, headers and command lines, and may hold any bytes. At the border,
 * where one enters, text_name() makes it valid UTF-8 without control characters, so that JSON can
 * hold it and a terminal is not told what to do. Paths must stay as they are, and messages may
 * quote anything: text_printable() escapes them where they are printed. Pure; any thread.
 */
#ifndef FORMATS_BASE_TEXT_H
#define FORMATS_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* text_name() - `from` as valid UTF-8 into `to`, cut to less than room bytes between two
 * characters. Each byte that belongs to none, and each control character, becomes U+FFFD. `from`
 * may be `to`. TEXT_NAME_MAX: the most room there may be. */
enum { TEXT_NAME_MAX = 1024 };
void text_name(char *to, size_t room, const char *from);

/* text_stem() - a file's own name: where it begins in its path, behind the folder, and its length
 * without the last suffix. A dot that it begins with begins no suffix. */
const char *text_stem(const char *path, size_t *length);

/* text_file_name() - the same for people, as text_name() makes it. room as there. */
void text_file_name(char *to, size_t room, const char *path);

/* text_ends_in() - whether a path ends like this (".vtu"), in any case of letters. */
bool text_ends_in(const char *path, const char *suffix);

/* text_same_name() - whether two texts are the same name, cut to less than room bytes. */
bool text_same_name(const char *a, const char *b, size_t room);

/* text_add() - append to a text, as printf() has it; room: of all of it, which must be enough. Not
 * for texts from outside. */
void text_add(char *to, size_t room, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

/* text_printable() - for people, in one line: control characters and bytes that are no UTF-8 become
 * \n, \t or \xNN; all else stays. Cut to less than room bytes between two characters. Returns to,
 * which must not be `from`. A signal's handler may call it. */
char *text_printable(char *to, size_t room, const char *from);

#endif
