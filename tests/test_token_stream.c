/* test_token_stream.c - decimal numbers: the same doubles as strtod() gives, whatever their form;
 * words across the stream's buffer.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/token_stream.h"
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
    if (!token_stream_double(text, &got))
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
        char text[80];
        double exponent = (double)(random_bits() % 60) - 30;
        double value = (double)(int64_t)random_bits() * pow(10, exponent);
        static const char *const forms[] = {"%.17g", "%.6g", "%.9f", "%.3e", "%.0f"};
        snprintf(text, sizeof text, forms[i % 5], value);
        if (strlen(text) < TOKEN_STREAM_MAX)
            check_double(text);
    }
    static const char *const bad[] = {"",    "-",  ".",     "e5",  "1e",
                                      "1e+", "1x", "1.2.3", "--1", "2e308"};
    double value;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (token_stream_double(bad[i], &value))
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
        if (token_stream_whole(cases[i].text, &value) != cases[i].good ||
            (cases[i].good && value != cases[i].value))
            fail_msg("\"%s\": %llu", cases[i].text, (unsigned long long)value);
    }
}

enum { WORDS = 40000 };

/* Words of all lengths, so that some lie across the end of the stream's buffer. */
static const char *words_file(void) {
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    for (int i = 0; i < WORDS; i++)
        fprintf(out, "%*s%d", 1 + i % 5, i % 3 ? " " : "\n", i * 37);
    fprintf(out, "  <end>");
    fclose(out);
    const char *path = scratch_write("words.txt", text, size);
    free(text);
    return path;
}

static void test_stream(void **state) {
    (void)state;
    mem m;
    byte_stream *s;
    char token[TOKEN_STREAM_MAX];
    uint64_t value, got;
    mem_init(&m, 0);
    const char *path = words_file();
    for (int skip = 0; skip < 2; skip++) {
        assert_int_equal(byte_stream_open(&m, path, &s), ST_OK);
        for (int i = 0; i < WORDS; i++) {
            assert_int_equal(token_stream_next(s, token), ST_OK);
            assert_true(token_stream_whole(token, &value));
            assert_int_equal(value, i * 37);
            if (!skip)
                continue;
            assert_int_equal(token_stream_skip(s, 7, &got), ST_OK);
            i += 7;
            assert_int_equal(got, 7);
        }
        assert_int_equal(token_stream_skip(s, 7, &got), ST_OK);
        assert_int_equal(got, 0);
        assert_int_equal(token_stream_next(s, token), ST_OK);
        assert_string_equal(token, "");
        byte_stream_close(s);
    }
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_doubles),
        cmocka_unit_test(test_whole),
        cmocka_unit_test(test_stream),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
