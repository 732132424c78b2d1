/* picture_png.h - pictures as PNG: R G B of 8 bits, sRGB encoded; A, too, and not
 * premultiplied, where there is a plane of it.
 *
 * Filtering and deflating are shared out over threads in bands of rows; a band's bytes depend on
 * nothing but its rows, so the file does not depend on the threads. libpng writes everything but
 * the pixels.
 */
#ifndef RENDER_APP_PICTURE_PNG_H
#define RENDER_APP_PICTURE_PNG_H

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "render/app/picture.h"

enum { PICTURE_PNG_TEXT = 4096 };

/* picture_png_write() - ST_NOMEM, ST_UNSUPPORTED of more than 2^28 columns, or what the sink
 * returned. Values of metadata are cut to less than PICTURE_PNG_TEXT bytes, between two letters of
 * UTF-8. */
CHECKED status picture_png_write(mem *m, pool *threads, const picture *p, const byte_sink *to);

/* picture_png_bytes() - memory that this takes at a time, about. */
size_t picture_png_bytes(int threads, uint32_t width);

#endif
