/* tiff_pages.h - counts the pages that a TIFF says it has.
 *
 * Libraries take a page's broken directory for the end of the file. The chain of directories,
 * followed here, tells a truncated file from a short one.
 */
#ifndef PREP_IMPORT_IMAGES_TIFF_PAGES_H
#define PREP_IMPORT_IMAGES_TIFF_PAGES_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* tiff_pages_count() - for a TIFF or BigTIFF. ST_CORRUPT: the chain leaves the file or does not
 * end, or a page lacks bytes (tiff_pieces.h). ST_IO. */
CHECKED status tiff_pages_count(mem *m, const char *path, uint64_t *pages);

#endif
