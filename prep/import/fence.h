/* fence.h - restricts a program whose library reads hostile files.
 *
 * It sets up two fences of the kernel, each as far as the kernel has it. Files: Landlock, which
 * restricts a thread and those it starts later, but not threads that run already. Calls: seccomp,
 * which restricts all threads at once. Neither can be lifted again. Nothing here allocates memory.
 */
#ifndef PREP_IMPORT_FENCE_H
#define PREP_IMPORT_FENCE_H

#include <stdbool.h>

/* Rights on a file, or on everything beneath a folder. */
enum {
    FENCE_READ = 1,  /* read files */
    FENCE_LIST = 2,  /* read the names in folders */
    FENCE_WRITE = 4, /* write, make, rename and remove files */
};

typedef struct fence {
    int rules; /* a descriptor; -1: no Landlock */
    int version;
} fence;

/* fence_begin() - start with rules that allow nothing. Returns false if the kernel has no
 * Landlock. */
bool fence_begin(fence *f);

/* fence_allow() - allow rights on a path. Links are followed, also later. A missing path is
 * skipped. */
void fence_allow(fence *f, const char *path, unsigned rights);

/* fence_close() - from now on the calling thread opens, makes, renames and removes only what the
 * rules allow, and connects to nothing. Returns false if nothing changed. Consumes the rules. */
bool fence_close(fence *f);

/* fence_calls() - from now on no thread of this process opens a socket, starts a program or a
 * process, inspects or signals other processes, or changes owners, modes and mounts. Such calls
 * fail with EPERM. Returns false if the kernel, or this build's architecture, has no such
 * filters. */
bool fence_calls(void);

#endif
