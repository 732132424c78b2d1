/* view_crowd.h - connections that may be anybody's, oldest first: where there are too many, the
 * oldest has to go.
 *
 * So whoever opens connections and says nothing keeps nobody out: a page asks for what it needs as
 * soon as it is connected. Whoever has shown the token leaves the crowd, and stays. For one thread.
 */
#ifndef RENDER_VIEW_VIEW_CROWD_H
#define RENDER_VIEW_VIEW_CROWD_H

enum { VIEW_CROWD_MAX = 128 };

typedef struct view_crowd {
    void *who[VIEW_CROWD_MAX];
    int count;
} view_crowd;

/* view_crowd_enter() - the newest. Returns who has left for it; NULL: nobody. */
void *view_crowd_enter(view_crowd *c, void *who);

/* view_crowd_leave() - who is not in it is fine. */
void view_crowd_leave(view_crowd *c, const void *who);

#endif
