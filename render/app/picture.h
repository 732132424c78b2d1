/* picture.h - what picture writers take (planes, metadata) and where they put bytes. */
#ifndef RENDER_APP_PICTURE_H
#define RENDER_APP_PICTURE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"
#include "render/leafcast.h"

/* Metadata, stored in the picture as "leafcast:KEY". UTF-8. */
typedef struct image_meta {
    const char *key;
    const char *value;
} image_meta;

/* A picture to write. Planes r, g and b must be there; without a it is opaque. */
typedef struct picture {
    uint32_t width, height;
    const leafcast_image *image;
    const image_meta *meta;
    size_t meta_count;
} picture;

/* Receives a writer's bytes, in order. */
typedef struct byte_sink {
    status (*put)(void *ctx, const void *data, size_t size);
    void *ctx;
} byte_sink;

#endif
