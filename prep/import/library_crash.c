#include "prep/import/library_crash.h"

#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/status.h"
#include "formats/base/text.h"

static const char *verb_name, *format_name, *input_name;
static char stack[1 << 16]; /* a crash may be that the other one is used up */

static void say(const char *text) {
    static char shown[4096];
    text_printable(shown, sizeof shown, text);
    if (write(STDERR_FILENO, shown, strlen(shown)) < 0)
        return;
}

static void crashed(int signal) {
    (void)signal;
    say("leafcast ");
    say(verb_name);
    say(": ");
    say(input_name);
    say(": the library for ");
    say(format_name);
    say(" crashed on it: it is damaged");
    if (write(STDERR_FILENO, "\n", 1) != 1)
        _exit(status_exit_code(ST_FAILED));
    _exit(status_exit_code(ST_CORRUPT));
}

void library_crash_install(const char *verb, const char *format, const char *input) {
    static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    const stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    struct sigaction act = {.sa_handler = crashed, .sa_flags = (int)(SA_ONSTACK | SA_RESETHAND)};
    verb_name = verb;
    format_name = format;
    input_name = input;
    if (sigaltstack(&other, NULL) != 0)
        return;
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        sigaction(signals[i], &act, NULL);
}
