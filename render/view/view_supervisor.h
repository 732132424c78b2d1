/* view_supervisor.h - the process that outlives a crash of drawing.
 *
 * It holds what must stay: the socket that listens and the token. All else, volumes, threads,
 * pages, is in a child, so that a picture takes no other way than without a supervisor. When a
 * signal ends the child, another one begins at the same socket. A signal that asks to stop is
 * passed on to the child, whose end is then the program's.
 */
#ifndef RENDER_VIEW_VIEW_SUPERVISOR_H
#define RENDER_VIEW_VIEW_SUPERVISOR_H

#include <signal.h>
#include <sys/types.h>

#include "formats/base/status.h"
#include "render/view/view_life.h"

/* So many crashes within so many seconds are too many: the program ends. */
enum { VIEW_CRASHES_MOST = 5, VIEW_CRASHES_S = 60 };

typedef struct view_supervisor {
    sigset_t before; /* the mask that signals had */
    view_doing *now; /* what the child is at */
    pid_t self, child;
    int channel;                       /* to the child */
    int crashes;                       /* all of them, */
    double crashed[VIEW_CRASHES_MOST]; /* and when the last ones were */
} view_supervisor;

/* How a child ended. */
typedef struct view_end {
    int code;        /* its exit status, where it ended by itself; */
    int signal;      /* 0; else the signal that ended it, */
    view_stage came; /* how far it had come by then, */
    view_doing last; /* and what it was at */
} view_end;

/* view_supervisor_open() - before there are threads; signals that ask to stop wait from now on.
 * view_supervisor_close() - ends no child. */
CHECKED status view_supervisor_open(view_supervisor *s);
void view_supervisor_close(view_supervisor *s);

/* view_supervisor_begin() - another child. Returns twice: in it *inside is true. There a repeated
 * signal asks only once, and the supervisor's end is its own. life: zeros for the first one, then
 * what view_supervisor_wait() made of it. */
CHECKED status view_supervisor_begin(view_supervisor *s, view_life *life, bool *inside);

/* view_supervisor_wait() - for the child's end. asked(): the signal that asks to stop, or 0. */
void view_supervisor_wait(view_supervisor *s, int (*asked)(void), view_life *life, view_end *end);

/* view_supervisor_goes_on() - after a crash: whether another child may begin. ST_FAILED: why not.
 */
CHECKED status view_supervisor_goes_on(view_supervisor *s, const view_end *end);

#endif
