/* picture.h - what the writers of pictures take: planes and words in, bytes out. */
#ifndef RENDER_APP_PICTURE_H
#define RENDER_APP_PICTURE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"
#include "render/leafcast.h"

/* Kept in the picture as "leafcast:KEY". UTF-8. */
typedef struct image_meta {
    const char *key;
    const char *value;
} image_meta;

/* r, g and b must be there; without a the picture is opaque. */
typedef struct picture {
    uint32_t width, height;
    const leafcast_image *image;
    const image_meta *meta;
    size_t meta_count;
} picture;

/* Where a writer's bytes go, one run after the other. */
typedef struct byte_sink {
    status (*put)(void *ctx, const void *data, size_t size);
    void *ctx;
} byte_sink;

#endif
