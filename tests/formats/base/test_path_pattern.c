#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/path_pattern.h"
#include "tests/support/scratch.h"

enum { MOST = 16 };

/* Expand patterns in the scratch folder, given and expected one behind the other with blanks. */
static void expand(const char *patterns, const char *expected) {
    char text[512], got[512] = "", *given[MOST], **paths = given;
    int count = 0;
    snprintf(text, sizeof text, "%s", patterns);
    for (char *at = strtok(text, " "); at; at = strtok(NULL, " "))
        given[count++] = at;
    assert_int_equal(path_pattern_expand(&paths, &count), ST_OK);
    for (int i = 0; i < count; i++)
        snprintf(got + strlen(got), sizeof got - strlen(got), "%s%s", i ? " " : "", paths[i]);
    path_pattern_release(paths, count);
    assert_string_equal(got, expected);
}

static void make_files(void) {
    static const char *const names[] = {"s_1.raw",    "s_2.raw",  "s_10.raw", "s_010.raw",
                                        "s_0003.raw", "s_x.raw",  "t9a2",     "t9a10",
                                        "t10a1",      "a[1].raw", "p%d",      "s_4.raw.gz"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        scratch_write(names[i], "", 0);
    /* Patterns are relative here, so that texts are short. */
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", scratch_path("x"));
    *strrchr(folder, '/') = '\0';
    assert_int_equal(chdir(folder), 0);
}

static void test_files(void **state) {
    (void)state;
    make_files();
    expand("s_1.raw nothing - s_2.raw", "s_1.raw nothing - s_2.raw");
    expand("s_*.raw", "s_1.raw s_2.raw s_0003.raw s_010.raw s_10.raw s_x.raw");
    expand("s_%d.raw", "s_1.raw s_2.raw s_10.raw");
    expand("s_%02d.raw", "s_10.raw");
    expand("s_%03d.raw", "s_010.raw");
    expand("s_%04d.raw", "s_0003.raw");
    expand("t%da1 s_?.raw", "t10a1 s_1.raw s_2.raw s_x.raw");
    expand("t*", "t9a2 t9a10 t10a1");
    expand("s_[12].raw t9a%d", "s_1.raw s_2.raw t9a2 t9a10");
    expand("./s_%d.raw", "./s_1.raw ./s_2.raw ./s_10.raw");
    /* Names that are there are no patterns. */
    expand("a[1].raw p%d", "a[1].raw p%d");
    /* Nor is what has another %. */
    expand("s_%x.raw s_%d_%d", "s_%x.raw s_%d_%d");
}

/* What nothing fits is what it is; whoever opens it says that it is not there. */
static void test_none(void **state) {
    (void)state;
    static const char *const none[] = {"u_%d.raw",    "*.nrrd",      "s_1.raw s_%05d.raw",
                                       "s_[3-9].raw", "no/folder/*", "s_%20d.raw"};
    char long_name[5000];
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        expand(none[i], none[i]);
    memset(long_name, '*', sizeof long_name);
    long_name[sizeof long_name - 1] = '\0';
    char *path = long_name, **paths = &path;
    int count = 1;
    assert_int_equal(path_pattern_expand(&paths, &count), ST_OK);
    assert_int_equal(count, 1);
    assert_string_equal(paths[0], long_name);
    path_pattern_release(paths, count);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
