/* view_picture.h - one view being drawn: first as a preview, then in full.
 *
 * A moving view is drawn as a preview, coarse enough to take about VIEW_MOVING_S (view_pace.h). A
 * view at rest is drawn in full after that and sent part by part: a part is what is drawn when it
 * is due, and the last one is lossless. If the whole takes long, a better preview comes between.
 * For one thread, but for view_picture_cancel() and view_picture_cancel_rest().
 */
#ifndef RENDER_VIEW_VIEW_PICTURE_H
#define RENDER_VIEW_VIEW_PICTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/pool.h"
#include "render/app/picture_scene.h"
#include "render/view/view_changes.h"
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
    leafcast *volume;  /* the one that the page's controls are about */
    view_options view; /* of the picture, and of that volume; its size is that of the canvas */
    const view_scene *scene; /* NULL: one volume; else `view` is of the picture alone, and */
    view_changes *changes;   /* these are its objects', held; or NULL */
    int chosen;              /* the object of `volume` */
    bool moving;             /* a quick picture counts more than a complete one */
    bool where;              /* also tell where it is provisional (view_where.h) */
    bool file; /* only the last part, as a file without JSON before it, of this kind: */
    view_file_kind kind;
    double asked; /* when it was asked for, by clock_seconds() */
    view_told told;
} view_wish;

/* view_wish_copy() - copy a wish over another one, or over zeros. view_wish_release() - let go of
 * what it holds. view_wish_of_one() - returns the flags of its volume. */
void view_wish_copy(view_wish *to, const view_wish *from);
void view_wish_release(view_wish *w);
const view_options *view_wish_of_one(const view_wish *w);

/* What the views of all clients share. */
typedef struct view_tools {
    mem *m;
    pool *threads; /* threads that write PNG */
    view_jpeg *jpeg;
    view_doing *doing;
    void (*wake)(void *ctx); /* called by any thread when a file is written */
    void *wake_ctx;
} view_tools;

typedef struct view_picture view_picture;

CHECKED status view_picture_create(const view_tools *tools, view_picture **out);
void view_picture_destroy(view_picture *p); /* NULL is allowed */

/* view_picture_begin() - forget the current picture and begin another. beside: bytes of other
 * clients' pictures, which count against the volumes' budget. ST_USAGE says why it cannot be
 * drawn. */
CHECKED status view_picture_begin(view_picture *p, const view_wish *wish, uint64_t beside);

/* view_picture_stop() - forget the current picture. view_picture_leave() - also stop reading the
 * volume, as the client is gone. */
void view_picture_stop(view_picture *p);
void view_picture_leave(view_picture *p);

/* view_picture_cancel() - cancel the frame being drawn, as leafcast_frame_cancel(); by any thread.
 * Then the picture must be begun anew or stopped. view_picture_cancel_rest() - the same, unless it
 * is a preview, which will soon be done. */
void view_picture_cancel(view_picture *p);
void view_picture_cancel_rest(view_picture *p);

/* view_picture_busy() - returns whether there is something to draw or to send.
 * view_picture_waits() - whether it goes on only when a part may be sent.
 * view_picture_writes() - whether it goes on only when its file is written.
 * view_picture_may_change() - whether it may give way to a newer view; not while a preview is
 * drawn, which will soon be done.
 * view_picture_bytes() - bytes of its planes.
 * view_picture_wish() - the wish that it was begun with.
 * view_picture_stats(), view_picture_level() - statistics and level of detail of the last
 * drawing. */
bool view_picture_busy(const view_picture *p);
bool view_picture_waits(const view_picture *p);
bool view_picture_writes(const view_picture *p);
bool view_picture_may_change(const view_picture *p);
uint64_t view_picture_bytes(const view_picture *p);
const view_wish *view_picture_wish(const view_picture *p);
const leafcast_stats *view_picture_stats(const view_picture *p);
uint32_t view_picture_level(const view_picture *p);

/* view_picture_advance() - draw for about so many seconds. may_send: a part may be made. *out: that
 * part, which the caller owns, or NULL. ST_STOPPED after view_picture_cancel(). */
CHECKED status view_picture_advance(view_picture *p, double seconds, bool may_send,
                                    view_message **out);

#endif
