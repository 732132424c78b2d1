/* tiff_pages.h - how many pages a TIFF says it has.
 *
 * A library that finds a page's directory broken takes that for the end of the file; the chain of
 * directories, followed here, tells a cut file from a short one.
 */
#ifndef PREP_IMPORT_IMAGES_TIFF_PAGES_H
#define PREP_IMPORT_IMAGES_TIFF_PAGES_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* tiff_pages_count() - of a TIFF or BigTIFF. ST_CORRUPT where the chain leaves the file or does not
 * end, or a page lacks bytes (tiff_pieces.h); ST_IO. */
CHECKED status tiff_pages_count(mem *m, const char *path, uint64_t *pages);

#endif
