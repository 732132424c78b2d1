/* view_slice.h - a client's slices: a few panes, the newest wish of each.
 *
 * A slice is sampled band by band, so that a turn is short however much there is to read. While the
 * hand is at it, and where the whole takes longer, a preview comes first: fewer pixels, of a level
 * of detail as coarse as they are. The last picture of a wish is what `leafcast slice` makes of it,
 * to the byte of a pixel. view_slices_want(), view_slices_seen() and view_slices_cancel() are for
 * any thread, the rest for the drawing one.
 */
#ifndef RENDER_VIEW_VIEW_SLICE_H
#define RENDER_VIEW_VIEW_SLICE_H

#include "render/app/slice_request.h"
#include "render/view/view_picture.h"

enum { VIEW_PANES_MAX = 4, VIEW_SLICE_SIDE_MAX = 4096, VIEW_SLICE_PIXELS_MAX = 1 << 22 };

typedef struct view_slice_wish {
    uint64_t number;
    int pane;
    leafcast *volume;
    slice_request request; /* checked, not placed: it owns nothing */
    uint32_t box[2];       /* pixels that it is to fit into */
    bool moving;           /* a preview is all that is wanted */
    double asked;          /* clock_seconds() */
    view_told told;
} view_slice_wish;

typedef struct view_slices view_slices;

CHECKED status view_slices_create(const view_tools *tools, view_slices **out);
void view_slices_destroy(view_slices *s); /* NULL is fine */

/* view_slices_want() - draw this in its pane; an older wish of the pane is forgotten.
 * view_slices_seen() - the pane's picture of this number, and all before, are seen: one at a time
 * is sent. view_slices_cancel() - of all panes, what is being sampled ends soon. */
void view_slices_want(view_slices *s, const view_slice_wish *wish);
void view_slices_seen(view_slices *s, int pane, uint64_t number);
void view_slices_cancel(view_slices *s);

/* view_slices_clear() - as it was created. view_slices_need() - whether there is something to do.
 * view_slices_bytes() - of planes. */
void view_slices_clear(view_slices *s);
bool view_slices_need(view_slices *s);
uint64_t view_slices_bytes(const view_slices *s);

/* view_slices_advance() - for about so many seconds. beside: bytes of others, which the budget
 * counts. *out: a message for the page, the caller's; NULL: none yet. *number, *pane: of the wish
 * that it was about, also where it failed. ST_USAGE: it cannot be drawn, and why. */
CHECKED status view_slices_advance(view_slices *s, double seconds, uint64_t beside,
                                   view_message **out, uint64_t *number, int *pane);

#endif
