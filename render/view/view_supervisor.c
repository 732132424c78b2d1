#include "render/view/view_supervisor.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/clock.h"

static const int STOPPING[] = {SIGINT, SIGTERM, SIGHUP};
enum { STOPPINGS = (int)(sizeof STOPPING / sizeof *STOPPING) };

/* Block signals that ask to stop, except during the wait for the child, so that none is missed. */
static void hold_signals(sigset_t *before) {
    sigset_t stopping;
    sigemptyset(&stopping);
    for (int i = 0; i < STOPPINGS; i++)
        sigaddset(&stopping, STOPPING[i]);
    sigprocmask(SIG_BLOCK, &stopping, before);
}

status view_supervisor_open(view_supervisor *s) {
    *s = (view_supervisor){.self = getpid(), .child = -1, .channel = -1};
    void *shared =
        mmap(NULL, sizeof *s->now, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED)
        return status_describe(ST_NOMEM, "no memory to be shared by two processes");
    s->now = shared;
    signal(SIGCHLD, SIG_DFL); /* if the parent has ignored it, no end is reported */
    hold_signals(&s->before);
    return ST_OK;
}

void view_supervisor_close(view_supervisor *s) {
    if (!s->now)
        return;
    sigprocmask(SIG_SETMASK, &s->before, NULL);
    if (s->channel >= 0)
        close(s->channel);
    munmap(s->now, sizeof *s->now);
    s->now = NULL;
}

/* ---- A child ---- */

/* A terminal and `kill -- -GROUP` send a signal to both processes, and the supervisor passes it on
 * to the child. The copy must not count as a second signal, which ends a process at once. */
static void take_each_signal_once(void) {
    for (int i = 0; i < STOPPINGS; i++) {
        struct sigaction action;
        if (sigaction(STOPPING[i], NULL, &action) != 0 || action.sa_handler == SIG_IGN)
            continue;
        action.sa_flags &= (int)~SA_RESETHAND;
        sigaction(STOPPING[i], &action, NULL);
    }
}

static status settle_child(const view_supervisor *s) {
    /* End with the supervisor, which a second Ctrl-C ends at once. */
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != s->self)
        return status_describe(ST_STOPPED, "whoever watches over the drawing has ended");
    take_each_signal_once();
    sigprocmask(SIG_SETMASK, &s->before, NULL);
    return ST_OK;
}

status view_supervisor_begin(view_supervisor *s, view_life *life, bool *inside) {
    int ends[2];
    *inside = false;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        return status_describe(ST_FAILED, "no channel between processes: %s", strerror(errno));
    *s->now = (view_doing){.what = VIEW_DOING_NOTHING};
    life->now = s->now;
    s->child = fork();
    *inside = s->child == 0;
    life->channel = ends[1];
    s->channel = ends[0];
    if (*inside)
        close(ends[0]);
    else
        close(ends[1]);
    if (s->child > 0)
        return ST_OK;
    s->channel = -1;
    if (s->child == 0)
        return settle_child(s);
    close(ends[0]);
    return status_describe(ST_FAILED, "cannot begin a process: %s", strerror(errno));
}

/* ---- Its end ---- */

/* Wait until the child ends, which closes its end of the channel. Returns its stage. */
static view_stage listen_to(const view_supervisor *s, int (*asked)(void)) {
    view_stage came = VIEW_BEGINS;
    bool passed = false;
    for (;;) {
        struct pollfd end = {.fd = s->channel, .events = POLLIN};
        char word;
        if (asked() && !passed) {
            kill(s->child, asked());
            passed = true;
        }
        if (ppoll(&end, 1, NULL, &s->before) <= 0)
            continue;
        if (read(s->channel, &word, sizeof word) <= 0)
            return came;
        came = (view_stage)word;
    }
}

void view_supervisor_wait(view_supervisor *s, int (*asked)(void), view_life *life, view_end *end) {
    int how = 0;
    *end = (view_end){.came = listen_to(s, asked)};
    while (waitpid(s->child, &how, 0) < 0 && errno == EINTR) {}
    close(s->channel);
    s->channel = -1;
    s->now->told.text[sizeof s->now->told.text - 1] = 0;
    end->last = *s->now;
    if (WIFSIGNALED(how))
        end->signal = WTERMSIG(how);
    else
        end->code = WEXITSTATUS(how);
    *life = (view_life){.number = life->number + 1,
                        .signal = end->signal,
                        .last = *s->now,
                        .before = end->came > life->before ? end->came : life->before};
}

status view_supervisor_goes_on(view_supervisor *s, const view_end *end) {
    const double now = clock_seconds();
    s->crashed[s->crashes++ % VIEW_CRASHES_MOST] = now;
    const double oldest = s->crashed[s->crashes % VIEW_CRASHES_MOST];
    if (end->came < VIEW_SERVES)
        return status_describe(ST_FAILED, "it was not yet served: ended");
    if (s->crashes >= VIEW_CRASHES_MOST && now - oldest < VIEW_CRASHES_S)
        return status_describe(ST_FAILED, "drawing crashed %d times within %d seconds: ended",
                               VIEW_CRASHES_MOST, VIEW_CRASHES_S);
    return ST_OK;
}
