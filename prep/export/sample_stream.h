/* sample_stream.h - writes samples as a file front to back: a head, samples, a tail.
 */
#ifndef PREP_EXPORT_SAMPLE_STREAM_H
#define PREP_EXPORT_SAMPLE_STREAM_H

#include "prep/export/sample_format.h"

/* sample_stream_write() - write the sets one after the other. g: the part, as made by
 * grid_part_describe(). gzip: pack the file. Errors as in out_stream.h and grid_slices.h. */
CHECKED status sample_stream_write(mem *m, const sample_format *format, const sample_export *e,
                                   const grid *g, bool gzip);

#endif
