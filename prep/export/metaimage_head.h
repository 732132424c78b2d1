/* metaimage_head.h - the head of a MetaImage file (.mha): one volume, in the world of ITK.
 */
#ifndef PREP_EXPORT_METAIMAGE_HEAD_H
#define PREP_EXPORT_METAIMAGE_HEAD_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"

/* metaimage_head_check() - ST_UNSUPPORTED for rectilinear grids. metaimage_head() - write all bytes
 * before the first sample; RAS is turned to LPS. metaimage_head_loses() - see sample_format.h. */
CHECKED status metaimage_head_check(const grid *g);
CHECKED status metaimage_head(mem *m, out_stream *out, const grid *g);
const char *metaimage_head_loses(const grid *g);

#endif
