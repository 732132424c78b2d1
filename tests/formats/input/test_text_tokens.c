/* test_text_tokens.c - decimal numbers: the same doubles as strtod() gives, whatever their form;
 * words across the stream's buffer, with their lines, among comments, up to a '<'.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/input/text_number.h"
#include "formats/input/text_tokens.h"
#include "tests/support/scratch.h"

static uint64_t seed = 12345;

static uint64_t random_bits(void) {
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return seed;
}

static void check_double(const char *text) {
    double got = -77, want = strtod(text, NULL);
    if (!text_number_double(text, &got))
        fail_msg("\"%s\" is no number", text);
    if (memcmp(&got, &want, sizeof got) != 0)
        fail_msg("\"%s\" is %a, not %a", text, want, got);
}

static void test_doubles(void **state) {
    (void)state;
    static const char *const fixed[] = {
        "0",
        "-0",
        "-0.0",
        "1.",
        ".5",
        "-.25e-3",
        "+7",
        "1e22",
        "1e23",
        "1e-22",
        "1e-23",
        "5e-324",
        "2e308",
        "1e+05",
        "nan",
        "inf",
        "-inf",
        "0x1p3",
        "9007199254740993",
        "9007199254740993e3",
        "123456789012345678",
        "12345678901234567890",
        "0.000000000000000000000000001",
    };
    for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++)
        if (strcmp(fixed[i], "2e308") != 0)
            check_double(fixed[i]);
    for (int i = 0; i < 200000; i++) {
        char text[400];
        double exponent = (double)(random_bits() % 60) - 30;
        double value = (double)(int64_t)random_bits() * pow(10, exponent);
        static const char *const forms[] = {"%.17g", "%.6g", "%.9f", "%.3e", "%.0f"};
        snprintf(text, sizeof text, forms[i % 5], value);
        check_double(text);
    }
    static const char *const bad[] = {"",    "-",  ".",     "e5",  "1e",
                                      "1e+", "1x", "1.2.3", "--1", "2e308"};
    double value;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (text_number_double(bad[i], &value))
            fail_msg("\"%s\" is %g", bad[i], value);
}

static void test_whole(void **state) {
    (void)state;
    static const struct {
        const char *text;
        bool good;
        uint64_t value;
    } cases[] = {
        {"0", true, 0},
        {"007", true, 7},
        {"4294967296", true, 4294967296},
        {"9999999999999999999", true, 9999999999999999999u},
        {"10000000000000000000", true, UINT64_MAX},
        {"-1", true, UINT64_MAX},
        {"-99999999999999999999", true, UINT64_MAX},
        {"", false, 0},
        {"-", false, 0},
        {"+1", false, 0},
        {"1.0", false, 0},
        {"1e3", false, 0},
        {"-1.5", false, 0},
        {"99999999999999999999x", false, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint64_t value = 0;
        if (text_number_whole(cases[i].text, &value) != cases[i].good ||
            (cases[i].good && value != cases[i].value))
            fail_msg("\"%s\": %llu", cases[i].text, (unsigned long long)value);
    }
}

static void test_int(void **state) {
    (void)state;
    static const struct {
        const char *text;
        bool good;
        int64_t value;
    } cases[] = {
        {"0", true, 0},
        {"-0", true, 0},
        {"+7", true, 7},
        {"-007", true, -7},
        {"999999999999999999", true, 999999999999999999},
        {"9223372036854775807", true, INT64_MAX},
        {"-9223372036854775808", true, INT64_MIN},
        {"9223372036854775808", false, 0},
        {"-9223372036854775809", false, 0},
        {"", false, 0},
        {"-", false, 0},
        {"1.0", false, 0},
        {"12a", false, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int64_t value = 5;
        if (text_number_int(cases[i].text, INT64_MIN, INT64_MAX, &value) != cases[i].good ||
            (cases[i].good && value != cases[i].value))
            fail_msg("\"%s\": %lld", cases[i].text, (long long)value);
    }
    int64_t value;
    assert_true(text_number_int("-3", -3, 9, &value) && value == -3);
    assert_true(text_number_int("9", -3, 9, &value) && value == 9);
    assert_false(text_number_int("-4", -3, 9, &value));
    assert_false(text_number_int("10", -3, 9, &value));
}

/* ---- words ---- */

enum { WORDS = 40000 };

/* Words of all lengths, so that some lie across the end of the stream's buffer. */
static const char *words_file(const char *gap) {
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    for (int i = 0; i < WORDS; i++)
        fprintf(out, "%*s%d%s", 1 + i % 5, i % 3 ? " " : "\n", i * 37, i % 3 == 2 ? gap : "");
    fprintf(out, "  <end>");
    fclose(out);
    const char *path = scratch_write("words.txt", text, size);
    free(text);
    return path;
}

/* Open a file's words with these rules. */
static text_tokens open_words(mem *m, const char *path, text_tokens rules) {
    mem_init(m, 0);
    assert_int_equal(byte_stream_open(m, path, &rules.s), ST_OK);
    return rules;
}

static void close_words(mem *m, text_tokens *t) {
    byte_stream_close(t->s);
    assert_int_equal(mem_used(m), 0);
}

