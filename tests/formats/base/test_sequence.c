/* test_sequence.c - names of the files of a sequence. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

#include "formats/base/sequence.h"

static void test_names(void **state) {
    (void)state;
    const char *cases[][2] = {{"out.png", "out_0042.png"},   {"a.b/out", "a.b/out_0042"},
                              {"a.b/.png", "a.b/.png_0042"}, {"o%04d.png", "o0042.png"},
                              {"o%d.png", "o42.png"},        {"o%5d", "o   42"}};
    char name[20];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(sequence_name(cases[i][0], 42, name, sizeof name), ST_OK);
        assert_string_equal(name, cases[i][1]);
    }
    const char *wrong[] = {"a%s.png", "a%d%d.png", "a%n", "a%", "a%0999999999999d.png", "%%d"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(sequence_name(wrong[i], 1, name, sizeof name), ST_USAGE);
    /* 19 bytes and no more. */
    assert_int_equal(sequence_name("123456789.1234", 0, name, sizeof name), ST_OK);
    assert_string_equal(name, "123456789_0000.1234");
    assert_int_equal(sequence_name("123456789.12345", 0, name, sizeof name), ST_USAGE);
    assert_non_null(strstr(status_text(), "longer than 19 bytes"));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_names)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
