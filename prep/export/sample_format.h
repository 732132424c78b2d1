/* sample_format.h - the formats to which samples of a grid are exported: a row of a table each.
 *
 * Most are a head, the samples as they are in little endian, x fastest, and perhaps a tail; so they
 * are written as a stream, to a pipe, too, and can be packed by gzip. Others have a writer of their
 * own. What a format cannot hold it refuses.
 */
#ifndef PREP_EXPORT_SAMPLE_FORMAT_H
#define PREP_EXPORT_SAMPLE_FORMAT_H

#include "formats/base/out_stream.h"
#include "formats/base/progress.h"
#include "formats/grid/grid.h"
#include "prep/export/grid_part.h"
#include "prep/export/sample_times.h"

/* What is to be exported, and where to. */
typedef struct sample_export {
    leaf_file *f;
    const grid_part *part;
    const uint32_t *sets;     /* count of them, the first the part's own */
    const char *const *names; /* of the sets, no two alike */
    uint32_t count;           /* 1, but for formats of several fields; of all steps, theirs */
    const sample_times *times;
    const char *path; /* "-": standard output */
    bool force;
    int threads;
    const progress *p;
} sample_export;

typedef struct sample_format {
    const char *name;   /* --format */
    const char *suffix; /* ".nrrd"; NULL: by name alone */
    /* ST_UNSUPPORTED, saying what of the grid cannot be said in the format; NULL: all can. */
    status (*check)(const grid *g);
    status (*head)(mem *m, out_stream *out, const grid *g); /* NULL: none */
    status (*tail)(out_stream *out);                        /* NULL: none */
    /* The head of a file of all steps, whose samples follow one another. ST_UNSUPPORTED: too many.
     * NULL: a file is of one step, or the writer does it. */
    status (*head_steps)(mem *m, out_stream *out, const grid *g, const sample_times *times);
    status (*write)(mem *m, const sample_export *e); /* NULL: head, samples, tail */
    bool fields;                                     /* the writer takes several */
    bool steps;                                      /* a file can be of all steps */
    bool folder;   /* the output is a folder, which nothing replaces */
    bool unpacked; /* gzip would keep it from being read */
    bool named;    /* its array has a name: the field's, else the data set's */
    /* What of the grid other programs will not find in the file, as a sentence; NULL: nothing. May
     * be NULL. */
    const char *(*loses)(const grid *g);
    const char *(*loses_times)(const sample_times *times); /* the same of the steps' times */
    bool slices; /* may be a file a slice, where the output's name has a %04d */
} sample_format;

extern const sample_format sample_formats[];
extern const int sample_format_count;

#endif
