#include "formats/base/bus_error.h"

#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

enum { EXIT_INPUT = 3, LINE_MAX_BYTES = 5000 };

/* What the handler uses: the stack it runs on may be small. Only the first thread that comes
 * touches it. */
static const char *command_name = "";
static atomic_flag taken = ATOMIC_FLAG_INIT;
static char chunk[4096], line[LINE_MAX_BYTES];

static void say(const char *text) {
    size_t left = strlen(text);
    while (left > 0) {
        const ssize_t n = write(STDERR_FILENO, text, left);
        if (n <= 0)
            return;
        text += n;
        left -= (size_t)n;
    }
}

/* A hexadecimal number; *text ends up behind it and the character that follows. */
static uintptr_t hexadecimal(const char **text) {
    static const char digits[] = "0123456789abcdef";
    uintptr_t n = 0;
    for (const char *d; **text && (d = strchr(digits, **text)); ++*text)
        n = n << 4 | (uintptr_t)(d - digits);
    *text += **text != 0;
    return n;
}

/* "from-to perms offset device inode   /path" of /proc/self/maps: the path, if it is the file at
 * this address. */
static const char *file_on_line(const char *text, uintptr_t at) {
    const uintptr_t from = hexadecimal(&text), to = hexadecimal(&text);
    if (at < from || at >= to)
        return NULL;
    return strchr(text, '/');
}

/* Which file is mapped at an address; NULL: none. With system calls that a handler may make. */
static const char *file_at(uintptr_t at) {
    const int fd = open("/proc/self/maps", O_RDONLY | O_CLOEXEC);
    size_t used = 0;
    for (ssize_t n; fd >= 0 && (n = read(fd, chunk, sizeof chunk)) > 0;) {
        for (ssize_t i = 0; i < n; i++) {
            if (chunk[i] != '\n') {
                line[used] = chunk[i];
                used += used + 1 < sizeof line;
                continue;
            }
            line[used] = 0;
            used = 0;
            const char *path = file_on_line(line, at);
            if (path)
                return path;
        }
    }
    return NULL;
}

static void on_bus_error(int number, siginfo_t *info, void *context) {
    (void)context;
    const bool first = !atomic_flag_test_and_set(&taken);
    const char *path =
        first && info->si_code == BUS_ADRERR ? file_at((uintptr_t)info->si_addr) : NULL;
    while (!first)
        pause(); /* the other one ends the program */
    if (path) {
        say(command_name);
        say(": ");
        say(path);
        say(" became shorter while it was in use\n");
        _exit(EXIT_INPUT);
    }
    /* Once more, without a handler. */
    signal(number, SIG_DFL);
    raise(number);
}

void bus_error_install(const char *command) {
    struct sigaction action = {.sa_flags = (int)SA_SIGINFO};
    action.sa_sigaction = on_bus_error;
    command_name = command;
    sigaction(SIGBUS, &action, NULL);
}
