#include "prep/import/crash.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/status.h"
#include "formats/base/text.h"

enum { STACK_BYTES = 64 << 10, PATH_SHOWN = 512 };

/* Made ahead: little may be called by then. */
static char line[1024];
static char stack[STACK_BYTES]; /* the thread's own may be used up */

static void on_crash(int number) {
    (void)number;
    const ssize_t written = write(STDERR_FILENO, line, strlen(line));
    (void)written;
    _exit(status_exit_code(ST_CORRUPT));
}

void crash_watch(const char *verb, const char *library, const char *path) {
    static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    char shown[PATH_SHOWN];
    snprintf(line, sizeof line,
             "leafcast %s: %s: %s crashed while reading it; the file is likely malformed\n", verb,
             text_printable(shown, sizeof shown, path), library);
    const stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    sigaltstack(&other, NULL);
    struct sigaction action = {.sa_handler = on_crash,
                               .sa_flags = (int)(SA_ONSTACK | SA_RESETHAND)};
    sigemptyset(&action.sa_mask);
    for (unsigned i = 0; i < sizeof signals / sizeof *signals; i++)
        sigaction(signals[i], &action, NULL);
}
