/* view_crowd.h - connections that have not shown the token, oldest first. If there are too many,
 * the oldest is dropped.
 *
 * So a client that opens connections and sends nothing cannot lock others out: a page sends its
 * request as soon as it is connected. A connection that has shown the token leaves the crowd and
 * stays open. For one thread.
 */
#ifndef RENDER_VIEW_VIEW_CROWD_H
#define RENDER_VIEW_VIEW_CROWD_H

enum { VIEW_CROWD_MAX = 128 };

typedef struct view_crowd {
    void *who[VIEW_CROWD_MAX];
    int count;
} view_crowd;

/* view_crowd_enter() - add the newest connection. Returns the one dropped for it; NULL: none. */
void *view_crowd_enter(view_crowd *c, void *who);

/* view_crowd_leave() - remove a connection; one that is not in the crowd is allowed. */
void view_crowd_leave(view_crowd *c, const void *who);

#endif
