/* test_file_guard.c - files are told apart by what they are, not by what they are called. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "tests/support/scratch.h"

static int reset(void **state) {
    (void)state;
    file_guard_reset();
    return 0;
}

static char *copy(const char *text) {
    char *c = strdup(text);
    assert_non_null(c);
    return c;
}

static void test_names(void **state) {
    (void)state;
    char *in = copy(scratch_text("in", "data"));
    char *soft = copy(scratch_path("soft")), *hard = copy(scratch_path("hard"));
    assert_int_equal(symlink(in, soft), 0);
    assert_int_equal(link(in, hard), 0);
    assert_int_equal(file_guard_input(in), ST_OK);
    assert_int_equal(file_guard_input(in), ST_OK);
    assert_int_equal(file_guard_input(hard), ST_OK);
    assert_int_equal(file_guard_input(scratch_path("none")), ST_OK);
    assert_int_equal(file_guard_output(in), ST_USAGE);
    assert_int_equal(file_guard_output(soft), ST_USAGE);
    assert_non_null(strstr(status_text(), "soft: is the same file as"));
    assert_int_equal(file_guard_output(hard), ST_USAGE);
    assert_int_equal(file_guard_check(hard), ST_USAGE);
    assert_int_equal(file_guard_output(scratch_path("out")), ST_OK);
    assert_int_equal(file_guard_check(scratch_path("out")), ST_OK);
    assert_int_equal(file_guard_output(NULL), ST_OK);
    assert_int_equal(file_guard_output("-"), ST_OK);
    assert_int_equal(file_guard_output("-"), ST_OK);
    remove(soft);
    remove(hard);
    remove(in);
    free(soft);
    free(hard);
    free(in);
}

static void test_outputs(void **state) {
    (void)state;
    char *a = copy(scratch_path("a")), *b = copy(scratch_path("b"));
    char *folder = copy(scratch_path("folder"));
    char again[4096];
    *strrchr(b, '/') = 0;
    assert_int_equal(symlink(b, folder), 0);
    snprintf(again, sizeof again, "%s/a", folder);
    assert_int_equal(file_guard_output(a), ST_OK);
    assert_int_equal(file_guard_output(a), ST_USAGE);
    assert_int_equal(file_guard_output(again), ST_USAGE);
    assert_int_equal(file_guard_output(scratch_path("b")), ST_OK);
    /* The next round may have the same outputs, though not the same inputs. */
    char *in = copy(scratch_text("in", "data"));
    assert_int_equal(file_guard_input(in), ST_OK);
    file_guard_next();
    assert_int_equal(file_guard_output(again), ST_OK);
    assert_int_equal(file_guard_output(in), ST_USAGE);
    /* What is announced may not be opened as an input either. */
    assert_int_equal(file_guard_output(scratch_text("b", "x")), ST_OK);
    assert_int_equal(file_guard_input(scratch_path("b")), ST_USAGE);
    remove(scratch_path("b"));
    remove(folder);
    remove(in);
    free(a);
    free(b);
    free(folder);
    free(in);
}

static void test_watching(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    char *in = copy(scratch_text("in", "data"));
    file *f = NULL;
    out_file *out = NULL;
    assert_int_equal(file_open(&m, in, &f), ST_OK);
    file_close(f);
    assert_int_equal(file_guard_check(in), ST_OK);
    file_guard_watch();
    file_guard_look(true);
    assert_int_equal(file_open(&m, in, &f), ST_OK);
    file_guard_look(false);
    file_close(f);
    assert_int_equal(out_file_create(&m, in, true, &out), ST_OK);
    assert_int_equal(file_open(&m, in, &f), ST_OK);
    file_close(f);
    /* Opened after the output was begun. */
    assert_int_equal(out_file_commit(out), ST_USAGE);
    assert_int_equal(out_file_create(&m, in, true, &out), ST_USAGE);
    assert_int_equal(out_file_create(&m, in, false, &out), ST_USAGE);
    assert_int_equal(out_file_create(&m, "-", true, &out), ST_USAGE);
    char *data = scratch_read(in, NULL);
    assert_string_equal(data, "data");
    free(data);
    remove(in);
    free(in);
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(scratch_count(), 0);
}

/* What was written, read and written anew: the others stay inputs. */
static void test_forget(void **state) {
    (void)state;
    char *in = copy(scratch_text("in", "data")), *other = copy(scratch_text("other", "data"));
    assert_int_equal(file_guard_input(in), ST_OK);
    assert_int_equal(file_guard_input(other), ST_OK);
    file_guard_forget("nothing is called so");
    assert_int_equal(file_guard_check(in), ST_USAGE);
    file_guard_forget(in);
    assert_int_equal(file_guard_check(in), ST_OK);
    assert_int_equal(file_guard_check(other), ST_USAGE);
    file_guard_reset();
    assert_int_equal(file_guard_output(in), ST_OK);
    file_guard_forget(in);
    assert_int_equal(file_guard_output(in), ST_USAGE);
    remove(in);
    remove(other);
    free(in);
    free(other);
}

