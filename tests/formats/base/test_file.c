/* test_file.c - files read at offsets; outputs that appear complete or not at all, also when the
 * disk is full.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/file.h"
#include "tests/support/scratch.h"

static mem m;

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

/* Nothing is left in memory, and so many files in the folder. */
static void check_left(size_t files) {
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(scratch_count(), files);
}

static void check_content(const char *path, const char *text) {
    char *data = scratch_read(path, NULL);
    assert_string_equal(data, text);
    free(data);
}

static void test_read(void **state) {
    (void)state;
    const char *path = scratch_text("read", "0123456789");
    file *f;
    char buffer[16] = "";
    assert_int_equal(file_open(&m, path, &f), ST_OK);
    assert_int_equal(file_size(f), 10);
    assert_int_equal(file_read_at(f, 7, buffer, 3), ST_OK);
    assert_string_equal(buffer, "789");
    assert_int_equal(file_read_at(f, 10, buffer, 0), ST_OK);
    assert_int_equal(file_read_at(f, 8, buffer, 3), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "ends at byte 10"));
    assert_non_null(strstr(status_text(), path));
    assert_int_equal(file_read_at(f, UINT64_MAX - 1, buffer, 3), ST_CORRUPT);
    fault_arm(FAULT_READ, 1);
    assert_int_equal(file_read_at(f, 0, buffer, 1), ST_IO);
    assert_int_equal(file_read_at(f, 0, buffer, 1), ST_OK);
    /* Cut off behind our back. */
    assert_int_equal(truncate(path, 4), 0);
    assert_int_equal(file_read_at(f, 2, buffer, 4), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "ends at byte 4"));
    file_close(f);
    remove(path);
    check_left(0);
}

/* Bytes "6789", from byte 6 of "a name". */
static void check_part_of_part(const file *part) {
    char buffer[4] = "";
    file *inner = NULL;
    assert_int_equal(file_open_part(&m, part, 1, 2, &inner), ST_OK);
    assert_int_equal(file_size(inner), 2);
    assert_int_equal(file_read_at(inner, 0, buffer, 2), ST_OK);
    assert_string_equal(buffer, "78");
    assert_int_equal(file_read_at(inner, 0, buffer, 3), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "a name (from byte 7)"));
    file_close(inner);
    assert_int_equal(file_open_part(&m, part, 3, 5, &inner), ST_OK);
    assert_int_equal(file_size(inner), 1);
    file_close(inner);
}

/* Bytes of the caller's, and parts of them. */
static void test_memory(void **state) {
    (void)state;
    char buffer[16] = "";
    file *f = NULL, *part = NULL;
    assert_int_equal(file_open_memory(&m, "a name", "0123456789", 10, &f), ST_OK);
    assert_int_equal(file_size(f), 10);
    assert_string_equal(file_path(f), "a name");
    assert_int_equal(file_descriptor(f), -1);
    assert_int_equal(file_read_at(f, 7, buffer, 3), ST_OK);
    assert_string_equal(buffer, "789");
    assert_int_equal(file_read_at(f, 8, buffer, 3), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "a name: ends at byte 10"));
    assert_int_equal(file_read_at(f, UINT64_MAX - 1, buffer, 3), ST_CORRUPT);
    assert_int_equal(file_open_part(&m, f, 6, 20, &part), ST_OK);
    file_close(f);
    assert_int_equal(file_size(part), 4);
    assert_int_equal(*(const char *)file_memory(part), '6');
    assert_int_equal(file_read_at(part, 1, buffer, 3), ST_OK);
    assert_string_equal(buffer, "789");
    assert_int_equal(file_read_at(part, 1, buffer, 4), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "a name (from byte 6)"));
    check_part_of_part(part);
    file_close(part);
    check_left(0);
}

static void test_open_refused(void **state) {
    (void)state;
    file *f;
    assert_int_equal(file_open(&m, scratch_path("none"), &f), ST_IO);
    assert_non_null(strstr(status_text(), "none"));
    assert_int_equal(file_open(&m, "/", &f), ST_IO);
    assert_int_equal(file_open(&m, "/dev/null", &f), ST_IO);
    check_left(0);
}

static void test_commit(void **state) {
    (void)state;
    const char *path = scratch_path("out");
    out_file *f;
    assert_int_equal(out_file_create(&m, path, false, &f), ST_OK);
    assert_int_equal(out_file_append(f, "....world", 9), ST_OK);
    assert_int_equal(out_file_write_at(f, 0, "abcd", 4), ST_OK);
    assert_int_equal(out_file_append(f, "!", 1), ST_OK);
    char back[3] = "";
    assert_int_equal(out_file_read_at(f, 3, back, 2), ST_OK);
    assert_string_equal(back, "dw");
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(out_file_commit(f), ST_OK);
    check_content(path, "abcdworld!");
    check_left(1);
    struct stat info;
    mode_t mask = umask(0);
    umask(mask);
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0666 & ~mask);
    remove(path);
}

static void test_discard(void **state) {
    (void)state;
    out_file *f;
    assert_int_equal(out_file_create(&m, scratch_path("out"), false, &f), ST_OK);
    assert_int_equal(out_file_append(f, "x", 1), ST_OK);
    assert_int_equal(scratch_count(), 1);
    out_file_discard(f);
    out_file_discard(NULL);
    check_left(0);
}

