/* sample_format.h - the formats to which samples of a grid are exported: a row of a table each.
 *
 * All are a head, the samples as they are in little endian, x fastest, and perhaps a tail; so all
 * are written as a stream, to a pipe, too, and can be packed by gzip. What a format cannot hold it
 * refuses.
 */
#ifndef PREP_EXPORT_SAMPLE_FORMAT_H
#define PREP_EXPORT_SAMPLE_FORMAT_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"

typedef struct sample_format {
    const char *name;   /* --format */
    const char *suffix; /* ".nrrd"; NULL: by name alone */
    /* ST_UNSUPPORTED, saying what of the grid cannot be said in the format; NULL: all can. */
    status (*check)(const grid *g);
    status (*head)(mem *m, out_stream *out, const grid *g); /* NULL: none */
    status (*tail)(out_stream *out);                        /* NULL: none */
} sample_format;

extern const sample_format sample_formats[];
extern const int sample_format_count;

#endif
