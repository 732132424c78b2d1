/* test_plot3d_text.c - numbers of text as Fortran writes them, in runs from anywhere; words that
 * are none.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/curvilinear/plot3d_text.h"

/* Read numbers of a text. */
static status read_text(const char *text, uint64_t first, size_t count, double *out) {
    mem m;
    mem_init(&m, 1 << 20);
    file *f;
    plot3d_text *t;
    assert_int_equal(file_open_memory(&m, "a.xyz", text, strlen(text), &f), ST_OK);
    status st = plot3d_text_open(&m, f, &t);
    if (st == ST_OK)
        st = plot3d_text_read(t, first, count, out);
    plot3d_text_close(t);
    file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static void test_words_of_text(void **state) {
    (void)state;
    static const char text[] = "3*2, -.5,+1.5D+2 1.25-103\t7.\n2*1e2\r\n1d0 -0 nan 4000000*9,inf";
    static const double want[] = {2, 2, 2, -0.5, 150, 1.25e-103, 7, 100, 100, 1, 0};
    double v[16];
    for (size_t first = 0; first < 11; first++)
        for (size_t count = 0; first + count <= 11; count++) {
            assert_int_equal(read_text(text, first, count, v), ST_OK);
            for (size_t i = 0; i < count; i++)
                assert_true(v[i] == want[first + i]);
        }
    assert_int_equal(read_text(text, 11, 2, v), ST_OK);
    assert_true(isnan(v[0]) && v[1] == 9);
    assert_int_equal(read_text(text, 4000011, 2, v), ST_OK);
    assert_true(v[0] == 9 && v[1] == INFINITY);
    static const char *const bad[] = {"1 2\n\n3 x", "1\n2\n3 *4", "1\n\n0*2", "1\n\n2*",
                                      "1\n\n1.2.3", "1\n\n1e",    "1\n\n--1", "1\n\n3*4*5"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(read_text(bad[i], 0, i < 2 ? 4 : 2, v), ST_CORRUPT);
        if (!strstr(status_text(), "a.xyz: line 3: \""))
            fail_msg("%s", status_text());
    }
}

/* Marks, read back and forth; a buffer's end in a word. */
static void test_marks_of_text(void **state) {
    (void)state;
    enum { COUNT = 40000 };
    static char text[COUNT * 8];
    double v[3000];
    size_t size = 0;
    for (int i = 0; i < COUNT; i++)
        size += (size_t)sprintf(text + size, i % 7 ? "%d\n" : "1*%d ", i);
    mem m;
    mem_init(&m, 1 << 20);
    file *f;
    plot3d_text *t;
    assert_int_equal(file_open_memory(&m, "a.xyz", text, size, &f), ST_OK);
    assert_int_equal(plot3d_text_open(&m, f, &t), ST_OK);
    assert_int_equal(plot3d_text_count(t), COUNT);
    static const uint64_t from[] = {0,     3000,  1,     1023,  1024, 1025,
                                    37000, 36000, 36500, 20479, 20480};
    for (size_t i = 0; i < sizeof from / sizeof *from; i++) {
        assert_int_equal(plot3d_text_read(t, from[i], 3000, v), ST_OK);
        for (size_t k = 0; k < 3000; k++)
            assert_true(v[k] == (double)(from[i] + k));
    }
    plot3d_text_close(t);
    file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_words_of_text),
        cmocka_unit_test(test_marks_of_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
