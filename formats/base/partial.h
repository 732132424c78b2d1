/* partial.h - temporary names of outputs, and what killed runs left under them.
 *
 * An output is written as PATH.partial-1 (-2 while another process writes the same output, and so
 * on). It is locked with flock() as long as it is open. An unlocked file of such a name was left by
 * a run that was killed: the next writer of PATH removes it. Symbolic links are never followed,
 * existing files never opened for writing.
 */
#ifndef FORMATS_BASE_PARTIAL_H
#define FORMATS_BASE_PARTIAL_H

#include <stdbool.h>
#include <stdint.h>

enum { PARTIAL_ROOM = 40, PARTIAL_SLOTS = 8 }; /* bytes needed behind PATH; numbered names to try */

/* partial_open() - remove what killed runs left of path's outputs, then create and lock a new file.
 * name: out, room for strlen(path) + PARTIAL_ROOM bytes. Returns its descriptor, or -1 and errno:
 * EBUSY where all names are taken. Any thread, any number of processes. A file that a live process
 * writes is never removed. On network file systems other users may not see the lock, so nothing is
 * removed there. */
int partial_open(const char *path, char *name);

/* partial_open_folder() - the same for an output that is a folder. Removes folders that killed runs
 * left, with all their contents, then makes and locks a new one. Links in them are removed, not
 * followed. */
int partial_open_folder(const char *path, char *name);

/* partial_remove_folder() - remove a folder and its contents, as far as possible. Returns whether
 * all is gone. bytes: out, the total size of the files removed. */
bool partial_remove_folder(const char *name, uint64_t *bytes);

/* partial_on_leftover() - set the function to call for each file that a killed run left; removed:
 * false where it could not be removed. NULL, the default: none. Main programs set it before they
 * write. */
typedef void (*partial_leftover)(const char *name, uint64_t bytes, bool removed);
void partial_on_leftover(partial_leftover say);

#endif
