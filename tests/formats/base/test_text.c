/* test_text.c - names as valid UTF-8, and what a terminal may see.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <string.h>

#include "formats/base/text.h"

#define BAD "\xef\xbf\xbd"

static void test_name(void **state) {
    (void)state;
    static const struct {
        const char *from, *to;
    } cases[] = {{"", ""},
                 {"plain name", "plain name"},
                 {"\xc3\xa4\xe2\x82\xac\xf0\x9f\x8c\xbf", "\xc3\xa4\xe2\x82\xac\xf0\x9f\x8c\xbf"},
                 {"a\xff"
                  "b",
                  "a" BAD "b"},
                 {"\x1b[31m\n\t\x7f", BAD "[31m" BAD BAD BAD},
                 {"\xc2\x9b"
                  "31m",
                  BAD "31m"},           /* a control character of two bytes */
                 {"\xc0\xaf", BAD BAD}, /* overlong */
                 {"\xe0\x80\xaf", BAD BAD BAD},
                 {"\xed\xa0\x80", BAD BAD BAD}, /* a surrogate */
                 {"\xf4\x90\x80\x80", BAD BAD BAD BAD},
                 {"\xf8\x88\x80\x80", BAD BAD BAD BAD},
                 {"\xf8\x90\x80\x80", BAD BAD BAD BAD}, /* no first byte, though its low bits */
                 {"\xfc\x80\x80\x80", BAD BAD BAD BAD}, /* give a code that there is */
                 {"\xff\x90\x80\x80", BAD BAD BAD BAD},
                 {"x\xe2\x82", "x" BAD BAD}, /* cut */
                 {"\xe2"
                  "a",
                  BAD "a"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char to[64];
        text_name(to, sizeof to, cases[i].from);
        assert_string_equal(to, cases[i].to);
        text_name(to, sizeof to, to);
        assert_string_equal(to, cases[i].to);
    }
}

/* Whatever the room, no character is cut and nothing is written behind it. */
static void test_cut(void **state) {
    (void)state;
    static const char from[] = "\xc3\xa4x\xe2\x82\xac\xff\xf0\x9f\x8c\xbf";
    static const size_t fits[] = {0, 0, 0, 2, 3, 3, 3, 6, 6, 6, 9, 9, 9, 9, 13, 13};
    for (size_t room = 1; room < sizeof fits / sizeof *fits; room++) {
        char to[20];
        memset(to, '#', sizeof to);
        text_name(to, room, from);
        assert_int_equal(strlen(to), fits[room]);
        assert_int_equal(to[room], '#');
        memset(to, '#', sizeof to);
        assert_ptr_equal(text_printable(to, room, from), to);
        assert_true(strlen(to) < room);
        assert_int_equal(to[room], '#');
    }
    assert_true(text_same_name("a\xff", "a" BAD, 64));
    assert_true(text_same_name("abcd", "abce", 4));
    assert_false(text_same_name("abcd", "abce", 5));
}

static void test_printable(void **state) {
    (void)state;
    static const struct {
        const char *from, *to;
    } cases[] = {{"a b\\c \xc3\xa4", "a b\\c \xc3\xa4"},
                 {"\x1b[31m", "\\x1b[31m"},
                 {"a\nb\tc\r", "a\\nb\\tc\\x0d"},
                 {"\xff\x7f", "\\xff\\x7f"},
                 {"\xc2\x9b", "\\x9b"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char to[64];
        assert_string_equal(text_printable(to, sizeof to, cases[i].from), cases[i].to);
    }
}

static void test_file_name(void **state) {
    (void)state;
    static const struct {
        const char *path, *name;
    } cases[] = {{"a.raw", "a"},
                 {"/x.y/a.b.raw", "a.b"},
                 {"d/.x", ".x"},
                 {".x.raw", ".x"},
                 {"d.e/a", "a"},
                 {"a.", "a"},
                 {"d/", ""},
                 {"", ""},
                 {"a\xff.raw", "a" BAD}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char to[64];
        text_file_name(to, sizeof to, cases[i].path);
        assert_string_equal(to, cases[i].name);
    }
}

static void test_ends_in(void **state) {
    (void)state;
    assert_true(text_ends_in("a/b.VTU", ".vtu"));
    assert_true(text_ends_in(".vtu", ".vtu"));
    assert_false(text_ends_in("vtu", ".vtu"));
    assert_false(text_ends_in("a.vtu.gz", ".vtu"));
}

static void test_add(void **state) {
    (void)state;
    char text[12] = "one";
    text_add(text, sizeof text, ", %s", "two");
    text_add(text, sizeof text, " %d", 3);
    assert_string_equal(text, "one, two 3");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_name),      cmocka_unit_test(test_cut),
        cmocka_unit_test(test_printable), cmocka_unit_test(test_file_name),
        cmocka_unit_test(test_ends_in),   cmocka_unit_test(test_add)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
