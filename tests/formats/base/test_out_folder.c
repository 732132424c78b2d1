/* test_out_folder.c - folders as outputs: they appear when they are complete, replace nothing, and
 * leave nothing behind where writing fails.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/out_folder.h"
#include "formats/base/partial.h"
#include "tests/support/scratch.h"

static bool is_there(const char *name) {
    struct stat info;
    return lstat(scratch_path(name), &info) == 0;
}

static void make_folder(const char *name) {
    assert_int_equal(mkdir(scratch_path(name), 0777), 0);
}

static void make_file(const char *name, const char *text) {
    FILE *f = fopen(scratch_path(name), "w");
    assert_non_null(f);
    assert_true(fputs(text, f) >= 0);
    assert_int_equal(fclose(f), 0);
}

static void remove_folder(const char *name) {
    uint64_t bytes;
    assert_true(partial_remove_folder(scratch_path(name), &bytes));
}

/* Two files, then the end. */
static status try_folder(const char *name) {
    mem m;
    out_folder *f = NULL;
    mem_init(&m, 0);
    status st = out_folder_create(&m, scratch_path(name), &f);
    if (st == ST_OK)
        st = out_folder_put(f, "a", "hello", 5);
    if (st == ST_OK)
        st = out_folder_put(f, "b/c/d", "", 0);
    assert_true(st != ST_OK || !is_there(name));
    if (st == ST_OK)
        st = out_folder_commit(f);
    else
        out_folder_discard(f);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static void test_complete(void **state) {
    (void)state;
    char text[8] = "";
    assert_int_equal(try_folder("whole"), ST_OK);
    FILE *f = fopen(scratch_path("whole/a"), "r");
    assert_non_null(f);
    assert_int_equal(fread(text, 1, sizeof text, f), 5);
    fclose(f);
    assert_string_equal(text, "hello");
    assert_true(is_there("whole/b/c/d"));
    assert_false(is_there("whole.partial-1"));
    assert_int_equal(try_folder("whole"), ST_EXISTS);
    remove_folder("whole");
}

/* Whatever has the name keeps it, also when it comes while the folder is written. */
static void test_taken(void **state) {
    (void)state;
    mem m;
    out_folder *f = NULL;
    mem_init(&m, 0);
    make_file("file", "mine");
    make_folder("empty");
    assert_int_equal(symlink("nowhere", scratch_path("link")), 0);
    assert_int_equal(try_folder("file"), ST_EXISTS);
    assert_int_equal(try_folder("empty"), ST_EXISTS);
    assert_int_equal(try_folder("link"), ST_EXISTS);
    assert_int_equal(out_folder_check("-"), ST_USAGE);
    assert_int_equal(out_folder_check(""), ST_USAGE);
    assert_int_equal(out_folder_check("/"), ST_USAGE);
    assert_int_equal(out_folder_create(&m, scratch_path("late"), &f), ST_OK);
    assert_int_equal(out_folder_put(f, "a", "x", 1), ST_OK);
    assert_int_equal(out_folder_put(f, "a", "y", 1), ST_IO);
    make_folder("late");
    assert_int_equal(out_folder_commit(f), ST_EXISTS);
    assert_false(is_there("late/a"));
    assert_false(is_there("late.partial-1"));
    assert_int_equal(mem_used(&m), 0);
}

/* Each write and allocation fails once. */
static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE};
    for (int i = 0; i < 2; i++) {
        status st = ST_IO;
        for (long k = 1; st != ST_OK; k++) {
            fault_arm(kinds[i], k);
            st = try_folder("faulty");
            assert_int_equal(st, !fault_fired(kinds[i]) ? ST_OK : i ? ST_NOSPACE : ST_NOMEM);
            fault_arm(kinds[i], 0);
            assert_true(is_there("faulty") == (st == ST_OK));
            assert_false(is_there("faulty.partial-1"));
            assert_true(k < 20);
        }
        remove_folder("faulty");
    }
}

/* What is locked is being written; what is not, a killed run left; a file of that name stays. */
static void test_leftovers(void **state) {
    (void)state;
    make_folder("x.partial-1");
    make_folder("x.partial-1/deep");
    make_file("x.partial-1/deep/file", "left");
    make_folder("outside");
    make_file("outside/file", "mine");
    assert_int_equal(symlink("../outside", scratch_path("x.partial-1/link")), 0);
    make_folder("x.partial-2");
    const int other = open(scratch_path("x.partial-2"), O_RDONLY | O_DIRECTORY);
    assert_int_equal(flock(other, LOCK_EX), 0);
    make_file("x.partial-3", "a file");
    assert_int_equal(try_folder("x"), ST_OK);
    assert_false(is_there("x.partial-1"));
    assert_true(is_there("x.partial-2"));
    assert_true(is_there("x.partial-3"));
    assert_true(is_there("outside/file"));
    close(other);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_complete),
        cmocka_unit_test(test_taken),
        cmocka_unit_test(test_faults),
        cmocka_unit_test(test_leftovers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
