/* npy_head.h - the head of a NumPy file (.npy): samples[z, y, x], little endian.
 *
 * Format: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html, version 1.0.
 */
#ifndef PREP_EXPORT_NPY_HEAD_H
#define PREP_EXPORT_NPY_HEAD_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"

/* npy_head() - write all bytes before the first sample. npy_head_loses() - see sample_format.h. */
CHECKED status npy_head(mem *m, out_stream *out, const grid *g);
const char *npy_head_loses(const grid *g);

#endif
