/* view_supervisor.h - the process that outlives a crash of drawing.
 *
 * It keeps what must stay: the listening socket and the token. Everything else, volumes, threads,
 * pages, lives in a child process, which draws as it would without a supervisor. When a signal ends
 * the child, another begins with the same socket. A signal that asks to stop is passed on to the
 * child, and the program ends with the child.
 */
#ifndef RENDER_VIEW_VIEW_SUPERVISOR_H
#define RENDER_VIEW_VIEW_SUPERVISOR_H

#include <signal.h>
#include <sys/types.h>

#include "formats/base/status.h"
#include "render/view/view_life.h"

/* The program ends after this many crashes within this many seconds. */
enum { VIEW_CRASHES_MOST = 5, VIEW_CRASHES_S = 60 };

typedef struct view_supervisor {
    sigset_t before; /* the signal mask from before */
    view_doing *now; /* what the child is drawing; shared memory */
    pid_t self, child;
    int channel;                       /* to the child; -1: none */
    int crashes;                       /* number of all crashes */
    double crashed[VIEW_CRASHES_MOST]; /* times of the last ones */
} view_supervisor;

/* How a child ended. */
typedef struct view_end {
    int code;        /* its exit status, if it ended by itself */
    int signal;      /* the signal that ended it, or 0 */
    view_stage came; /* its stage by then */
    view_doing last; /* what it was drawing */
} view_end;

/* view_supervisor_open() - call it before there are threads; signals that ask to stop are held back
 * from now on. view_supervisor_close() - ends no child. */
CHECKED status view_supervisor_open(view_supervisor *s);
void view_supervisor_close(view_supervisor *s);

/* view_supervisor_begin() - start another child. Returns twice; in the child *inside is true. There
 * repeated signals ask to stop only once, and the child ends with the supervisor. life: zeros for
 * the first child, then as view_supervisor_wait() left it. */
CHECKED status view_supervisor_begin(view_supervisor *s, view_life *life, bool *inside);

/* view_supervisor_wait() - wait for the child's end. asked(): returns the signal that asks to stop,
 * or 0. */
void view_supervisor_wait(view_supervisor *s, int (*asked)(void), view_life *life, view_end *end);

/* view_supervisor_goes_on() - returns ST_OK if another child may begin after a crash; ST_FAILED
 * says why not.
 */
CHECKED status view_supervisor_goes_on(view_supervisor *s, const view_end *end);

#endif
