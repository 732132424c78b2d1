#include "prep/import/crash.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/status.h"
#include "formats/base/text.h"
#include "prep/import/import_limits.h"

enum { STACK_BYTES = 64 << 10, PATH_SHOWN = 512 };

typedef enum crash_kind { MALFORMED, NO_MEMORY, NO_TIME, BEHIND_ITS_END, KINDS } crash_kind;

/* Prepared ahead, since a signal handler may call little. These first texts are for a library that
 * crashes while it is loaded, which is not a file's fault. */
static char lines[KINDS][1024] = {
    [MALFORMED] = "leafcast import: a library crashed before it read anything\n",
    [NO_MEMORY] = "leafcast import: a library ran out of memory before it read anything\n",
    [NO_TIME] = "leafcast import: a library took too much CPU time before it read anything\n"};
static status meaning[KINDS] = {
    [MALFORMED] = ST_FAILED, [NO_MEMORY] = ST_NOMEM, [NO_TIME] = ST_NOMEM};
static char stack[STACK_BYTES]; /* signal stack: the thread's own may be used up */
static atomic_int done = -1;    /* the exit code, once it is known */

static crash_kind kind_of(int number) {
    size_t bytes;
    if (done >= 0)
        return BEHIND_ITS_END;
    if (number == SIGXCPU)
        return NO_TIME;
    return import_limits_short(&bytes) ? NO_MEMORY : MALFORMED;
}

static void on_crash(int number) {
    const crash_kind kind = kind_of(number);
    const ssize_t written = write(STDERR_FILENO, lines[kind], strlen(lines[kind]));
    (void)written;
    _exit(kind == BEHIND_ITS_END ? done : status_exit_code(meaning[kind]));
}

static void prepare(crash_kind kind, const char *verb, const char *path, const char *library,
                    const char *what) {
    char shown[PATH_SHOWN];
    snprintf(lines[kind], sizeof lines[kind], "leafcast %s: %s: %s %s\n", verb,
             text_printable(shown, sizeof shown, path), library, what);
}

void crash_begin(void) {
    static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU};
    const stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    sigaltstack(&other, NULL);
    struct sigaction action = {.sa_handler = on_crash,
                               .sa_flags = (int)(SA_ONSTACK | SA_RESETHAND)};
    sigemptyset(&action.sa_mask);
    for (unsigned i = 0; i < sizeof signals / sizeof *signals; i++)
        sigaction(signals[i], &action, NULL);
}

/* Some libraries end the program where they get no memory, and say nothing. */
static void on_exit_of_library(void) {
    if (done < 0)
        on_crash(SIGABRT);
}

void crash_watch(const char *verb, const char *library, const char *path) {
    prepare(MALFORMED, verb, path, library,
            "crashed while reading it; the file is likely malformed");
    prepare(NO_MEMORY, verb, path, library,
            "ran out of memory while reading it, and crashed; --memory gives it more");
    prepare(NO_TIME, verb, path, library,
            "took too much CPU time without a slice done; the file is likely malformed (ulimit -t "
            "SECONDS allows more)");
    prepare(BEHIND_ITS_END, verb, path, library,
            "crashed while closing it; nothing of the output is missing");
    meaning[MALFORMED] = ST_CORRUPT;
    (void)atexit(on_exit_of_library);
    crash_begin();
}

void crash_done(int code) {
    done = code;
}
