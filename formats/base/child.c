#include "formats/base/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/file.h"

enum { WAIT_MS = 100 };

/* ---- starting ---- */

static void close_end(int *fd) {
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

static int add_ends(posix_spawn_file_actions_t *actions, int feed, int result, int complain) {
    int error = posix_spawn_file_actions_adddup2(actions, feed, STDIN_FILENO);
    if (!error && result >= 0)
        error = posix_spawn_file_actions_adddup2(actions, result, STDOUT_FILENO);
    if (!error)
        error = posix_spawn_file_actions_adddup2(actions, complain, STDERR_FILENO);
    return error;
}

static int spawn(const char *program, char *const argv[], int feed, int result, int complain,
                 pid_t *pid) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t normal, none;
    sigemptyset(&none);
    sigemptyset(&normal);
    sigaddset(&normal, SIGPIPE);
    sigaddset(&normal, SIGXFSZ);
    int error = posix_spawn_file_actions_init(&actions);
    if (error)
        return error;
    error = posix_spawnattr_init(&attributes);
    if (!error) {
        error = add_ends(&actions, feed, result, complain);
        /* The child must not inherit the signals that this process ignores. */
        posix_spawnattr_setsigdefault(&attributes, &normal);
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
        if (!error)
            error = posix_spawn(pid, program, &actions, &attributes, argv, environ);
        posix_spawnattr_destroy(&attributes);
    }
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

status child_start(const char *program, char *const argv[], bool result, child *c) {
    int feed[2] = {-1, -1}, output[2] = {-1, -1}, complain[2] = {-1, -1};
    int error = 0;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, feed) != 0 ||
        pipe2(complain, O_CLOEXEC) != 0 || (result && pipe2(output, O_CLOEXEC) != 0))
        error = errno;
    *c = (child){.feed = feed[0], .result = output[0], .complain = complain[0]};
    if (!error)
        error = spawn(program, argv, feed[1], output[1], complain[1], &c->pid);
    close_end(&feed[1]);
    close_end(&output[1]);
    close_end(&complain[1]);
    if (!error)
        return ST_OK;
    close_end(&c->feed);
    close_end(&c->result);
    close_end(&c->complain);
    return file_failed(error, program, "cannot start");
}

/* ---- talking ---- */

void child_fed(child *c) {
    close_end(&c->feed);
}

/* Keep the end of what the child says: the reason stands there. */
static void keep_words(child *c, const char *words, size_t n) {
    const size_t room = sizeof c->words - 1;
    if (n > room) {
        words += n - room;
        n = room;
    }
    if (c->said + n > room) {
        const size_t drop = c->said + n - room;
        memmove(c->words, c->words + drop, c->said - drop);
        c->said -= drop;
    }
    memcpy(c->words + c->said, words, n);
    c->said += n;
}

/* Read what the child says. Returns whether there may be more. */
static bool read_complaint(child *c) {
    char words[STATUS_TEXT_MAX];
    const ssize_t n = read(c->complain, words, sizeof words);
    if (n > 0)
        keep_words(c, words, (size_t)n);
    return n > 0 || (n < 0 && errno == EINTR);
}

bool child_feed(child *c, const void *data, size_t size) {
    const char *at = data;
    while (size > 0) {
        struct pollfd ends[2] = {{c->feed, POLLOUT, 0}, {c->complain, POLLIN, 0}};
        const int ready = poll(ends, 2, WAIT_MS);
        if (ready > 0 && ends[1].revents && !read_complaint(c))
            close_end(&c->complain); /* poll() ignores a negative descriptor */
        if (ready > 0 && ends[0].revents) {
            const ssize_t n = send(c->feed, at, size, MSG_NOSIGNAL | MSG_DONTWAIT);
            if (n < 0 && errno != EINTR && errno != EAGAIN)
                return false;
            at += n > 0 ? n : 0;
            size -= n > 0 ? (size_t)n : 0;
        }
        if (ready <= 0 && c->wait && c->wait(c->wait_ctx) != ST_OK)
            return false;
    }
    return true;
}

status child_read(child *c, void *data, size_t size, size_t *got, status (*wait)(void *ctx),
                  void *ctx) {
    status st = ST_OK;
    bool open = true;
    *got = 0;
    while (st == ST_OK && open && *got < size) {
        struct pollfd ends[2] = {{c->result, POLLIN, 0}, {c->complain, POLLIN, 0}};
        const int ready = poll(ends, 2, WAIT_MS);
        if (ready > 0 && ends[1].revents && !read_complaint(c))
            close_end(&c->complain);
        if (ready > 0 && ends[0].revents) {
            const ssize_t n = read(c->result, (char *)data + *got, size - *got);
            open = n > 0 || (n < 0 && errno == EINTR);
            *got += n > 0 ? (size_t)n : 0;
        }
        st = wait(ctx);
    }
    return st;
}

/* ---- the end ---- */

void child_kill(child *c) {
    kill(c->pid, SIGKILL);
}

status child_end(child *c, int *code) {
    close_end(&c->feed);
    close_end(&c->result);
    while (c->complain >= 0 && read_complaint(c))
        continue;
    close_end(&c->complain);
    while (c->said > 0 && c->words[c->said - 1] == '\n')
        c->said--;
    c->words[c->said] = 0;
    int state = 0;
    while (waitpid(c->pid, &state, 0) < 0)
        if (errno != EINTR)
            return file_failed(errno, "a helper process", "cannot wait for its end");
    *code = WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
    return ST_OK;
}
