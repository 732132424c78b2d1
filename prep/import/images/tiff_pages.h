/* tiff_pages.h - walks through the pages that a TIFF says it has.
 *
 * Libraries take a page's broken directory for the end of the file. The chain of directories,
 * followed here, tells a truncated file from a short one.
 */
#ifndef PREP_IMPORT_IMAGES_TIFF_PAGES_H
#define PREP_IMPORT_IMAGES_TIFF_PAGES_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "prep/import/images/tiff_pieces.h"

typedef struct tiff_visit {
    status (*take)(void *ctx, const tiff *t, const tiff_page *page, uint64_t number);
    void *ctx;
} tiff_visit;

/* tiff_pages_each() - visit the pages of a TIFF or BigTIFF, numbered from 0. *pages: how many.
 * ST_CORRUPT: the chain leaves the file or does not end. ST_IO.
 * tiff_pages_count() - count them. ST_CORRUPT also if a page lacks bytes (tiff_pieces.h). */
CHECKED status tiff_pages_each(mem *m, const char *path, const tiff_visit *to, uint64_t *pages);
CHECKED status tiff_pages_count(mem *m, const char *path, uint64_t *pages);

#endif
