/* test_partial.c - temporary names: what a killed run left goes, what a live one writes stays. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/base/partial.h"
#include "tests/support/scratch.h"

enum { PATH_ROOM = 512 };

static struct {
    int calls;
    bool removed;
    uint64_t bytes;
    char name[PATH_ROOM];
} said;

static void listen_to(const char *name, uint64_t bytes, bool removed) {
    said.calls++;
    said.removed = removed;
    said.bytes = bytes;
    snprintf(said.name, sizeof said.name, "%s", name);
}

static int set_up(void **state) {
    (void)state;
    memset(&said, 0, sizeof said);
    partial_on_leftover(listen_to);
    return 0;
}

static const char *slot(int n) {
    char name[32];
    snprintf(name, sizeof name, "out.partial-%d", n);
    return scratch_path(name);
}

/* Another process that writes so many bytes to the output and waits; killed by the caller. */
static pid_t start_writer(const char *path, size_t bytes) {
    int ready[2];
    assert_int_equal(pipe(ready), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        char name[PATH_ROOM];
        const int fd = partial_open(path, name);
        for (size_t i = 0; i < bytes; i++)
            if (fd < 0 || write(fd, "x", 1) != 1)
                _exit(1);
        if (write(ready[1], "!", 1) != 1)
            _exit(1);
        for (;;)
            pause();
    }
    char byte;
    assert_int_equal(read(ready[0], &byte, 1), 1);
    close(ready[0]);
    close(ready[1]);
    return pid;
}

static void kill_writer(pid_t pid) {
    int code;
    assert_int_equal(kill(pid, SIGKILL), 0);
    assert_int_equal(waitpid(pid, &code, 0), pid);
    assert_true(WIFSIGNALED(code));
}

static void test_killed(void **state) {
    (void)state;
    const char *path = scratch_path("out");
    char out[PATH_ROOM], name[PATH_ROOM];
    snprintf(out, sizeof out, "%s", path);
    const pid_t first = start_writer(out, 7), second = start_writer(out, 9);
    assert_int_equal(scratch_count(), 2);
    /* Both live: nothing is removed. */
    int fd = partial_open(out, name);
    assert_string_equal(name, slot(3));
    assert_int_equal(said.calls, 0);
    assert_int_equal(scratch_count(), 3);
    close(fd);
    unlink(name);
    /* The second is killed: its file goes, the other stays. */
    kill_writer(second);
    assert_int_equal(access(slot(2), F_OK), 0);
    fd = partial_open(out, name);
    assert_int_equal(said.calls, 1);
    assert_true(said.removed && said.bytes == 9);
    assert_string_equal(said.name, slot(2));
    assert_string_equal(name, slot(2));
    struct stat info;
    assert_int_equal(fstat(fd, &info), 0);
    assert_int_equal(info.st_size, 0);
    assert_int_equal(stat(slot(1), &info), 0);
    assert_int_equal(info.st_size, 7);
    close(fd);
    unlink(name);
    kill_writer(first);
    fd = partial_open(out, name);
    assert_int_equal(said.calls, 2);
    assert_string_equal(name, slot(1));
    close(fd);
    unlink(name);
    assert_int_equal(scratch_count(), 0);
}

/* Symbolic links, folders, FIFOs under the temporary names: neither followed nor touched. */
static void test_in_the_way(void **state) {
    (void)state;
    char out[PATH_ROOM], victim[PATH_ROOM], name[PATH_ROOM];
    snprintf(out, sizeof out, "%s", scratch_path("out"));
    snprintf(victim, sizeof victim, "%s", scratch_text("victim", "precious"));
    assert_int_equal(symlink(victim, slot(1)), 0);
    assert_int_equal(mkdir(slot(2), 0777), 0);
    assert_int_equal(mkfifo(slot(3), 0666), 0);
    assert_int_equal(symlink(scratch_path("none"), slot(4)), 0);
    int fd = partial_open(out, name);
    assert_string_equal(name, slot(5));
    assert_int_equal(write(fd, "x", 1), 1);
    close(fd);
    unlink(name);
    for (int i = 5; i <= PARTIAL_SLOTS; i++)
        assert_int_equal(symlink(victim, slot(i)), 0);
    fd = partial_open(out, name);
    assert_true(fd >= 0);
    assert_int_equal(strlen(name), strlen(out) + strlen(".partial-") + 16);
    assert_int_equal(write(fd, "x", 1), 1);
    close(fd);
    unlink(name);
    assert_int_equal(said.calls, 0);
    char *data = scratch_read(victim, NULL);
    assert_string_equal(data, "precious");
    free(data);
    assert_int_equal(access(scratch_path("none"), F_OK), -1);
    for (int i = 1; i <= PARTIAL_SLOTS; i++)
        remove(slot(i));
    remove(victim);
    assert_int_equal(scratch_count(), 0);
}

