#include "formats/base/bus_error.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "formats/base/status.h"
#include "formats/base/text.h"

enum { LINE_MAX_BYTES = 5000 };

/* The handler's buffers are static, as the stack it runs on may be small. Only the thread that took
 * the flag uses them. */
static const char *command_name = "";
static uintptr_t page_bytes;
static atomic_flag taken = ATOMIC_FLAG_INIT;
static char chunk[4096], line[LINE_MAX_BYTES], shown[LINE_MAX_BYTES];

/* The page that this thread last found missing. */
static _Thread_local uintptr_t missed;

/* ---- using only system calls that a handler may make ---- */

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

static _Noreturn void end(const char *path, const char *what, status st) {
    say(command_name);
    say(": ");
    say(text_printable(shown, sizeof shown, path));
    say(what);
    _exit(status_exit_code(st));
}

/* Parse a hexadecimal number; moves *text behind it and the character that follows. */
static uintptr_t hexadecimal(const char **text) {
    static const char digits[] = "0123456789abcdef";
    uintptr_t n = 0;
    for (const char *d; **text && (d = strchr(digits, **text)); ++*text)
        n = n << 4 | (uintptr_t)(d - digits);
    *text += **text != 0;
    return n;
}

/* What is mapped at a page: a file, from byte `offset` on. */
typedef struct mapping {
    const char *path;
    uint64_t offset;
} mapping;

/* Parse "from-to perms offset device inode   /path" of /proc/self/maps. Returns whether the line
 * maps this page to a file. */
static bool mapping_on_line(const char *text, uintptr_t page, mapping *p) {
    const uintptr_t from = hexadecimal(&text), to = hexadecimal(&text);
    if (page < from || page >= to)
        return false;
    text += strcspn(text, " ");
    text += *text != 0;
    p->offset = hexadecimal(&text) + (page - from);
    p->path = strchr(text, '/');
    return p->path != NULL;
}

/* Find the file that is mapped at a page; false: none. */
static bool mapping_of(uintptr_t page, mapping *p) {
    const int fd = open("/proc/self/maps", O_RDONLY | O_CLOEXEC);
    size_t used = 0;
    bool found = false;
    for (ssize_t n; fd >= 0 && !found && (n = read(fd, chunk, sizeof chunk)) > 0;) {
        for (ssize_t i = 0; i < n && !found; i++) {
            if (chunk[i] != '\n') {
                line[used] = chunk[i];
                used += used + 1 < sizeof line;
                continue;
            }
            line[used] = 0;
            used = 0;
            found = mapping_on_line(line, page, p);
        }
    }
    if (fd >= 0)
        close(fd);
    return found;
}

static bool ends_before(const mapping *p) {
    struct stat info;
    return stat(p->path, &info) == 0 && (uint64_t)info.st_size <= p->offset;
}

/* Handle a missing page of a file: return to try again, or end the program. */
static void tell(const mapping *p, uintptr_t page) {
    if (ends_before(p))
        end(p->path, " became shorter while it was in use\n", ST_CORRUPT);
    /* The file may have been cut and have grown again: then a second access succeeds. */
    if (missed == page)
        end(p->path, " could not be read\n", ST_IO);
    missed = page;
}

static void on_bus_error(int number, siginfo_t *info, void *context) {
    const struct timespec moment = {.tv_nsec = 1000000};
    const uintptr_t page = (uintptr_t)info->si_addr & ~(page_bytes - 1);
    const int error = errno;
    mapping p;
    (void)context;
    while (atomic_flag_test_and_set(&taken))
        nanosleep(&moment, NULL);
    if (info->si_code == BUS_ADRERR && mapping_of(page, &p)) {
        tell(&p, page);
    } else {
        /* Raise it again, without a handler. */
        signal(number, SIG_DFL);
        raise(number);
    }
    atomic_flag_clear(&taken);
    errno = error;
}

void bus_error_install(const char *command) {
    struct sigaction action = {.sa_flags = (int)SA_SIGINFO};
    action.sa_sigaction = on_bus_error;
    command_name = command;
    page_bytes = (uintptr_t)sysconf(_SC_PAGESIZE);
    sigaction(SIGBUS, &action, NULL);
}

bool bus_error_installed(void) {
    return *command_name != 0;
}
