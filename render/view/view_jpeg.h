/* view_jpeg.h - write pictures as JPEG, by libjpeg-turbo: quick and small, for pictures that are
 * soon replaced. */
#ifndef RENDER_VIEW_VIEW_JPEG_H
#define RENDER_VIEW_VIEW_JPEG_H

#include "render/app/picture.h"
#include "render/look/picture_bytes.h"
#include "render/view/view_message.h"

typedef struct view_jpeg view_jpeg;

/* view_jpeg_open() - make a compressor, for one thread. ST_NOMEM. view_jpeg_close() - NULL is
 * allowed. */
CHECKED status view_jpeg_open(mem *m, view_jpeg **out);
void view_jpeg_close(view_jpeg *j);

/* view_jpeg_write() - append the planes r, g and b as JPEG to a message, which may move.
 * Transparent parts show black. ST_NOMEM, ST_FAILED. */
CHECKED status view_jpeg_write(view_jpeg *j, const picture *p, view_message **to);

#endif