static void test_refused(void **state) {
    (void)state;
    char name[PATH_ROOM];
    assert_int_equal(partial_open("/no/such/folder/x", name), -1);
    assert_int_equal(errno, ENOENT);
    assert_int_equal(said.calls, 0);
}

/* Stands before the system's own: numbers that are not random, or none. */
static enum { RANDOM, SAME, NONE } numbers = RANDOM;

ssize_t getrandom(void *to, size_t size, unsigned flags) {
    if (numbers == RANDOM)
        return syscall(SYS_getrandom, to, size, flags);
    errno = ENOSYS;
    memset(to, 7, size);
    return numbers == SAME ? (ssize_t)size : -1;
}

/* Every name is taken, or none can be made up: told by its own error. */
static void test_no_name(void **state) {
    (void)state;
    char out[PATH_ROOM], name[PATH_ROOM];
    snprintf(out, sizeof out, "%s", scratch_path("out"));
    for (int i = 1; i <= PARTIAL_SLOTS; i++)
        assert_int_equal(mkdir(slot(i), 0777), 0);
    numbers = NONE;
    assert_int_equal(partial_open(out, name), -1);
    assert_int_equal(errno, ENOSYS);
    numbers = SAME;
    const int fd = partial_open(out, name);
    assert_true(fd >= 0);
    assert_int_equal(partial_open(out, name), -1);
    assert_int_equal(errno, EBUSY);
    numbers = RANDOM;
    close(fd);
    unlink(name);
    for (int i = 1; i <= PARTIAL_SLOTS; i++)
        remove(slot(i));
    assert_int_equal(scratch_count(), 0);
}

/* One of the crowd: over and over, begin the output and finish, give up or be killed. Exit status 1
 * when its file did not stay its own. */
static int crowd_member(const char *path, unsigned seed) {
    mem m;
    mem_init(&m, 0);
    for (int i = 0; i < 60; i++) {
        out_file *f = NULL;
        char mark[32], back[32] = "";
        struct stat named;
        seed = seed * 1103515245u + 12345u;
        const int length = snprintf(mark, sizeof mark, "%ld-%d", (long)getpid(), i);
        if (out_file_create(&m, path, true, &f) != ST_OK)
            return 1;
        if (out_file_append(f, mark, (size_t)length) != ST_OK)
            return 1;
        usleep(seed >> 16 & 255);
        if (out_file_read_at(f, 0, back, (size_t)length) != ST_OK || strcmp(mark, back) != 0)
            return 1;
        if (stat(out_file_temporary(f), &named) != 0 || named.st_size != length)
            return 1;
        const unsigned end = seed >> 24 & 7;
        if (end == 0)
            raise(SIGKILL);
        if (end < 4 && out_file_commit(f) != ST_OK)
            return 1;
        if (end >= 4)
            out_file_discard(f);
    }
    return 0;
}

static void test_crowd(void **state) {
    (void)state;
    enum { MEMBERS = 6, MOST = 80 };
    char out[PATH_ROOM];
    snprintf(out, sizeof out, "%s", scratch_path("out"));
    partial_on_leftover(NULL);
    int started = 0, ended = 0, killed = 0;
    while (ended < MOST) {
        for (; started < MOST && started < ended + MEMBERS; started++) {
            const pid_t pid = fork();
            assert_true(pid >= 0);
            if (pid == 0)
                _exit(crowd_member(out, (unsigned)started + 1));
        }
        int code;
        assert_true(wait(&code) > 0);
        ended++;
        killed += WIFSIGNALED(code);
        if (WIFEXITED(code))
            assert_int_equal(WEXITSTATUS(code), 0);
    }
    assert_true(killed > MEMBERS);
    /* What the last ones left goes with the next. */
    mem m;
    mem_init(&m, 0);
    out_file *f = NULL;
    assert_int_equal(out_file_create(&m, out, true, &f), ST_OK);
    out_file_discard(f);
    remove(out);
    assert_int_equal(scratch_count(), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_killed, set_up),
        cmocka_unit_test_setup(test_in_the_way, set_up),
        cmocka_unit_test_setup(test_refused, set_up),
        cmocka_unit_test_setup(test_no_name, set_up),
        cmocka_unit_test_setup(test_crowd, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
