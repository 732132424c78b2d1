/* sample_stream.h - samples as a file that is written front to back: a head, samples, a tail.
 */
#ifndef PREP_EXPORT_SAMPLE_STREAM_H
#define PREP_EXPORT_SAMPLE_STREAM_H

#include "prep/export/sample_format.h"

/* sample_stream_write() - the sets one after the other; g: the part, as grid_part_describe() has
 * it. gzip: packed. Errors as of out_stream.h and grid_slices.h. */
CHECKED status sample_stream_write(mem *m, const sample_format *format, const sample_export *e,
                                   const grid *g, bool gzip);

#endif
