/* jpeg_end.h - checks that a JPEG is complete.
 *
 * For a truncated file libjpeg fills in grey, and gives a warning that OpenImageIO drops. So the
 * end marker is looked for here, marker by marker.
 */
#ifndef PREP_IMPORT_IMAGES_JPEG_END_H
#define PREP_IMPORT_IMAGES_JPEG_END_H

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* jpeg_end_check() - ST_CORRUPT: the file ends before its end marker. ST_IO. */
CHECKED status jpeg_end_check(mem *m, const char *path);

#endif
