/* picture_pnm.h - write pictures without compression and alpha. PPM (P6): R G B of 8 bits, sRGB
 * encoded. PFM (PF): R G B as little-endian floats, linear, the bottom row first. Both show
 * transparent parts over black.
 */
#ifndef RENDER_APP_PICTURE_PNM_H
#define RENDER_APP_PICTURE_PNM_H

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "render/app/picture.h"

/* Write one picture. Returns ST_NOMEM, or an error of the sink. Rows are written one by one; the
 * threads are not used. */
CHECKED status picture_ppm_write(mem *m, pool *threads, const picture *p, const byte_sink *to);
CHECKED status picture_pfm_write(mem *m, pool *threads, const picture *p, const byte_sink *to);

#endif
