/* view_draw.h - one thread that draws for all clients, in turn.
 *
 * Each client has a seat. Only its newest wish is drawn; older ones are forgotten. Results wait at
 * the seat until they are taken. At most VIEW_UNSEEN_MAX pictures are made that the client has not
 * reported as seen. All functions but view_draw_open() and view_draw_close() are for one other
 * thread, and return at once.
 */
#ifndef RENDER_VIEW_VIEW_DRAW_H
#define RENDER_VIEW_VIEW_DRAW_H

#include "render/view/view_pick.h"
#include "render/view/view_picture.h"
#include "render/view/view_slice.h"
#include "render/view/view_volume.h"

enum { VIEW_SEATS_MAX = 16, VIEW_UNSEEN_MAX = 2, VIEW_PICKS_MAX = 16, VIEW_TEXTS_MAX = 64 };

typedef struct view_draw view_draw;
typedef struct view_seat view_seat;

/* view_draw_open() - start the thread. files: what is drawn, as long as it is open. threads: number
 * of threads that write PNG. doing: is kept up to date with what is being drawn. notify(): called
 * by the drawing thread when a message can be taken. view_draw_close() - end drawing, the thread
 * and all seats; NULL is allowed. */
CHECKED status view_draw_open(mem *m, const view_file *files, int count, int threads,
                              view_doing *doing, void (*notify)(void *ctx), void *ctx,
                              view_draw **out);
void view_draw_close(view_draw *d);

/* view_draw_sent() - free a picture as a file that view_seat_take() gave, or any other message:
 * what waits for its memory may be drawn. d may be NULL, when drawing has ended, and so may the
 * message. */
void view_draw_sent(view_draw *d, view_message *file);

/* view_draw_refresh() - take in the steps that have come to the files (leafcast_refresh()), between
 * two turns. What fails is tried again with a later call. */
void view_draw_refresh(view_draw *d);

/* Why a file takes in no further steps. number: 0: nothing is wrong; else another one for each
 * reason. */
enum { VIEW_WHY_MAX = 512 };
typedef struct view_stuck {
    uint32_t number;
    char why[VIEW_WHY_MAX];
} view_stuck;

/* view_draw_sit() - returns a free seat; NULL: all are taken, or no memory. view_draw_leave() - end
 * what is drawn for the seat and free it; NULL is allowed. */
view_seat *view_draw_sit(view_draw *d);
void view_draw_leave(view_seat *seat);

/* view_seat_want() - draw this now. view_seat_seen() - the client has seen this picture and all
 * before it. view_seat_pick() - answer what is at a place of the newest wish; false: too many picks
 * are waiting, or no wish came yet. */
void view_seat_want(view_seat *seat, const view_wish *wish);
void view_seat_seen(view_seat *seat, uint64_t number, int part);
bool view_seat_pick(view_seat *seat, int64_t id, const view_place *place);

/* view_seat_slice() - draw this slice in its pane now. view_seat_slice_seen() - the client has seen
 * the pane's picture of this number and all before it. */
void view_seat_slice(view_seat *seat, const view_slice_wish *wish);
void view_seat_slice_seen(view_seat *seat, int pane, uint64_t number);

/* view_seat_residency() - set what the client also gets of what is in memory: maps of treelets, and
 * how much of each step. */
typedef struct view_residency {
    bool map, steps;
} view_residency;
void view_seat_residency(view_seat *seat, const view_residency *wanted);

/* view_seat_stuck() - whether a file could not be refreshed the last time. */
view_stuck view_seat_stuck(view_seat *seat, int file);

/* view_seat_take() - returns the next message for the client, which the caller owns; NULL: none
 * yet. view_seat_any() - returns whether there is one. */
view_message *view_seat_take(view_seat *seat);
bool view_seat_any(view_seat *seat);

#endif
