/* view_file.h - write a finished picture as a file, in a thread of its own, so that drawing for
 * other clients does not wait.
 */
#ifndef RENDER_VIEW_VIEW_FILE_H
#define RENDER_VIEW_VIEW_FILE_H

#include <stdbool.h>

#include "render/app/picture.h"
#include "render/view/view_message.h"

typedef enum view_file_kind { VIEW_FILE_PNG, VIEW_FILE_EXR } view_file_kind;

/* Most pixels of an EXR: it has up to fourteen planes of floats, which a helper process holds
 * too. */
enum { VIEW_EXR_PIXELS_MAX = 1 << 24 };

typedef struct view_file view_file;

/* view_file_begin() - start writing. Takes over the planes of `shown` in any case; the new thread
 * frees them, as that takes long for large ones. done(): called by that thread at the end, also
 * after an error. ST_UNSUPPORTED: EXR without its helper. */
CHECKED status view_file_begin(mem *m, view_file_kind kind, const picture *shown,
                               void (*done)(void *ctx), void *ctx, view_file **out);

/* view_file_is_done() - returns whether view_file_take() will not wait. view_file_take() - get the
 * file's bytes, which the caller owns, or the error; frees f. */
bool view_file_is_done(const view_file *f);
CHECKED status view_file_take(view_file *f, view_message **out);

/* view_file_bytes() - returns what the file takes so far, beside its planes. */
size_t view_file_bytes(const view_file *f);

/* view_file_end() - stop writing and forget the file, within moments; NULL is allowed. */
void view_file_end(view_file *f);

/* view_file_free_planes() - free all planes of the image, allocated from m. */
void view_file_free_planes(mem *m, leafcast_image *planes);

#endif
