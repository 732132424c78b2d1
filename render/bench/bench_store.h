/* bench_store.h - the volumes that benchmarks measure on, as treelet files in a scratch folder.
 *
 * Each is made when it is first asked for, by the verbs beside this program: a set of the data
 * folder is unpacked and converted; where it is absent, and for the analytic ones, a field is
 * generated and converted. Nothing is written beside the data.
 */
#ifndef RENDER_BENCH_BENCH_STORE_H
#define RENDER_BENCH_BENCH_STORE_H

#include <limits.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct bench_store bench_store;

/* bench_store_open() - folder: where the files go and stay, and are taken from when they are there
 * already; NULL: a folder of its own in $TMPDIR or /tmp, which goes with the store. data: the data
 * folder, or NULL. threads: of the verbs. */
CHECKED status bench_store_open(mem *m, const char *folder, const char *data, int threads,
                                bench_store **out);
void bench_store_close(bench_store *s); /* NULL is fine */

/* A volume that is there. */
typedef struct bench_stored {
    char label[40];   /* its name, and the field's where that stands for absent data */
    const char *path; /* of the treelet file; lives as long as the store */
    double isovalue;
} bench_stored;

/* bench_store_get() - a volume of the table in bench_store.c, by name.
 * bench_store_compressed() - the same as a compressed file. */
CHECKED status bench_store_get(bench_store *s, const char *name, bench_stored *out);
CHECKED status bench_store_compressed(bench_store *s, const char *name, bench_stored *out);

/* bench_store_alone() - the file of a series' step converted alone, which is made with the series.
 * leaf: the path of the series. */
void bench_store_alone(const char *leaf, uint32_t step, char path[PATH_MAX]);

/* bench_store_forget() - ask the system to forget a file's pages. It may decline. */
void bench_store_forget(const char *path);

#endif
