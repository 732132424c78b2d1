/* test_shell_line.c - a printed command line, read by a shell, gives the words that went in. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "formats/base/shell_line.h"

/* What a shell makes of `printf '%s|' WORDS`. */
static void heard_by_shell(const char *words, char *heard, size_t room) {
    char command[1024];
    snprintf(command, sizeof command, "printf '%%s|' %s", words);
    FILE *shell = popen(command, "r");
    assert_non_null(shell);
    const size_t n = fread(heard, 1, room - 1, shell);
    heard[n] = 0;
    assert_int_equal(pclose(shell), 0);
}

static void test_words(void **state) {
    (void)state;
    static const char *const words[] = {
        "plain_1-2.leaf", "",         "two words", "it's", "$HOME `id`", "a;b&c|d>e<f", "*?[",
        "new\nline",      "''\\'\"!", "#none ~",   "=ls",  "a=b"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        char text[256], heard[256], expected[256];
        shell_line l = shell_line_begin(text, sizeof text);
        shell_line_word(&l, words[i]);
        heard_by_shell(text, heard, sizeof heard);
        snprintf(expected, sizeof expected, "%s|", words[i]);
        assert_string_equal(heard, expected);
    }
}

static void test_plain(void **state) {
    (void)state;
    char text[64];
    shell_line l = shell_line_begin(text, sizeof text);
    shell_line_put(&l, "leafcast info ");
    shell_line_word(&l, "--dims=1,2,3");
    shell_line_put(&l, " ");
    shell_line_path(&l, "dir/x.raw");
    assert_string_equal(text, "leafcast info --dims=1,2,3 dir/x.raw");
}

static void test_path(void **state) {
    (void)state;
    char text[64];
    shell_line l = shell_line_begin(text, sizeof text);
    shell_line_path(&l, "-o");
    assert_string_equal(text, "./-o");
}

/* A word is there whole or not at all. */
static void test_room(void **state) {
    (void)state;
    for (size_t room = 1; room < 12; room++) {
        char text[16];
        memset(text, 'x', sizeof text);
        shell_line l = shell_line_begin(text, room);
        shell_line_word(&l, "a b'c");
        assert_string_equal(text, room > 10 ? "'a b'\\''c'" : "");
        assert_int_equal(text[room], 'x');
        assert_int_equal(l.full, room <= 10);
    }
}

/* What comes behind a word that did not fit would make another command. */
static void test_full(void **state) {
    (void)state;
    char text[10];
    shell_line l = shell_line_begin(text, sizeof text);
    shell_line_put(&l, "rm ");
    shell_line_word(&l, "a-long-name");
    assert_true(l.full);
    shell_line_put(&l, " -f");
    shell_line_word(&l, "x");
    shell_line_path(&l, "-x");
    assert_string_equal(text, "rm ");
}

/* zsh takes =ls for the path of ls. */
static void test_equals(void **state) {
    (void)state;
    char text[64];
    shell_line l = shell_line_begin(text, sizeof text);
    shell_line_path(&l, "=ls");
    shell_line_put(&l, " ");
    shell_line_word(&l, "a=b");
    assert_string_equal(text, "'=ls' a=b");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_words), cmocka_unit_test(test_plain), cmocka_unit_test(test_path),
        cmocka_unit_test(test_room),  cmocka_unit_test(test_full),  cmocka_unit_test(test_equals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
