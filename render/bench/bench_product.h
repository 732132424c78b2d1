/* bench_product.h - what a benchmark prints, as a file that appears when it is complete. */
#ifndef RENDER_BENCH_BENCH_PRODUCT_H
#define RENDER_BENCH_BENCH_PRODUCT_H

#include <stdbool.h>
#include <stdio.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* bench_product_write() - all that print(ctx, stream) prints, as the file `path`. Returns what
 * out_file_create(), _append() and _commit() do; without all of it there is no file. */
CHECKED status bench_product_write(mem *m, const char *path, bool force,
                                   void (*print)(const void *ctx, FILE *out), const void *ctx);

#endif
