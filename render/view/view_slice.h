/* view_slice.h - a client's slices: a few panes, with the newest wish of each.
 *
 * A slice is sampled band by band, so that a turn stays short however much has to be read. While
 * the user moves it, and if the whole takes long, a preview comes first: fewer pixels, from a level
 * of detail that suits them. The last picture of a wish equals that of `leafcast slice`, byte by
 * byte. view_slices_want(), view_slices_seen() and view_slices_cancel() are for any thread, the
 * rest for the drawing thread.
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
    slice_request request; /* checked, not placed yet; it owns no memory */
    uint32_t box[2];       /* pixels that it has to fit into */
    bool moving;           /* only a preview is wanted */
    double asked;          /* when it was asked for, by clock_seconds() */
    view_told told;
} view_slice_wish;

typedef struct view_slices view_slices;

CHECKED status view_slices_create(const view_tools *tools, view_slices **out);
void view_slices_destroy(view_slices *s); /* NULL is allowed */

/* view_slices_want() - draw this in its pane; an older wish of the pane is forgotten.
 * view_slices_seen() - the pane's pictures up to this number are seen; the next is sent only then.
 * view_slices_cancel() - end the sampling of all panes soon. */
void view_slices_want(view_slices *s, const view_slice_wish *wish);
void view_slices_seen(view_slices *s, int pane, uint64_t number);
void view_slices_cancel(view_slices *s);

/* view_slices_clear() - reset to the state after creation. view_slices_need() - returns whether
 * there is something to do. view_slices_bytes() - returns the bytes of its planes. */
void view_slices_clear(view_slices *s);
bool view_slices_need(view_slices *s);
uint64_t view_slices_bytes(const view_slices *s);

/* view_slices_advance() - draw for about so many seconds. beside: bytes of others, which count
 * against the budget. *out: a message for the page, which the caller owns; NULL: none yet. *number,
 * *pane: of the wish that was worked on, also after an error. ST_USAGE says why it cannot be
 * drawn. */
CHECKED status view_slices_advance(view_slices *s, double seconds, uint64_t beside,
                                   view_message **out, uint64_t *number, int *pane);

#endif