/* A job's target is no input of that job, and may be one of another; nothing watches here. */
static void test_target(void **state) {
    (void)state;
    mem m, other;
    file_guard_target t;
    file *f = NULL;
    mem_init(&m, 0);
    mem_init(&other, 0);
    char *in = copy(scratch_text("in", "data")), *hard = copy(scratch_path("hard"));
    assert_int_equal(link(in, hard), 0);
    file_guard_aim(&m, &t, in);
    assert_int_equal(file_guard_named(&m, scratch_path("none")), ST_OK);
    assert_int_equal(file_guard_named(&m, hard), ST_USAGE);
    assert_non_null(strstr(status_text(), in));
    assert_non_null(strstr(status_text(), hard));
    assert_int_equal(file_open(&m, hard, &f), ST_USAGE);
    assert_int_equal(file_open(&other, hard, &f), ST_OK);
    file_close(f);
    file_guard_aim(&m, &t, scratch_path("none"));
    assert_int_equal(file_open(&m, hard, &f), ST_OK);
    file_close(f);
    assert_int_equal(mem_used(&m), 0);
    remove(in);
    remove(hard);
    free(in);
    free(hard);
}

static status take_output(void *ctx, const char *path) {
    char *all = ctx;
    snprintf(all + strlen(all), 4096 - strlen(all), "%s;", path);
    return ST_OK;
}

static status stop_there(void *ctx, const char *path) {
    (void)ctx;
    (void)path;
    return ST_STOPPED;
}

static void test_each_output(void **state) {
    (void)state;
    mem m;
    file_guard_target t;
    mem_init(&m, 0);
    char all[4096] = "", *in = copy(scratch_text("in", "data"));
    assert_int_equal(file_guard_each_output(&m, stop_there, NULL), ST_OK);
    assert_int_equal(file_guard_input(in), ST_OK);
    assert_int_equal(file_guard_output("one"), ST_OK);
    assert_int_equal(file_guard_output("two"), ST_OK);
    assert_int_equal(file_guard_each_output(&m, take_output, all), ST_OK);
    assert_string_equal(all, "one;two;");
    assert_int_equal(file_guard_each_output(&m, stop_there, NULL), ST_STOPPED);
    file_guard_aim(&m, &t, scratch_path("none"));
    file_guard_aim(&m, &t, in);
    *all = 0;
    assert_int_equal(file_guard_each_output(&m, take_output, all), ST_OK);
    assert_int_equal(strncmp(all, in, strlen(in)), 0);
    assert_string_equal(all + strlen(in), ";one;two;");
    remove(in);
    free(in);
}

/* A folder's slices by the hundred: none is lost, also when some are forgotten. */
static void test_many(void **state) {
    (void)state;
    enum { FILES = 300 };
    char name[32];
    for (int i = 0; i < FILES; i++) {
        snprintf(name, sizeof name, "in%d", i);
        assert_int_equal(file_guard_input(scratch_text(name, "data")), ST_OK);
        assert_int_equal(file_guard_input(scratch_path(name)), ST_OK);
    }
    for (int i = 0; i < FILES; i += 3) {
        snprintf(name, sizeof name, "in%d", i);
        file_guard_forget(scratch_path(name));
    }
    file_guard_next();
    for (int i = 0; i < FILES; i++) {
        snprintf(name, sizeof name, "in%d", i);
        assert_int_equal(file_guard_check(scratch_path(name)), i % 3 ? ST_USAGE : ST_OK);
    }
    for (int i = 0; i < FILES; i++) {
        snprintf(name, sizeof name, "in%d", i);
        remove(scratch_path(name));
    }
}

static void test_no_memory(void **state) {
    (void)state;
    char *in = copy(scratch_text("in", "data"));
    for (long k = 1; k <= 2; k++) {
        fault_arm(FAULT_ALLOC, k);
        assert_int_equal(file_guard_input(in), ST_NOMEM);
        fault_arm(FAULT_ALLOC, 0);
        assert_int_equal(file_guard_check(in), ST_OK);
    }
    assert_int_equal(file_guard_input(in), ST_OK);
    fault_arm(FAULT_ALLOC, 1);
    assert_int_equal(file_guard_output(in), ST_NOMEM);
    fault_arm(FAULT_ALLOC, 0);
    assert_int_equal(file_guard_output(in), ST_USAGE);
    remove(in);
    free(in);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_names, reset, reset),
        cmocka_unit_test_setup_teardown(test_outputs, reset, reset),
        cmocka_unit_test_setup_teardown(test_watching, reset, reset),
        cmocka_unit_test_setup_teardown(test_forget, reset, reset),
        cmocka_unit_test_setup_teardown(test_each_output, reset, reset),
        cmocka_unit_test_setup_teardown(test_target, reset, reset),
        cmocka_unit_test_setup_teardown(test_many, reset, reset),
        cmocka_unit_test_setup_teardown(test_no_memory, reset, reset),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
