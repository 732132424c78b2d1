/* out_folder.h - an output that is a folder of files, which appears when it is complete.
 *
 * It is written under a temporary name, see partial.h, and gets its own name at the end. Existing
 * files and folders are never replaced: removing a folder with all its contents is left to the
 * user.
 */
#ifndef FORMATS_BASE_OUT_FOLDER_H
#define FORMATS_BASE_OUT_FOLDER_H

#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct out_folder out_folder;

/* out_folder_check() - ST_EXISTS where something has this name, ST_USAGE for "-" and for an empty
 * name. Call it before work begins. */
CHECKED status out_folder_check(const char *path);

/* out_folder_create() - begin a folder. Errors as of out_folder_check(), ST_IO, ST_NOMEM. */
CHECKED status out_folder_create(mem *m, const char *path, out_folder **out);

/* out_folder_put() - write a file, and make missing folders in its name ("0/3/1"). Each name once.
 * ST_NOSPACE, ST_IO. Several threads may call it at once. */
CHECKED status out_folder_put(out_folder *f, const char *name, const void *bytes, size_t size);

/* out_folder_commit() - publish the complete folder. Consumes f in any case; on an error nothing
 * stays.
 * out_folder_discard() - leave nothing behind. NULL is fine. */
CHECKED status out_folder_commit(out_folder *f);
void out_folder_discard(out_folder *f);

#endif
