/* printed_file.h - the output of a printing function, as a file that appears when it is
 * complete. */
#ifndef FORMATS_BASE_PRINTED_FILE_H
#define FORMATS_BASE_PRINTED_FILE_H

#include <stdbool.h>
#include <stdio.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* printed_file_write() - write all that print(ctx, stream) prints as the file `path`. Errors as of
 * out_file_create(), _append() and _commit(); on an error there is no file. */
CHECKED status printed_file_write(mem *m, const char *path, bool force,
                                  void (*print)(const void *ctx, FILE *out), const void *ctx);

#endif
