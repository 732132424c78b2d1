/* file_door.h - the only way for an importer to open files.
 *
 * Libraries open files when and as they like: pieces of a data set, sources of a virtual one, rows
 * of configuration. In an importer all these calls, and leafcast's own, end here (import_calls.c).
 * The file is announced to the file guard, or refused if it is an output of this process or of its
 * parent.
 *
 * If the kernel has Landlock, files cannot be opened in any other way, so none is overlooked:
 * threads may only read what libraries are made of. One thread, the doorman, has more rights and
 * opens files for the others. file_door_grant() says what this run reads and writes, and the kernel
 * holds the doorman to that. This is no wall against code that has taken over the process: such
 * code can do what the doorman can, and no more.
 */
#ifndef PREP_IMPORT_FILE_DOOR_H
#define PREP_IMPORT_FILE_DOOR_H

#include <stdbool.h>
#include <sys/types.h>

#include "formats/base/status.h"

/* file_door_build() - put up the fences; call it before any library has started a thread. Until
 * file_door_grant() only system files can be opened. Before this call, nothing is announced.
 * environment: as of main(), kept: so early getenv() has none yet. */
void file_door_build(char *const *environment);

typedef struct file_door_grants {
    char *const *inputs; /* files and folders; links in a folder may lead out of it */
    int input_count;
    bool beside;        /* an input may name files in its folder */
    bool anywhere;      /* an input may name any file */
    const char *output; /* NULL or "-": none. Covers temporary files beside it, see partial.h */
} file_door_grants;

/* file_door_grant() - call it once. Returns a message for users about what stays without a fence;
 * NULL: nothing. */
const char *file_door_grant(const file_door_grants *g);

/* file_door_open() and so on - like openat() and so on; links are followed. A named pipe is refused
 * (ENXIO) instead of waited for, unless O_NONBLOCK is given. */
int file_door_open(int folder, const char *path, int flags, mode_t mode);
int file_door_unlink(const char *path);
int file_door_rename(const char *from, const char *to, unsigned flags);
int file_door_link(const char *from, const char *to);

/* file_door_refused() - ST_OK, or why the first file that is an output was refused. Its description
 * becomes this thread's. A library may have gone on without the file. */
CHECKED status file_door_refused(void);

#endif
