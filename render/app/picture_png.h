/* picture_png.h - write pictures as PNG: R G B of 8 bits, sRGB encoded. With a plane a also A, and
 * colours not premultiplied.
 *
 * Filtering and deflating run on threads, in bands of rows. The bytes of a band depend on its rows
 * alone, so the file does not depend on the threads. libpng writes everything but the pixels.
 */
#ifndef RENDER_APP_PICTURE_PNG_H
#define RENDER_APP_PICTURE_PNG_H

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "render/app/picture.h"

enum { PICTURE_PNG_TEXT = 4096 };

/* picture_png_write() - write one picture. Returns ST_NOMEM, ST_UNSUPPORTED for more than 2^28
 * columns, or an error of the sink. Values of metadata are cut to less than PICTURE_PNG_TEXT bytes,
 * between two UTF-8 characters. */
CHECKED status picture_png_write(mem *m, pool *threads, const picture *p, const byte_sink *to);

/* picture_png_bytes() - returns about how many bytes of memory picture_png_write() needs. */
size_t picture_png_bytes(int threads, uint32_t width);

#endif
