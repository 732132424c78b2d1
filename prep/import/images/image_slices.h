/* image_slices.h - reads pages of images as the slices of a grid.
 *
 * A slice is a page of a file. The top row of a page has y = 0. All pages must be of one size and
 * type; this is checked before the first one is read. One page at a time is in memory, besides what
 * OpenImageIO needs for it.
 */
#ifndef PREP_IMPORT_IMAGES_IMAGE_SLICES_H
#define PREP_IMPORT_IMAGES_IMAGE_SLICES_H

#include <stdbool.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/slice_source.h"
#include "prep/import/importer.h"

typedef struct image_wish {
    bool as_given;     /* take files in the order given */
    double spacing[3]; /* 0: from the tags */
} image_wish;

/* image_slices_open(), image_slices_list() - see importer.h. q->field is a channel's name. */
CHECKED status image_slices_open(mem *m, const import_request *q, const image_wish *wish,
                                 slice_source *out);
CHECKED status image_slices_list(mem *m, const import_request *q, const image_wish *wish,
                                 const import_list *to);

#endif
