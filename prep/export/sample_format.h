/* sample_format.h - formats for samples of a grid, one row of a table each.
 *
 * Most are a head, the samples in little endian with x fastest, and perhaps a tail. These can be
 * streamed, to a pipe, too, and packed by gzip. Others have a writer of their own. A format refuses
 * what it cannot hold.
 */
#ifndef PREP_EXPORT_SAMPLE_FORMAT_H
#define PREP_EXPORT_SAMPLE_FORMAT_H

#include "formats/base/out_stream.h"
#include "formats/base/progress.h"
#include "formats/grid/grid.h"
#include "prep/export/grid_part.h"
#include "prep/export/sample_times.h"

/* An export: its input and its output. */
typedef struct sample_export {
    leaf_file *f;
    const grid_part *part;
    const uint32_t *sets;     /* count of them; the first is the part's own set */
    const char *const *names; /* of the sets; all differ */
    uint32_t count;           /* of sets: several fields if the format has `fields`, or all steps;
                                 else 1 */
    const sample_times *times;
    const char *path; /* "-": standard output */
    bool force;
    int threads;
    const progress *p;
} sample_export;

typedef struct sample_format {
    const char *name;   /* --format */
    const char *suffix; /* such as ".nrrd"; NULL: chosen by --format alone */
    /* ST_UNSUPPORTED, with what the format cannot express of the grid; NULL: it can express all. */
    status (*check)(const grid *g);
    status (*head)(mem *m, out_stream *out, const grid *g); /* NULL: none */
    status (*tail)(out_stream *out);                        /* NULL: none */
    /* Head of a file of all steps, whose samples follow one another. ST_UNSUPPORTED: too many
     * steps. NULL: a file has one step, or `write` does it. */
    status (*head_steps)(mem *m, out_stream *out, const grid *g, const sample_times *times);
    status (*write)(mem *m, const sample_export *e); /* NULL: head, samples, tail */
    bool fields;                                     /* `write` takes several fields */
    bool steps;                                      /* a file can be of all steps */
    bool folder;   /* the output is a folder, which is never replaced */
    bool unpacked; /* no gzip: other programs could not read that */
    bool named;    /* its array is named after the field, else after the data set */
    /* A sentence about what other programs will not find in the file; NULL: nothing. May be
     * NULL. */
    const char *(*loses)(const grid *g);
    const char *(*loses_times)(const sample_times *times); /* the same for the times of steps */
    bool slices; /* can write one file per slice, if the output's name has a %04d */
} sample_format;

extern const sample_format sample_formats[];
extern const int sample_format_count;

#endif
