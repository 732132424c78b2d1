/* test_step_list.c - lists of time steps, and what none is. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/step_list.h"

enum { STEPS = 9 };

/* The steps of a list for a file of STEPS, divided by blanks. */
static const char *expand(const char *text) {
    static char out[400];
    step_list l;
    out[0] = 0;
    assert_int_equal(step_list_parse(text, "--steps", &l), ST_OK);
    assert_true(step_list_given(&l));
    assert_int_equal(step_list_settle(&l, "--steps", "f", STEPS), ST_OK);
    for (uint64_t i = 0; i < step_list_count(&l); i++)
        snprintf(out + strlen(out), sizeof out - strlen(out), i ? " %u" : "%u",
                 step_list_at(&l, i));
    return out;
}

static void test_lists(void **state) {
    (void)state;
    const struct {
        const char *text, *steps;
        bool ascends;
    } cases[] = {{"all", "0 1 2 3 4 5 6 7 8", true},
                 {"0", "0", true},
                 {"8", "8", true},
                 {"2:5", "2 3 4 5", true},
                 {"3:3", "3", true},
                 {"0:8:3", "0 3 6", true},
                 {"1:8:3", "1 4 7", true},
                 {"2:4:99", "2", true},
                 {"0:8000:9000", "0", true},
                 {"1,3,8", "1 3 8", true},
                 {"0:4:2,5,7:8", "0 2 4 5 7 8", true},
                 {"0:5:4,5", "0 4 5", true},
                 {"5,1", "5 1", false},
                 {"1,1", "1 1", false},
                 {"0:4,4:6", "0 1 2 3 4 4 5 6", false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        step_list l;
        assert_string_equal(expand(cases[i].text), cases[i].steps);
        assert_int_equal(step_list_parse(cases[i].text, "--steps", &l), ST_OK);
        assert_int_equal(step_list_settle(&l, "--steps", "f", STEPS), ST_OK);
        assert_int_equal(step_list_ascends(&l), cases[i].ascends);
    }
}

static void test_refusals(void **state) {
    (void)state;
    static const char *const wrong[] = {
        "",           "x",          ",",    "1,",   ",1",    "1,,2",    "-1",
        "1:",         ":1",         "1:2:", "1::2", "1:2:0", "2:1",     "ALL",
        "all,1",      "1,all",      "0.5",  "1 2",  "+1",    "1:2:3:4", "99999999999999999999",
        "4294967296", "2147483648", "0x1",  "1:-2", "nan"};
    step_list l;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(step_list_parse(wrong[i], "--when", &l), ST_USAGE);
        assert_non_null(strstr(status_text(), "--when: "));
    }
    static const char *const beyond[] = {"9", "0:9", "3,10", "0:9:9", "2147483647"};
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++) {
        assert_int_equal(step_list_parse(beyond[i], "--when", &l), ST_OK);
        assert_int_equal(step_list_settle(&l, "--when", "f.leaf", STEPS), ST_USAGE);
        assert_non_null(strstr(status_text(), "f.leaf has 9"));
    }
    l = (step_list){.count = 0};
    assert_false(step_list_given(&l));
}

/* As many entries as there is room for, and numbers as large as they may be. */
static void test_limits(void **state) {
    (void)state;
    char text[1000] = "0";
    step_list l;
    for (int i = 1; i < STEP_RANGES_MAX; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), ",%d", i);
    assert_int_equal(step_list_parse(text, "--steps", &l), ST_OK);
    assert_int_equal(step_list_count(&l), STEP_RANGES_MAX);
    assert_int_equal(step_list_at(&l, STEP_RANGES_MAX - 1), STEP_RANGES_MAX - 1);
    strcat(text, ",99");
    assert_int_equal(step_list_parse(text, "--steps", &l), ST_USAGE);
    assert_int_equal(step_list_parse("0:2147483647,0:2147483647", "--steps", &l), ST_OK);
    assert_true(step_list_count(&l) == 1ULL << 32);
    assert_int_equal(step_list_at(&l, (1ULL << 32) - 1), INT32_MAX);
    assert_int_equal(step_list_parse("0:2147483647:2147483647", "--steps", &l), ST_OK);
    assert_int_equal(step_list_at(&l, 1), INT32_MAX);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_lists),
                                       cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_limits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