static void test_exists(void **state) {
    (void)state;
    const char *path = scratch_text("out", "old");
    out_file *f;
    assert_int_equal(out_file_create(&m, path, false, &f), ST_EXISTS);
    assert_int_equal(out_file_create(&m, path, true, &f), ST_OK);
    assert_int_equal(out_file_append(f, "new", 3), ST_OK);
    check_content(path, "old");
    assert_int_equal(out_file_commit(f), ST_OK);
    check_content(path, "new");
    remove(path);
    /* It comes up while we write. */
    assert_int_equal(out_file_create(&m, path, false, &f), ST_OK);
    scratch_text("out", "another's");
    assert_int_equal(out_file_commit(f), ST_EXISTS);
    check_content(path, "another's");
    remove(path);
    check_left(0);
}

static void test_never_a_device(void **state) {
    (void)state;
    out_file *f;
    assert_int_equal(out_file_create(&m, "/dev/null", true, &f), ST_EXISTS);
    assert_int_equal(out_file_create(&m, "/tmp", true, &f), ST_EXISTS);
    assert_int_equal(out_file_create(&m, "/no/such/folder/x", true, &f), ST_IO);
    check_left(0);
}

/* As long as the system allows: temporary names are longer. */
static void test_long_name(void **state) {
    (void)state;
    char path[600];
    snprintf(path, sizeof path, "%s", scratch_path("x"));
    const size_t folder = strlen(path) - 1;
    memset(path + folder, 'n', NAME_MAX);
    path[folder + NAME_MAX] = 0;
    out_file *f, *g;
    assert_int_equal(out_file_create(&m, path, false, &f), ST_OK);
    assert_int_equal(out_file_create(&m, path, true, &g), ST_OK);
    assert_string_not_equal(out_file_temporary(f), out_file_temporary(g));
    assert_int_equal(out_file_commit(f), ST_OK);
    assert_int_equal(out_file_commit(g), ST_OK);
    assert_int_equal(remove(path), 0);
    path[folder + NAME_MAX] = 'n';
    path[folder + NAME_MAX + 1] = 0;
    assert_int_equal(out_file_create(&m, path, false, &f), ST_IO);
    assert_int_equal(out_file_create(&m, "", true, &f), ST_USAGE);
    check_left(0);
}

static void test_scratch_file(void **state) {
    (void)state;
    out_file *f;
    char back[4] = "";
    assert_int_equal(out_file_scratch(&m, scratch_path("out"), &f), ST_OK);
    assert_int_equal(scratch_count(), 0);
    assert_int_equal(out_file_append(f, "abc", 3), ST_OK);
    assert_int_equal(out_file_read_at(f, 0, back, 3), ST_OK);
    assert_string_equal(back, "abc");
    assert_int_equal(out_file_read_at(f, 1, back, 3), ST_CORRUPT);
    out_file_discard(f);
    check_left(0);
}

static void test_full(void **state) {
    (void)state;
    int full = open("/dev/full", O_WRONLY);
    if (full >= 0) {
        assert_int_equal(file_write_all(full, "full", NULL, "x", 1), ST_NOSPACE);
        close(full);
    }
    struct rlimit before, small;
    void (*old)(int) = signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    small = (struct rlimit){.rlim_cur = 1000, .rlim_max = before.rlim_max};
    out_file *f;
    char block[600] = "";
    assert_int_equal(out_file_create(&m, scratch_path("out"), false, &f), ST_OK);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    status first = out_file_append(f, block, sizeof block);
    status second = out_file_append(f, block, sizeof block);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, old);
    assert_int_equal(first, ST_OK);
    assert_int_equal(second, ST_NOSPACE);
    /* What failed has not moved the end. */
    char last = 0;
    assert_int_equal(out_file_append(f, "!", 1), ST_OK);
    assert_int_equal(out_file_read_at(f, 600, &last, 1), ST_OK);
    assert_int_equal(last, '!');
    out_file_discard(f);
    check_left(0);
}

static status write_small(const char *path) {
    out_file *f;
    status st = out_file_create(&m, path, false, &f);
    if (st != ST_OK)
        return st;
    st = out_file_append(f, "abc", 3);
    if (st != ST_OK) {
        out_file_discard(f);
        return st;
    }
    return out_file_commit(f);
}

static void test_faults(void **state) {
    (void)state;
    const char *path = scratch_path("out");
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        bool fired = true;
        long k = 0;
        while (fired) {
            fault_arm(kinds[i], ++k);
            status st = write_small(path);
            fired = fault_fired(kinds[i]);
            fault_arm(kinds[i], 0);
            if (st ==
                ST_OK) /* a fault may also hit what is only tried, such as the folder's fsync */
                remove(path);
            else
                assert_true(fired && (st == ST_NOMEM || st == ST_NOSPACE));
            check_left(0);
        }
        assert_true(k > 2);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_read, set_up),
        cmocka_unit_test_setup(test_memory, set_up),
        cmocka_unit_test_setup(test_open_refused, set_up),
        cmocka_unit_test_setup(test_commit, set_up),
        cmocka_unit_test_setup(test_discard, set_up),
        cmocka_unit_test_setup(test_exists, set_up),
        cmocka_unit_test_setup(test_never_a_device, set_up),
        cmocka_unit_test_setup(test_long_name, set_up),
        cmocka_unit_test_setup(test_scratch_file, set_up),
        cmocka_unit_test_setup(test_full, set_up),
        cmocka_unit_test_setup(test_faults, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
