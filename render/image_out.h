/* image_out.h - pictures and depth planes to files.
 *
 * PNG and EXR are written by a helper process, leafcast-write-image (see write_image_main.cpp for
 * the stream it is fed), because the library behind it takes half a second to load. It is looked
 * for beside the running program, then on PATH. EXR gets the channels R G B A Z N.x N.y N.z id;
 * colours are linear and premultiplied. PNG gets R G B A, sRGB encoded, not premultiplied. Files
 * appear under their name only when complete; what is missing from the image (NULL planes) becomes
 * no channel.
 */
#ifndef RENDER_IMAGE_OUT_H
#define RENDER_IMAGE_OUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/leafcast.h"

/* Kept in the picture as "leafcast:KEY". */
typedef struct image_meta {
    const char *key;
    const char *value;
} image_meta;

/* image_out_check() - what would make image_out_write() fail can be told before hours of rendering:
 * a name that ends neither in .png nor in .exr (ST_USAGE), a file that is there already (ST_EXISTS,
 * unless force), no helper (ST_UNSUPPORTED). */
CHECKED status image_out_check(const char *path, bool force);

/* image_out_write() - one picture through the helper; waits for it. r, g and b must be there. No
 * signal is raised when the helper dies: its last words become the description. ST_STOPPED when a
 * signal ended it. */
CHECKED status image_out_write(mem *m, const char *path, bool force, uint32_t width,
                               uint32_t height, const leafcast_image *image, const image_meta *meta,
                               size_t meta_count);

/* image_out_depth() - count doubles, little endian, nothing else. */
CHECKED status image_out_depth(mem *m, const char *path, bool force, const double *z, size_t count);

#endif
