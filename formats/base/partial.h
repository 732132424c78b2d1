/* partial.h - temporary names of outputs, and what killed runs left under them.
 *
 * An output is written as PATH.partial-1 (-2 while another process writes the same output, and so
 * on) and locked with flock() as long as it is open. A file of such a name that nobody has locked
 * was left by a run that was killed: the next writer of PATH removes it. Symbolic links are never
 * followed, existing files never opened for writing.
 */
#ifndef FORMATS_BASE_PARTIAL_H
#define FORMATS_BASE_PARTIAL_H

#include <stdbool.h>
#include <stdint.h>

enum { PARTIAL_ROOM = 40, PARTIAL_SLOTS = 8 }; /* bytes behind PATH; names tried before others */

/* partial_open() - remove what killed runs left of path's, then create and lock a new file. name:
 * out, room for strlen(path) + PARTIAL_ROOM bytes. Returns its descriptor, or -1 and errno:
 * EBUSY where all names are taken. Any thread, any number of processes. A file that a live process
 * writes is never removed: where locks may not be seen by all its users (network file systems),
 * nothing is. */
int partial_open(const char *path, char *name);

/* partial_open_folder() - the same of an output that is a folder: what killed runs left of path's
 * goes with all that is in it, then a folder of such a name is made and locked. Links in it are
 * removed, not followed. */
int partial_open_folder(const char *path, char *name);

/* partial_remove_folder() - a folder and all that is in it, as far as it can be removed; bytes:
 * out, what the files in it had. */
bool partial_remove_folder(const char *name, uint64_t *bytes);

/* partial_on_leftover() - what to call for each file that a killed run left; removed: false where
 * it had to stay. NULL, the default: nothing. Main programs set it before they write. */
typedef void (*partial_leftover)(const char *name, uint64_t bytes, bool removed);
void partial_on_leftover(partial_leftover say);

#endif
