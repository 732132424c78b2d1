/* jpeg_end.h - whether a JPEG has its end.
 *
 * libjpeg makes up what a cut file lacks, in grey, and gives a warning that OpenImageIO drops; so
 * the end is looked for here, marker by marker.
 */
#ifndef PREP_IMPORT_IMAGES_JPEG_END_H
#define PREP_IMPORT_IMAGES_JPEG_END_H

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* jpeg_end_check() - ST_CORRUPT where the file ends before the marker of the end does; ST_IO. */
CHECKED status jpeg_end_check(mem *m, const char *path);

#endif
