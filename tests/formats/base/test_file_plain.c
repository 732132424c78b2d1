/* test_file_plain.c - outputs on file systems that lack what others have: nameless files, renaming
 * without replacing, hard links, locks. The calls are replaced here, at the border to libc.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/base/partial.h"
#include "tests/support/scratch.h"

/* Which are missing, and how often each was tried. */
static struct {
    bool nameless, replacing, links, locks;
    int nameless_tried, replacing_tried, links_tried, locks_tried;
} lacks;

int open(const char *path, int flags, ...) {
    va_list args;
    va_start(args, flags);
    const int mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(args, int) : 0;
    va_end(args);
    if ((flags & O_TMPFILE) == O_TMPFILE && lacks.nameless) {
        lacks.nameless_tried++;
        errno = EOPNOTSUPP;
        return -1;
    }
    return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

int renameat2(int from_folder, const char *from, int to_folder, const char *to,
              unsigned int flags) {
    if (flags && lacks.replacing) {
        lacks.replacing_tried++;
        errno = EINVAL;
        return -1;
    }
    return (int)syscall(SYS_renameat2, from_folder, from, to_folder, to, flags);
}

int link(const char *from, const char *to) {
    if (lacks.links) {
        lacks.links_tried++;
        errno = EPERM;
        return -1;
    }
    return (int)syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0);
}

int flock(int fd, int how) {
    if (lacks.locks) {
        lacks.locks_tried++;
        errno = ENOLCK;
        return -1;
    }
    return (int)syscall(SYS_flock, fd, how);
}

static mem m;

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    memset(&lacks, 0, sizeof lacks);
    return 0;
}

static status write_text(const char *path, const char *text, bool force) {
    out_file *f = NULL;
    status st = out_file_create(&m, path, force, &f);
    if (st == ST_OK)
        st = out_file_append(f, text, strlen(text));
    if (st != ST_OK) {
        out_file_discard(f);
        return st;
    }
    return out_file_commit(f);
}

static void check_text(const char *path, const char *text) {
    char *data = scratch_read(path, NULL);
    assert_string_equal(data, text);
    free(data);
}

/* New, refused, forced, and refused because another came up meanwhile. */
static void check_outputs(void) {
    const char *path = scratch_path("out");
    out_file *f = NULL;
    assert_int_equal(write_text(path, "one", false), ST_OK);
    check_text(path, "one");
    assert_int_equal(write_text(path, "two", false), ST_EXISTS);
    check_text(path, "one");
    assert_int_equal(write_text(path, "three", true), ST_OK);
    check_text(path, "three");
    remove(path);
    assert_int_equal(out_file_create(&m, path, false, &f), ST_OK);
    scratch_text("out", "another's");
    assert_int_equal(out_file_commit(f), ST_EXISTS);
    check_text(path, "another's");
    remove(path);
    assert_int_equal(scratch_count(), 0);
    assert_int_equal(mem_used(&m), 0);
}

static void test_no_rename_flag(void **state) {
    (void)state;
    lacks.replacing = true;
    check_outputs();
    assert_int_equal(lacks.replacing_tried, 2);
}

static void test_no_links_either(void **state) {
    (void)state;
    lacks.replacing = lacks.links = true;
    check_outputs();
    assert_int_equal(lacks.links_tried, 2);
}

static void test_no_nameless_files(void **state) {
    (void)state;
    out_file *f = NULL;
    char back[4] = "";
    lacks.nameless = true;
    assert_int_equal(out_file_scratch(&m, scratch_path("out"), &f), ST_OK);
    assert_int_equal(lacks.nameless_tried, 1);
    assert_int_equal(scratch_count(), 0);
    assert_int_equal(out_file_append(f, "abc", 3), ST_OK);
    assert_int_equal(out_file_read_at(f, 0, back, 3), ST_OK);
    assert_string_equal(back, "abc");
    out_file_discard(f);
    assert_int_equal(scratch_count(), 0);
}

/* Without locks nothing can be told to be a leftover: it stays, and the next name is taken. */
static void test_no_locks(void **state) {
    (void)state;
    lacks.locks = true;
    check_outputs();
    const char *path = scratch_path("out"), *old = scratch_text("out.partial-1", "whose?");
    assert_int_equal(write_text(path, "new", false), ST_OK);
    check_text(path, "new");
    check_text(old, "whose?");
    assert_true(lacks.locks_tried > 0);
    remove(path);
    remove(old);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_no_rename_flag, set_up),
        cmocka_unit_test_setup(test_no_links_either, set_up),
        cmocka_unit_test_setup(test_no_nameless_files, set_up),
        cmocka_unit_test_setup(test_no_locks, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
