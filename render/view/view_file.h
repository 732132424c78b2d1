/* view_file.h - a finished picture on its way to be a file: written by a thread of its own, so that
 * whoever draws for others need not wait for it.
 */
#ifndef RENDER_VIEW_VIEW_FILE_H
#define RENDER_VIEW_VIEW_FILE_H

#include <stdbool.h>

#include "render/app/picture.h"
#include "render/view/view_message.h"

typedef enum view_file_kind { VIEW_FILE_PNG, VIEW_FILE_EXR } view_file_kind;

/* EXR has up to fourteen planes of floats, which a helper process holds, too. */
enum { VIEW_EXR_PIXELS_MAX = 1 << 24 };

typedef struct view_file view_file;

/* view_file_begin() - the planes of `shown` are the file's from then on, in any case, and freed by
 * the other thread: that takes long where they are large. done(): by that thread, when it is
 * written or could not be. ST_UNSUPPORTED: EXR without its helper. */
CHECKED status view_file_begin(mem *m, view_file_kind kind, const picture *shown,
                               void (*done)(void *ctx), void *ctx, view_file **out);

/* view_file_is_done() - whether view_file_take() need not wait. view_file_take() - the file's
 * bytes, the caller's, or what became of it; ends it. */
bool view_file_is_done(const view_file *f);
CHECKED status view_file_take(view_file *f, view_message **out);

/* view_file_end() - what is written is forgotten, within moments; NULL is fine. */
void view_file_end(view_file *f);

/* view_file_free_planes() - all that there are, of m. */
void view_file_free_planes(mem *m, leafcast_image *planes);

#endif
