/* view_draw.h - one thread that draws for all clients, in turn.
 *
 * A client has a seat. What it wants last is drawn; what it wanted before is forgotten. What is
 * made for it waits at the seat until it is taken, and at most VIEW_UNSEEN_MAX pictures are made
 * that it has not said to have seen. All functions but view_draw_open() and view_draw_close() are
 * for one other thread, and return at once.
 */
#ifndef RENDER_VIEW_VIEW_DRAW_H
#define RENDER_VIEW_VIEW_DRAW_H

#include "render/view/view_pick.h"
#include "render/view/view_picture.h"
#include "render/view/view_slice.h"

enum { VIEW_SEATS_MAX = 16, VIEW_UNSEEN_MAX = 2, VIEW_PICKS_MAX = 16, VIEW_TEXTS_MAX = 64 };

typedef struct view_draw view_draw;
typedef struct view_seat view_seat;

/* view_draw_open() - begins the thread. threads: that write PNG. doing: what is being drawn is told
 * there. notify(): by the drawing thread, when something is there to be taken. view_draw_close() -
 * ends what is drawn, and the thread; seats are gone. NULL is fine. */
CHECKED status view_draw_open(mem *m, int threads, view_doing *doing, void (*notify)(void *ctx),
                              void *ctx, view_draw **out);
void view_draw_close(view_draw *d);

/* view_draw_sit() - NULL: all seats are taken, or no memory. view_draw_leave() - ends what is drawn
 * for it; NULL is fine. */
view_seat *view_draw_sit(view_draw *d);
void view_draw_leave(view_seat *seat);

/* view_seat_want() - draw this now. view_seat_seen() - the client has seen this picture, and all
 * before. view_seat_pick() - answer what is there in what was wanted last; false: too many are
 * open. */
void view_seat_want(view_seat *seat, const view_wish *wish);
void view_seat_seen(view_seat *seat, uint64_t number, int part);
bool view_seat_pick(view_seat *seat, int64_t id, const view_place *place);

/* view_seat_slice() - draw this slice in its pane now. view_seat_slice_seen() - the client has seen
 * the pane's picture of this number, and all before. */
void view_seat_slice(view_seat *seat, const view_slice_wish *wish);
void view_seat_slice_seen(view_seat *seat, int pane, uint64_t number);

/* view_seat_residency() - whether the client wants to know where treelets are resident, too. */
void view_seat_residency(view_seat *seat, bool on);

/* view_seat_take() - the next message for the client, the caller's; NULL: none yet. view_seat_any()
 * - whether there is one. */
view_message *view_seat_take(view_seat *seat);
bool view_seat_any(view_seat *seat);

#endif
