/* out_folder.h - an output that is a folder of files, which appears when it is complete.
 *
 * It is written under a temporary name, see partial.h, and takes its own at the end. Nothing that
 * is there is ever replaced: to remove a folder with all that is in it is the user's affair.
 */
#ifndef FORMATS_BASE_OUT_FOLDER_H
#define FORMATS_BASE_OUT_FOLDER_H

#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct out_folder out_folder;

/* out_folder_check() - ST_EXISTS where something stands under this name, ST_USAGE for "-", and for
 * none; before work begins. */
CHECKED status out_folder_check(const char *path);

/* out_folder_create() - errors as of out_folder_check(), ST_IO, ST_NOMEM. */
CHECKED status out_folder_create(mem *m, const char *path, out_folder **out);

/* out_folder_put() - a file of its own, with the folders in its name, which are made where they are
 * not yet: "0/3/1". Each name once. ST_NOSPACE, ST_IO. Several threads may. */
CHECKED status out_folder_put(out_folder *f, const char *name, const void *bytes, size_t size);

/* out_folder_commit() - that was all. Consumes f in any case; on an error nothing stays.
 * out_folder_discard() - leave nothing behind. NULL is fine. */
CHECKED status out_folder_commit(out_folder *f);
void out_folder_discard(out_folder *f);

#endif
