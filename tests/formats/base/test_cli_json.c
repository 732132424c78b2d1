/* test_cli_json.c - results as JSON: whole, or an error that says why not. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "formats/base/fault.h"
#include "formats/leaf/histogram_text.h"

static status write_histogram(char **text) {
    histogram h = {.bins = 9};
    size_t size = 0;
    for (int i = 0; i < 10; i++)
        h.edges[i] = i - 3.5;
    FILE *out = open_memstream(text, &size);
    assert_non_null(out);
    status st = cli_json_write(out, histogram_json(&h, true), true);
    fclose(out);
    return st;
}

/* The k-th allocation fails, until there are no more. */
static void test_no_memory(void **state) {
    (void)state;
    char *whole, *text;
    long k = 0;
    assert_int_equal(write_histogram(&whole), ST_OK);
    assert_non_null(strstr(whole, "\"edges\":[-3.5,-2.5,-1.5,-0.5,0.5,1.5,2.5,3.5,4.5,5.5]"));
    for (bool fired = true; fired;) {
        fault_arm(FAULT_ALLOC, ++k);
        const status st = write_histogram(&text);
        fired = fault_fired(FAULT_ALLOC);
        fault_arm(FAULT_ALLOC, 0);
        assert_int_equal(st, fired ? ST_NOMEM : ST_OK);
        assert_string_equal(text, fired ? "" : whole);
        free(text);
        /* The error itself can be told. */
        assert_int_equal(write_histogram(&text), ST_OK);
        free(text);
    }
    assert_true(k > 50);
    free(whole);
}

static void test_no_document(void **state) {
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_int_equal(cli_json_write(out, json_string("\xf8\x90\x80\x80"), true), ST_FAILED);
    fclose(out);
    assert_string_equal(text, "");
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_memory),
                                       cmocka_unit_test(test_no_document)};
    cli_json_watch();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
