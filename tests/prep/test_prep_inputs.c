/* test_prep_inputs.c - a conversion by the library never replaces a file that it reads: by its
 * name, by a link, or one that its input leads to. Each of these begins as a treelet file does,
 * which would give way otherwise. Another conversion's output is no matter.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/leaf/leaf.h"
#include "prep/leafcast_prep.h"
#include "tests/support/scratch.h"

enum { EDGE = 8, SAMPLES = EDGE * EDGE * EDGE };

static const leafcast_convert_options REPLACE = {.size = sizeof REPLACE, .replace = true};

static void samples_of(uint8_t out[SAMPLES]) {
    for (int i = 0; i < SAMPLES; i++)
        out[i] = (uint8_t)(i % 251);
    memcpy(out, LEAF_MAGIC, sizeof LEAF_MAGIC - 1);
}

/* Scratch files of every form below. */
static void write_forms(void) {
    uint8_t bytes[SAMPLES];
    samples_of(bytes);
    scratch_write("a_8x8x8_uint8.raw", bytes, sizeof bytes);
    scratch_write("b_8x8x8_uint8.raw", bytes, sizeof bytes);
    scratch_write("n.raw", bytes, sizeof bytes);
    scratch_text("n.nhdr", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\n"
                           "encoding: raw\ndata file: n.raw\n");
    mkdir(scratch_path("z"), 0755);
    scratch_text("z/.zarray", "{\"zarr_format\": 2, \"shape\": [8, 8, 8], \"chunks\": [8, 8, 4], "
                              "\"dtype\": \"|u1\", \"compressor\": null, \"fill_value\": 0, "
                              "\"order\": \"C\", \"filters\": null}");
    scratch_write("z/0.0.0", bytes, SAMPLES / 2);
    scratch_write("z/0.0.1", bytes, SAMPLES / 2);
    assert_int_equal(link(scratch_path("a_8x8x8_uint8.raw"), scratch_path("hard")), 0);
    assert_int_equal(symlink("a_8x8x8_uint8.raw", scratch_path("soft")), 0);
    assert_int_equal(link(scratch_path("n.raw"), scratch_path("hard.raw")), 0);
    assert_int_equal(symlink("z", scratch_path("folder")), 0);
}

static void remove_forms(void) {
    static const char *const names[] = {"a_8x8x8_uint8.raw",
                                        "b_8x8x8_uint8.raw",
                                        "n.raw",
                                        "n.nhdr",
                                        "z/.zarray",
                                        "z/0.0.0",
                                        "z/0.0.1",
                                        "hard",
                                        "hard.raw",
                                        "soft",
                                        "folder",
                                        "z"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        remove(scratch_path(names[i]));
}

typedef struct form {
    const char *in, *out;
    const char *read; /* the file as the text names it, where that is not `in` */
} form;

static const form FORMS[] = {{"a_8x8x8_uint8.raw", "a_8x8x8_uint8.raw", NULL},
                             {"a_8x8x8_uint8.raw", "hard", NULL},
                             {"a_8x8x8_uint8.raw", "soft", NULL},
                             {"n.nhdr", "n.nhdr", NULL},
                             {"n.nhdr", "n.raw", "n.raw"},
                             {"n.nhdr", "hard.raw", "n.raw"},
                             {"z", "z/.zarray", ".zarray"},
                             {"z", "z/0.0.0", "0.0.0"},
                             {"z", "z/0.0.1", "0.0.1"},
                             {"folder", "z/0.0.1", "0.0.1"}};

static void check_refused(const form *f) {
    size_t sizes[2];
    char in[4096], out[4096];
    snprintf(in, sizeof in, "%s", scratch_path(f->in));
    snprintf(out, sizeof out, "%s", scratch_path(f->out));
    char *before = scratch_read(out, &sizes[0]);
    const size_t files = scratch_count();
    const leafcast_status st = leafcast_convert_path(in, out, &REPLACE);
    const char *text = leafcast_error_text();
    if (st != LEAFCAST_USAGE || !strstr(text, out) || !strstr(text, f->read ? f->read : f->in))
        fail_msg("%s to %s: status %d: %s", f->in, f->out, (int)st, text);
    char *after = scratch_read(out, &sizes[1]);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(before, after, sizes[0]);
    assert_int_equal(scratch_count(), files);
    free(before);
    free(after);
}

static void test_forms(void **state) {
    (void)state;
    write_forms();
    for (size_t i = 0; i < sizeof FORMS / sizeof *FORMS; i++)
        check_refused(&FORMS[i]);
    /* What is no input gives way. */
    assert_int_equal(
        leafcast_convert_path(scratch_path("n.nhdr"), scratch_path("b_8x8x8_uint8.raw"), &REPLACE),
        LEAFCAST_OK);
    remove_forms();
}

/* The second of two steps, which is opened long after the first. */
static void test_steps(void **state) {
    (void)state;
    write_forms();
    const char *const in[] = {scratch_path("n.nhdr"), scratch_path("a_8x8x8_uint8.raw")};
    assert_int_equal(leafcast_convert_steps(in, 2, NULL, scratch_path("hard"), &REPLACE),
                     LEAFCAST_USAGE);
    assert_non_null(strstr(leafcast_error_text(), "a_8x8x8_uint8.raw"));
    assert_non_null(strstr(leafcast_error_text(), "hard"));
    remove_forms();
}

static bool convert_its_output(void *ctx, const char *phase, double done) {
    leafcast_status *st = ctx;
    (void)phase;
    (void)done;
    if (*st == LEAFCAST_FAILED)
        *st = leafcast_convert_path(scratch_path("a_8x8x8_uint8.raw"), scratch_path("other.leaf"),
                                    NULL);
    return true;
}

/* While one conversion is to replace a file, another reads it. */
static void test_two(void **state) {
    (void)state;
    leafcast_status inner = LEAFCAST_FAILED; /* not tried yet */
    leafcast_convert_options o = REPLACE;
    o.watch = convert_its_output;
    o.watch_ctx = &inner;
    write_forms();
    assert_int_equal(
        leafcast_convert_path(scratch_path("n.nhdr"), scratch_path("a_8x8x8_uint8.raw"), &o),
        LEAFCAST_OK);
    assert_int_equal(inner, LEAFCAST_OK);
    remove(scratch_path("other.leaf"));
    remove_forms();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_forms), cmocka_unit_test(test_steps),
                                       cmocka_unit_test(test_two)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
