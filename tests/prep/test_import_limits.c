/* test_import_limits.c - an importer's memory and CPU time: what ends it, what it is given anew.
 * marks: long */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "prep/import/crash.h"
#include "prep/import/import_limits.h"
#include "tests/support/watched.h"

/* The exit code of a process that runs this, or 128 + a signal. */
static int code_of(void (*run)(void)) {
    int state = 0;
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        /* What a harness is limited to is not what is tested. */
        const struct rlimit none = {RLIM_INFINITY, RLIM_INFINITY};
        if (setrlimit(RLIMIT_CPU, &none) != 0 || close(STDERR_FILENO) != 0)
            _exit(99);
        run();
        _exit(0);
    }
    assert_int_equal(waitpid(pid, &state, 0), pid);
    return WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
}

static double used(void) {
    struct rusage r;
    getrusage(RUSAGE_SELF, &r);
    return (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) +
           1e-6 * (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec);
}

/* Seconds of CPU: sleeping takes none. */
static void work(double seconds) {
    const double end = used() + seconds;
    while (used() < end)
        continue;
}

static void begin_with(uint32_t patience) {
    crash_watch("import-x", "the library", "F");
    import_limits_begin((size_t)1 << 30, patience);
}

static void begin(void) {
    begin_with(1);
}

static void hang(void) {
    begin();
    work(60);
}

static rlim_t limit_now(void) {
    struct rlimit limit = {0, 0};
    getrlimit(RLIMIT_CPU, &limit);
    return limit.rlim_cur;
}

/* The limit moves with what is done. It is far away: a machine that is stopped for seconds may
 * charge them to this process. */
static void go_on(void) {
    begin_with(30);
    const rlim_t before = limit_now();
    work(2.1);
    import_limits_progress();
    if (limit_now() <= before)
        _exit(1);
}

static void read_much(void) {
    begin();
    import_limits_opened((uint64_t)1 << 40);
    work(3.5);
}

static void hang_at_end(void) {
    begin();
    crash_done(7);
    work(60);
}

static void test_time(void **state) {
    (void)state;
    assert_int_equal(code_of(hang), 4);
    assert_int_equal(code_of(go_on), 0);
    assert_int_equal(code_of(read_much), 0);
    assert_int_equal(code_of(hang_at_end), 7);
}

/* A limit of the caller's own holds for all of it. */
static void limited_by_caller(void) {
    const struct rlimit one = {1, RLIM_INFINITY};
    if (setrlimit(RLIMIT_CPU, &one) == 0)
        go_on();
}

static void test_own_time(void **state) {
    (void)state;
    assert_int_equal(code_of(limited_by_caller), 4);
}

static volatile char *blocks[64];

static void fill(void) {
    import_limits_begin((size_t)64 << 20, 1);
    for (int i = 0; i < 64; i++) {
        blocks[i] = malloc((size_t)64 << 20);
        if (!blocks[i]) {
            size_t bytes;
            raise(import_limits_short(&bytes) ? SIGUSR1 : SIGUSR2);
        }
        blocks[i][0] = 1;
    }
}

static void test_memory(void **state) {
    (void)state;
    if (WATCHED)
        skip();
    assert_int_equal(code_of(fill), 128 + SIGUSR1);
}

/* What no machine has is a file's fault. */
static void test_refused(void **state) {
    (void)state;
    size_t bytes = 1;
    assert_false(import_limits_short(&bytes));
    assert_int_equal(bytes, 0);
    import_limits_refused((size_t)1 << 60);
    assert_false(import_limits_short(&bytes));
    import_limits_refused(12345);
    import_limits_refused(99);
    assert_true(import_limits_short(&bytes));
    assert_int_equal(bytes, 12345);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_time), cmocka_unit_test(test_own_time),
                                       cmocka_unit_test(test_memory),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
