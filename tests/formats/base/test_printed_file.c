/* test_printed_file.c - a file of what is printed is whole, or not there. */
/* marks: plain */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/printed_file.h"
#include "tests/support/scratch.h"

enum { LINES = 4000000, LINE_BYTES = 8 };

static const char *path;
static mem budget;

static int set_up(void **state) {
    (void)state;
    mem_init(&budget, 0);
    path = scratch_path("table.csv");
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    return mem_used(&budget) != 0;
}

static void print_lines(const void *ctx, FILE *out) {
    const int *lines = ctx;
    for (int i = 0; i < *lines; i++)
        fprintf(out, "%07d\n", i);
}

static status write_lines(int lines) {
    unlink(path);
    return printed_file_write(&budget, path, false, print_lines, &lines);
}

/* All lines, in order. */
static void check_lines(int lines) {
    char line[LINE_BYTES + 1];
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    for (int i = 0; i < lines; i++) {
        assert_int_equal(fread(line, 1, LINE_BYTES, f), LINE_BYTES);
        assert_int_equal(atoi(line), i);
    }
    assert_int_equal(fgetc(f), EOF);
    fclose(f);
}

static void test_whole(void **state) {
    (void)state;
    for (int lines = 0; lines < 3000; lines = 3 * lines + 1) {
        assert_int_equal(write_lines(lines), ST_OK);
        check_lines(lines);
    }
    assert_int_equal(printed_file_write(&budget, path, false, print_lines, &(int){1}), ST_EXISTS);
}

/* Address space for less than half of it. */
static void test_little_memory(void **state) {
    (void)state;
    struct rlimit before, now;
    long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    assert_non_null(f);
    assert_int_equal(fscanf(f, "%ld", &pages), 1);
    fclose(f);
    assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
    now = before;
    now.rlim_cur = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + LINES * LINE_BYTES / 2;
    assert_int_equal(setrlimit(RLIMIT_AS, &now), 0);
    const status st = write_lines(LINES);
    assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
    assert_int_equal(st, ST_OK);
    check_lines(LINES);
}

static void test_no_space(void **state) {
    (void)state;
    struct rlimit before, now;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    for (rlim_t size = 0; size <= 20000; size += 5000) {
        now = before;
        now.rlim_cur = size;
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &now), 0);
        const status st = write_lines(2600); /* 20800 bytes */
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
        assert_int_equal(st, ST_NOSPACE);
        assert_int_not_equal(access(path, F_OK), 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole),
        cmocka_unit_test(test_little_memory),
        cmocka_unit_test(test_no_space),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
