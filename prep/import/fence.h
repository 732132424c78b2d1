/* fence.h - what a program whose library reads hostile files may still do.
 *
 * Two fences of the kernel, each as far as the kernel has it. Files: Landlock, which restricts a
 * thread and those that it starts later, never those that run already. Calls: seccomp, which
 * restricts all threads at once. Neither can be taken away again. Nothing here allocates memory.
 */
#ifndef PREP_IMPORT_FENCE_H
#define PREP_IMPORT_FENCE_H

#include <stdbool.h>

/* What is allowed with a file, or with all that is beneath a folder. */
enum {
    FENCE_READ = 1,  /* read files */
    FENCE_LIST = 2,  /* read the names in folders */
    FENCE_WRITE = 4, /* write files, make, rename and remove them */
};

typedef struct fence {
    int rules; /* a descriptor; -1: there is no Landlock */
    int version;
} fence;

/* fence_begin() - rules that allow nothing yet; false: the kernel has no Landlock. */
bool fence_begin(fence *f);

/* fence_allow() - links are followed, also later. A path that is not there is passed over. */
void fence_allow(fence *f, const char *path, unsigned rights);

/* fence_close() - from now on the calling thread opens, makes, renames and removes only what the
 * rules allow, and connects to nothing. false: it is as before. Consumes the rules. */
bool fence_close(fence *f);

/* fence_calls() - from now on no thread of this process opens a socket, starts a program or a
 * process, looks into others or signals them, or changes owners, modes and mounts: such calls fail
 * with EPERM. false: the kernel, or this build's architecture, has no such filters. */
bool fence_calls(void);

#endif
