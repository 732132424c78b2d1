/* importing.h - a verb import-X at work: it reads a file by its format's library, in a process of
 * its own, and what it prints is read here.
 *
 * Half of the budget that is left is lent to it as long as it runs. What it says when it fails is
 * this program's error: ST_CORRUPT, ST_UNSUPPORTED, ST_USAGE, ST_NOMEM, or ST_FAILED. One thread.
 */
#ifndef FORMATS_INPUT_IMPORTING_H
#define FORMATS_INPUT_IMPORTING_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/sibling.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"
#include "formats/input/foreign.h"
#include "formats/input/input_trust.h"

/* What it is asked for, on its command line. */
typedef struct importing {
    mem *m;
    char *path;
    char **fields; /* copies */
    size_t field_count;
    uint32_t component, step; /* 0: not said */
    bool by_corners, cells_to_points;
    bool zones;     /* of a mesh whose cells are all implied by zones: these */
    const char *to; /* where netCDF's nodes go; NULL: not asked. Heights times exaggerate; 0: 1 */
    double exaggerate;
    input_trust trust;
    char program[SIBLING_PATH];
} importing;

/* importing_init() - find the verb for a file of a format, and copy its path. ST_UNSUPPORTED if it
 * is not built. The caller sets what is asked for. importing_release() - also
 * if it failed. importing_take() - name the fields to ask for, instead of those before; a single
 * NULL: none. */
CHECKED status importing_init(importing *x, mem *m, const foreign_format *f, const char *path);
void importing_release(importing *x);
CHECKED status importing_take(importing *x, const char *const *names, size_t count);

/* importing_stream() - start it with up to three words that say what is wanted, and open its output
 * as a stream, named by the path; closing that ends it. closed(ctx) is called then, and also if
 * this fails; NULL: nobody is told. x must live until then, and may be released by closed(). */
CHECKED status importing_stream(importing *x, const char *const words[3], void (*closed)(void *ctx),
                                void *ctx, byte_stream **out);

/* importing_list() - start it to list its fields: the object that --list --json prints, which has
 * an array "fields". The caller lets go of *out. */
CHECKED status importing_list(importing *x, json_t **out);

/* importing_steps() - the number of steps of an entry of "fields"; 1 or more.
 * importing_times() - one time for each step, of an array "times", which may be NULL. *out is
 * allocated from m, or NULL: there are not as many. */
uint32_t importing_steps(const json_t *field);
CHECKED status importing_times(mem *m, const json_t *times, uint32_t steps, double **out);

#endif
