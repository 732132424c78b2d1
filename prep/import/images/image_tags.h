/* image_tags.h - what programs write into the description of a TIFF: distances, and which page is
 * which of a stack of channels, slices and time steps.
 *
 * ImageJ: lines such as "spacing=2.5", "channels=2", "finterval=0.5" (seconds); pages are channels,
 * then slices, then steps. OME: an XML document whose first Pixels element has PhysicalSizeX,
 * SizeC, DimensionOrder, TimeIncrement and so on; `leafcast export' annotates it with the whole map
 * to the world (M with K="to_world"). Other descriptions say nothing.
 */
#ifndef PREP_IMPORT_IMAGES_IMAGE_TAGS_H
#define PREP_IMPORT_IMAGES_IMAGE_TAGS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/status.h"

/* Zeros: not said. */
typedef struct image_tags {
    const char *by;         /* "ImageJ", "OME"; NULL: neither */
    double spacing[3];      /* ImageJ says but z */
    uint32_t channels;      /* pages of one slice and step */
    uint32_t slices, steps; /* channels, slices and steps are at least 1 where `by` is set */
    char order[4];          /* which of C, Z, T goes on first, then, last: "CZT" */
    double time_step;       /* from one step to the next */
    char time_unit[16];     /* of that: "s", "ms"; OME's own words */
    bool mapped;            /* to_world is said: from pixel, row, slice; finite numbers */
    double to_world[12];    /* row-major */
} image_tags;

/* image_tags_read() - samples: numbers a pixel, which OME counts as channels. path: for messages.
 * ST_CORRUPT for sizes that are none. */
CHECKED status image_tags_read(const char *path, const char *description, uint32_t samples,
                               image_tags *out);

/* image_tags_page() - the page of a channel, slice and step. */
uint64_t image_tags_page(const image_tags *t, uint32_t channel, uint32_t slice, uint32_t step);

#endif
