/* file_door.h - the only way by which an importer opens files.
 *
 * Libraries open files when and as they like: pieces of a data set, sources of a virtual one, rows
 * of configuration. In an importer each of their calls, and each of leafcast's own, ends here
 * (import_calls.c): the file is announced to the file guard, or refused where it is an output of
 * this process or of the one that has started it.
 *
 * Where the kernel has Landlock nothing else can be opened, so that no way around is forgotten:
 * threads may read only what libraries are made of. One thread, the doorman, may more. It opens
 * what the others ask for, once file_door_grant() has said what this run reads and writes, and the
 * kernel holds it to that. It is no wall against code that has taken over the process: that can do
 * what the doorman can, and no more.
 */
#ifndef PREP_IMPORT_FILE_DOOR_H
#define PREP_IMPORT_FILE_DOOR_H

#include <stdbool.h>
#include <sys/types.h>

#include "formats/base/status.h"

/* file_door_build() - before any library has started a thread: the fences go up, and all that is
 * not a system's file is closed until file_door_grant(). Nothing is announced before either. */
void file_door_build(void);

typedef struct file_door_grants {
    char *const *inputs; /* files and folders; links in a folder may lead out of it */
    int input_count;
    bool beside;        /* an input may name files in its own folder */
    bool anywhere;      /* .. and any file there is */
    const char *output; /* NULL or "-": none. Also temporary files beside it, see partial.h */
} file_door_grants;

/* file_door_grant() - once. What stays without a fence, as words for a user; NULL: nothing. */
const char *file_door_grant(const file_door_grants *g);

/* file_door_open(), .. - as openat() and so on, links followed. A named pipe is refused (ENXIO)
 * rather than waited for, but where O_NONBLOCK is asked for. */
int file_door_open(int folder, const char *path, int flags, mode_t mode);
int file_door_unlink(const char *path);
int file_door_rename(const char *from, const char *to, unsigned flags);
int file_door_link(const char *from, const char *to);

/* file_door_refused() - ST_OK, or why the first file was refused that is an output: its
 * description is then this thread's. A library may have gone on without the file. */
CHECKED status file_door_refused(void);

#endif