static void check_words(const char *gap, text_tokens rules, int skipped) {
    mem m;
    uint64_t value, got;
    text_tokens t = open_words(&m, words_file(gap), rules);
    for (int i = 0; i < WORDS; i++) {
        assert_int_equal(text_tokens_next(&t), ST_OK);
        if (!text_number_whole(t.token, &value) || value != (uint64_t)i * 37)
            fail_msg("word %d is \"%s\"", i, t.token);
        if (rules.line > 0)
            assert_int_equal(t.line, 2 + i / 3);
        if (skipped == 0)
            continue;
        assert_int_equal(text_tokens_skip(&t, (uint64_t)skipped, &got), ST_OK);
        i += skipped;
        assert_int_equal(got, skipped);
    }
    for (int twice = 0; twice < 2; twice++) {
        assert_int_equal(text_tokens_next(&t), ST_OK);
        assert_string_equal(t.token, rules.stop || twice ? "" : "<end>");
        if (skipped > 0) {
            assert_int_equal(text_tokens_skip(&t, 7, &got), ST_OK);
            assert_int_equal(got, 0);
        }
    }
    close_words(&m, &t);
}

static void test_words(void **state) {
    (void)state;
    check_words("", (text_tokens){.stop = '<'}, 0);
    check_words("", (text_tokens){.stop = '<'}, 7);
    check_words("", (text_tokens){.line = 1, .stop = '<'}, 4);
    check_words("", (text_tokens){.line = 1}, 0);
    check_words("# no 7 number; <here>", (text_tokens){.line = 1, .comment = '#'}, 0);
    check_words(",;, ;", (text_tokens){.line = 1, .commas = true, .stop = '<'}, 0);
    check_words(",;, ;", (text_tokens){.commas = true, .stop = '<'}, 1);
}

/* How far text_tokens_skip() comes. */
static void check_skip(const char *text, uint64_t count, uint64_t want, const char *next) {
    mem m;
    uint64_t got;
    text_tokens t = open_words(&m, scratch_text("skip.txt", text), (text_tokens){.stop = '<'});
    assert_int_equal(text_tokens_skip(&t, count, &got), ST_OK);
    assert_int_equal(got, want);
    assert_int_equal(text_tokens_next(&t), ST_OK);
    assert_string_equal(t.token, next);
    close_words(&m, &t);
}

static void test_skip(void **state) {
    (void)state;
    check_skip("1 2 3 4", 0, 0, "1");
    check_skip("1 2 3 4", 3, 3, "4");
    check_skip("1 2 3 4", 4, 4, "");
    check_skip("1 2 3 4", 5, 4, "");
    check_skip("1 nan INF -1e3 SCALARS a", 9, 4, "SCALARS");
    check_skip("1 2x SCALARS a", 2, 2, "SCALARS");
    check_skip("1 2<3 4", 9, 2, "");
    char longer[1000];
    memset(longer, '7', sizeof longer - 5);
    strcpy(longer + sizeof longer - 5, " 8 9");
    check_skip(longer, 2, 2, "9");
}

static void check_refused(const char *text, size_t size, text_tokens rules, const char *said) {
    mem m;
    text_tokens t = open_words(&m, scratch_write("bad.txt", text, size), rules);
    status st = ST_OK;
    do
        st = text_tokens_next(&t);
    while (st == ST_OK && t.token[0]);
    assert_int_equal(st, ST_CORRUPT);
    if (!strstr(status_text(), said))
        fail_msg("\"%s\", not \"...%s...\"", status_text(), said);
    close_words(&m, &t);
}

static void test_no_text(void **state) {
    (void)state;
    char text[TEXT_TOKEN_MAX + 10] = "1\n2\n";
    check_refused("1\n2\0\n", 5, (text_tokens){.line = 1}, "bad.txt: line 2: no text at byte 2");
    check_refused("1\n2\0\n", 5, (text_tokens){0}, "bad.txt: byte 2: no text at byte 2");
    check_refused("1\n\0", 3, (text_tokens){.line = 1}, "bad.txt: line 2: no text at byte 2");
    memset(text + 4, '3', TEXT_TOKEN_MAX + 1);
    check_refused(text, 4 + TEXT_TOKEN_MAX + 1, (text_tokens){.line = 1}, "line 3: no text");
    mem m;
    text_tokens t = open_words(&m, scratch_write("long.txt", text, 4 + TEXT_TOKEN_MAX),
                               (text_tokens){.line = 1});
    for (int i = 0; i < 3; i++)
        assert_int_equal(text_tokens_next(&t), ST_OK);
    assert_int_equal(strlen(t.token), TEXT_TOKEN_MAX);
    int64_t value;
    assert_int_equal(text_tokens_int(&t, "a number", 0, 9, &value), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "line 3: nothing more here, expected a number"));
    close_words(&m, &t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_doubles), cmocka_unit_test(test_whole),
        cmocka_unit_test(test_int),     cmocka_unit_test(test_words),
        cmocka_unit_test(test_skip),    cmocka_unit_test(test_no_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
