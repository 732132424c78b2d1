/* view_picture.h - one view being drawn: first as a preview, then as it is.
 *
 * A moving view is drawn as a preview, so coarse that it takes about VIEW_MOVING_S (view_pace.h).
 * One at rest is drawn in full after that, part by part: a part is what there is when its time has
 * come, the last one is lossless. Where the whole takes long, a better preview comes between. For
 * one thread, but for view_picture_cancel().
 */
#ifndef RENDER_VIEW_VIEW_PICTURE_H
#define RENDER_VIEW_VIEW_PICTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/pool.h"
#include "render/app/picture_scene.h"
#include "render/view/view_file.h"
#include "render/view/view_jpeg.h"
#include "render/view/view_life.h"
#include "render/view/view_message.h"
#include "render/view/view_pace.h"

enum { VIEW_SIDE_MAX = 16384, VIEW_PIXELS_MAX = 1 << 27 };
#define VIEW_MOVING_S 0.034

/* What a page wants to see. */
typedef struct view_wish {
    uint64_t number;
    leafcast *volume;
    view_options view; /* its size is the canvas's */
    bool moving;       /* that something is there soon counts more than that it is complete */
    bool where;        /* and be told where it is provisional (view_where.h) */
    bool file;         /* the last part alone, as a file without JSON before it, of this kind: */
    view_file_kind kind;
    double asked; /* clock_seconds() */
    view_told told;
} view_wish;

/* What the views of one client share. */
typedef struct view_tools {
    mem *m;
    pool *threads; /* that PNG is written by */
    view_jpeg *jpeg;
    view_doing *doing;
    void (*wake)(void *ctx); /* by any thread: a file is written */
    void *wake_ctx;
} view_tools;

typedef struct view_picture view_picture;

CHECKED status view_picture_create(const view_tools *tools, view_picture **out);
void view_picture_destroy(view_picture *p); /* NULL is fine */

/* view_picture_begin() - forget what is drawn, and begin another one. beside: bytes of others'
 * pictures, which the volumes' budget counts. ST_USAGE: it cannot be, and why. */
CHECKED status view_picture_begin(view_picture *p, const view_wish *wish, uint64_t beside);

/* view_picture_stop() - forget what is drawn. view_picture_leave() - and nobody looks any more. */
void view_picture_stop(view_picture *p);
void view_picture_leave(view_picture *p);

/* view_picture_cancel() - by any thread: the frame that is being drawn, as leafcast_frame_cancel().
 * What was begun must then be begun anew, or stopped. view_picture_cancel_rest() - likewise, unless
 * it is a preview, which will soon be there. */
void view_picture_cancel(view_picture *p);
void view_picture_cancel_rest(view_picture *p);

/* view_picture_busy() - whether there is something to draw or to send. view_picture_waits() - it
 * goes on only when something may be sent. view_picture_writes() - only when its file is written.
 * view_picture_may_change() - whether it may give way to a newer view: no for a moving one that
 * will soon be there. view_picture_bytes() - of planes. view_picture_wish() - what it was begun
 * with. view_picture_stats(), view_picture_level() - of what was drawn last: level of detail. */
bool view_picture_busy(const view_picture *p);
bool view_picture_waits(const view_picture *p);
bool view_picture_writes(const view_picture *p);
bool view_picture_may_change(const view_picture *p);
uint64_t view_picture_bytes(const view_picture *p);
const view_wish *view_picture_wish(const view_picture *p);
const leafcast_stats *view_picture_stats(const view_picture *p);
uint32_t view_picture_level(const view_picture *p);

/* view_picture_advance() - draw for about so many seconds. may_send: a part may be made, *out, the
 * caller's; NULL: none was. ST_STOPPED after view_picture_cancel(). */
CHECKED status view_picture_advance(view_picture *p, double seconds, bool may_send,
                                    view_message **out);

#endif
