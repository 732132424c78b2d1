/* image_helper.h - write pictures through a helper process, leafcast-write-image, because its
 * library takes half a second to load. write_image_main.cpp describes the stream.
 *
 * The helper is looked for beside the running program, then on PATH. It opens no file: it sends a
 * picture's bytes back. Use a helper from one thread, for one picture after another.
 */
#ifndef RENDER_APP_IMAGE_HELPER_H
#define RENDER_APP_IMAGE_HELPER_H

#include <stdbool.h>

#include "formats/base/mem.h"
#include "render/app/picture.h"

typedef struct image_helper image_helper;

/* image_helper_check() - returns ST_UNSUPPORTED if the helper is not installed. */
CHECKED status image_helper_check(void);

/* image_helper_start() - start the helper without waiting until it is ready. stop (or NULL) is
 * called every tenth of a second during waits for the helper. */
CHECKED status image_helper_start(mem *m, bool (*stop)(void *), void *ctx, image_helper **out);

/* image_helper_write() - write one picture as `format` ("exr") to the sink. `path` is for error
 * descriptions. If the helper dies, no signal is raised, and its last words go into the
 * description. Returns ST_STOPPED when a signal to stop ended the helper, or stop() returned true;
 * ST_NOMEM when it had no memory. After an error only image_helper_end() may follow. */
CHECKED status image_helper_write(image_helper *h, const char *format, const char *path,
                                  const picture *p, const byte_sink *to);

/* image_helper_end() - end the helper at once, without waiting for one that is still loading. NULL
 * is allowed. */
void image_helper_end(image_helper *h);

#endif
