/* image_tags.h - reads what programs write into the description of a TIFF: distances, and the roles
 * of pages in a stack of channels, slices and time steps.
 *
 * ImageJ: lines such as "spacing=2.5", "channels=2", "finterval=0.5" (seconds). Pages are channels,
 * then slices, then steps. OME: an XML document whose first Pixels element has PhysicalSizeX,
 * SizeC, DimensionOrder, TimeIncrement and so on. `leafcast export' annotates it with the whole map
 * to the world (M with K="to_world"). Other descriptions are ignored.
 */
#ifndef PREP_IMPORT_IMAGES_IMAGE_TAGS_H
#define PREP_IMPORT_IMAGES_IMAGE_TAGS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/status.h"

/* Zeros: unknown. */
typedef struct image_tags {
    const char *by;         /* "ImageJ", "OME"; NULL: neither */
    double spacing[3];      /* ImageJ has only z */
    uint32_t channels;      /* pages per slice and step */
    uint32_t slices, steps; /* if `by` is set, these and channels are at least 1 */
    char order[4];          /* order of C, Z, T in the pages, fastest first: "CZT" */
    double time_step;       /* time between two steps */
    char time_unit[16];     /* unit of time_step: "s", "ms"; in OME's spelling */
    bool mapped;            /* to_world is known: from pixel, row, slice; finite numbers */
    double to_world[12];    /* row-major */
} image_tags;

/* image_tags_read() - samples: numbers per pixel, which OME counts as channels. path: for messages.
 * ST_CORRUPT: malformed sizes. */
CHECKED status image_tags_read(const char *path, const char *description, uint32_t samples,
                               image_tags *out);

/* image_tags_page() - number of the page of a channel, slice and step. */
uint64_t image_tags_page(const image_tags *t, uint32_t channel, uint32_t slice, uint32_t step);

#endif
