/* resample_input.h - opens anything that can be resampled as a treelet file. */
#ifndef PREP_RESAMPLE_RESAMPLE_INPUT_H
#define PREP_RESAMPLE_RESAMPLE_INPUT_H

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/input_open.h"
#include "formats/leaf/leaf_file.h"

typedef struct resample_source {
    const char *path;   /* a treelet file, or an input of input_open(); "-": standard input */
    input_hints hints;  /* for an input */
    bool whole_cells;   /* do not split a mesh's cells into tets */
    const char *beside; /* path beside which an input is converted to a treelet file; NULL: in
                           $TMPDIR, or /tmp */
    int threads;
    /* An input is open, of these input_traits: whether to go on. NULL: always. */
    status (*opened)(void *ctx, unsigned traits, const char *format);
    void *ctx;
} resample_source;

/* resample_input_is_leaf() - returns whether a file begins as a treelet file does. */
bool resample_input_is_leaf(const char *path);

/* resample_input_open() - open a treelet file directly, or convert a step of a mesh or a
 * curvilinear grid to one, within m's limit. The converted file has no name when this returns, and
 * vanishes on leaf_file_close(). ST_UNSUPPORTED: a regular grid, say. p may be NULL. */
CHECKED status resample_input_open(mem *m, const resample_source *s, const progress *p,
                                   leaf_file **out);

#endif
