/* image_helper.h - pictures through a helper process, leafcast-write-image (write_image_main.cpp
 * has the stream), because the library behind it takes half a second to load.
 *
 * It is looked for beside the running program, then on PATH. It opens no file: it gives a picture's
 * bytes back. One thread per helper; one picture after another.
 */
#ifndef RENDER_APP_IMAGE_HELPER_H
#define RENDER_APP_IMAGE_HELPER_H

#include <stdbool.h>

#include "formats/base/mem.h"
#include "render/app/picture.h"

typedef struct image_helper image_helper;

/* image_helper_check() - ST_UNSUPPORTED when there is none. */
CHECKED status image_helper_check(void);

/* image_helper_start() - does not wait for it. stop (or NULL) is asked every tenth of a second
 * while the helper is waited for. */
CHECKED status image_helper_start(mem *m, bool (*stop)(void *), void *ctx, image_helper **out);

/* image_helper_write() - one picture as `format` ("exr"), its bytes to the sink. `path` is for
 * descriptions. No signal is raised when the helper dies: its last words go into the description.
 * ST_STOPPED when a signal to stop ended it, or stop() said so; ST_NOMEM when it had no memory.
 * After a fault only image_helper_end() may follow. */
CHECKED status image_helper_write(image_helper *h, const char *format, const char *path,
                                  const picture *p, const byte_sink *to);

/* image_helper_end() - at once: a helper that is still loading is not waited for. NULL is fine. */
void image_helper_end(image_helper *h);

#endif
