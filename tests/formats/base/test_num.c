/* test_num.c - numbers to and from text: whole texts only, any locale, round trips.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/num.h"

static void test_double(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double value;
    } good[] = {{"0", 0},           {"-500", -500},    {"+1.5", 1.5},     {"1e3", 1000},
                {".25", 0.25},      {"0x1p-3", 0.125}, {"inf", INFINITY}, {"-Infinity", -INFINITY},
                {"5e-324", 5e-324}, {"1e-400", 0},     {"1e308", 1e308}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        double v = 7;
        assert_int_equal(num_double(good[i].text, "--x", &v), ST_OK);
        assert_true(v == good[i].value);
    }
    double v = 7;
    assert_int_equal(num_double("nan", "--x", &v), ST_OK);
    assert_true(isnan(v));
}

static void test_double_refused(void **state) {
    (void)state;
    static const char *const bad[] = {"",   " 1",  "1 ",    "1,5",    "1.5x", "--1", "one",
                                      "1e", "\t1", "1e999", "-1e999", "0x",   "."};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        double v = 7;
        if (num_double(bad[i], "--iso", &v) != ST_USAGE)
            fail_msg("\"%s\" was accepted as %g", bad[i], v);
        assert_true(v == 7);
        assert_non_null(strstr(status_text(), "--iso"));
    }
}

static void test_int(void **state) {
    (void)state;
    int64_t v = 0;
    assert_int_equal(num_int("-9223372036854775808", "x", INT64_MIN, INT64_MAX, &v), ST_OK);
    assert_true(v == INT64_MIN);
    assert_int_equal(num_int("16", "x", 1, 16, &v), ST_OK);
    assert_int_equal(v, 16);
    static const char *const bad[] = {
        "", "17", "0", "1.0", "1e1", "0x10", " 2", "2 ", "9223372036854775808"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (num_int(bad[i], "x", 1, 16, &v) != ST_USAGE)
            fail_msg("\"%s\" was accepted", bad[i]);
}

static void test_size(void **state) {
    (void)state;
    static const struct {
        const char *text;
        uint64_t value;
    } good[] = {{"0", 0},     {"4096", 4096}, {"256M", 256u << 20},       {"1.5G", 3u << 29},
                {"2k", 2048}, {"3KiB", 3072}, {"1TB", (uint64_t)1 << 40}, {"12B", 12}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        uint64_t v = 7;
        if (num_size(good[i].text, "--memory", &v) != ST_OK || v != good[i].value)
            fail_msg("\"%s\": %" PRIu64, good[i].text, v);
    }
    static const char *const bad[] = {"",    "M",   "-1",  "1X",   "1MM",
                                      "1 M", "inf", "nan", "1e30", "8388608T"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        uint64_t v = 7;
        if (num_size(bad[i], "--memory", &v) != ST_USAGE)
            fail_msg("\"%s\" was accepted as %" PRIu64, bad[i], v);
    }
}

static void test_lists(void **state) {
    (void)state;
    double v[3];
    static const struct {
        const char *text, *separators;
    } good[] = {{"1,-2,3.5", ","},  {"1, -2 , 3.5", ", "}, {" 1 -2  3.5 ", " "},
                {"1 -2\t3.5", " "}, {"1x-2x3.5", "x"},     {"1,-2x3.5", ",x"}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        memset(v, 0, sizeof v);
        if (num_doubles(good[i].text, "x", good[i].separators, 3, v) != ST_OK || v[0] != 1 ||
            v[1] != -2 || v[2] != 3.5)
            fail_msg("\"%s\": %s", good[i].text, status_text());
    }
    static const char *const bad[] = {"",       "1,2",    "1,2,3,4", "1,,3",
                                      "1,2,3,", ",1,2,3", "1,2,x",   "1;2;3"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (num_doubles(bad[i], "x", ", ", 3, v) != ST_USAGE)
            fail_msg("\"%s\" was accepted", bad[i]);
}

static void check_round_trip(double value) {
    char text[NUM_TEXT_MAX];
    double back = 0;
    assert_int_equal(num_double(num_print(value, text), "x", &back), ST_OK);
    if (memcmp(&back, &value, sizeof back) != 0 && !(isnan(back) && isnan(value)))
        fail_msg("%a printed as %s reads as %a", value, text, back);
}

static void test_print(void **state) {
    (void)state;
    char text[NUM_TEXT_MAX];
    assert_string_equal(num_print(0.1, text), "0.1");
    assert_string_equal(num_print(1, text), "1");
    assert_string_equal(num_print(-80, text), "-80");
    assert_string_equal(num_print(100000, text), "100000");
    assert_string_equal(num_print(2.5e15, text), "2.5e+15");
    assert_string_equal(num_print(-2.5e-7, text), "-2.5e-07");
    assert_string_equal(num_print(5e-324, text), "5e-324");
    assert_string_equal(num_print_float(-1e34F, text), "-1e+34");
    assert_string_equal(num_print_float(0.1F, text), "0.1");
    assert_string_equal(num_print((double)0.1F, text), "0.10000000149011612");
    assert_string_equal(num_print_float(16777216.0F, text), "16777216");
    for (uint32_t i = 1; i < 0x7f800000u; i += 0x10001u) {
        float some;
        memcpy(&some, &i, sizeof some);
        double read = 0;
        assert_int_equal(num_double(num_print_float(some, text), "x", &read), ST_OK);
        assert_true((float)read == some);
    }
    const double edges[] = {
        0, -0.0, INFINITY, -INFINITY, 1.7976931348623157e308, 2.2250738585072014e-308};
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++)
        check_round_trip(edges[i]);
    srand48(1);
    for (int i = 0; i < 20000; i++) {
        uint64_t bits = (uint64_t)mrand48() << 32 ^ (uint32_t)mrand48();
        double value;
        memcpy(&value, &bits, sizeof value);
        if (isfinite(value))
            check_round_trip(value);
    }
}

static void test_locale(void **state) {
    (void)state;
    static const char *const names[] = {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8", "fr_FR",
                                        "es_ES.UTF-8"};
    const char *set = NULL;
    for (size_t i = 0; !set && i < sizeof names / sizeof *names; i++)
        set = setlocale(LC_ALL, names[i]);
    if (!set)
        skip();
    double v = 0;
    char text[NUM_TEXT_MAX];
    assert_int_equal(num_double("1.5", "x", &v), ST_OK);
    assert_true(v == 1.5);
    assert_int_equal(num_double("1,5", "x", &v), ST_USAGE);
    assert_string_equal(num_print(1.5, text), "1.5");
    setlocale(LC_ALL, "C");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_double), cmocka_unit_test(test_double_refused),
        cmocka_unit_test(test_int),    cmocka_unit_test(test_size),
        cmocka_unit_test(test_lists),  cmocka_unit_test(test_print),
        cmocka_unit_test(test_locale),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
