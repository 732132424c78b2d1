/* scratch.h - what tests need of the file system: a folder of their own, files in it, the data
 * folder.
 *
 * The folder is made by the first call and removed with its files when the program ends. Trouble
 * fails the running test.
 */
#ifndef TESTS_SUPPORT_SCRATCH_H
#define TESTS_SUPPORT_SCRATCH_H

#include <stddef.h>

/* scratch_path() - the path of a name in the folder; stays valid. */
const char *scratch_path(const char *name);

/* scratch_write() - a file of these bytes; scratch_text() - of this text; each returns
 * scratch_path(name). */
const char *scratch_write(const char *name, const void *data, size_t size);
const char *scratch_text(const char *name, const char *text);

/* scratch_read() - the bytes of a file and a NUL behind them; the caller frees them. size may be
 * NULL. */
char *scratch_read(const char *path, size_t *size);

/* scratch_same() - fail the test unless two files have the same bytes. what: for the message. */
void scratch_same(const char *what, const char *a, const char *b);

/* scratch_count() - the number of files in the folder. */
size_t scratch_count(void);

/* scratch_data() - the path of a file in the data folder ($LEAFCAST_DATA, else ../shared/data);
 * NULL when it is not there. Valid until the next call. */
const char *scratch_data(const char *name);

#endif
