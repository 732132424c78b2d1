/* test_script_lines.c - which lines of a script have come, and which step or time they show.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "render/app/render_script.h"
#include "tests/support/scratch.h"

static void next_is(const script_reader *r, size_t *at, const char *want) {
    const char *line;
    size_t size;
    if (!want) {
        assert_false(script_peek(r, at, &line, &size));
        return;
    }
    assert_true(script_peek(r, at, &line, &size));
    assert_int_equal(size, strlen(want));
    assert_memory_equal(line, want, size);
}

static void take(script_reader *r, const char *want) {
    const char *line;
    size_t size;
    long number;
    assert_int_equal(script_line(r, NULL, NULL, &line, &size, &number), ST_OK);
    assert_non_null(line);
    assert_int_equal(size, strlen(want));
    assert_memory_equal(line, want, size);
}

/* All of a file, but for blank lines; what is peeked at is still returned. */
static void test_peek(void **state) {
    (void)state;
    mem m;
    script_reader *r;
    const char *text = "\n{1}\n \t\r\n{22}\n\n{3}\n{4}";
    size_t at = 0;
    mem_init(&m, 0);
    assert_int_equal(script_open(&m, scratch_write("lines", text, strlen(text)), &r), ST_OK);
    next_is(r, &at, NULL); /* nothing was read yet */
    take(r, "{1}");
    at = 0;
    next_is(r, &at, "{22}");
    next_is(r, &at, "{3}");
    next_is(r, &at, NULL); /* whether the last one is whole is not known yet */
    take(r, "{22}");
    take(r, "{3}");
    take(r, "{4}");
    at = 0;
    next_is(r, &at, NULL);
    script_close(r);
    assert_int_equal(mem_used(&m), 0);
}

/* Of a pipe, what has come, and whole lines alone. */
static void test_peek_pipe(void **state) {
    (void)state;
    mem m;
    script_reader *r;
    int end[2];
    char path[32];
    size_t at = 0;
    mem_init(&m, 0);
    assert_int_equal(pipe(end), 0);
    snprintf(path, sizeof path, "/dev/fd/%d", end[0]);
    assert_int_equal(script_open(&m, path, &r), ST_OK);
    assert_int_equal(write(end[1], "{1}\n{2", 6), 6);
    take(r, "{1}");
    next_is(r, &at, NULL);
    assert_int_equal(write(end[1], "2}\n{3}\n{4}", 10), 10);
    take(r, "{22}");
    at = 0;
    next_is(r, &at, "{3}");
    next_is(r, &at, NULL);
    close(end[1]);
    take(r, "{3}");
    take(r, "{4}");
    script_close(r);
    close(end[0]);
}

static bool foresee(view_options *v, const char *line) {
    return script_foresee_line(v, line, strlen(line));
}

static void test_foresee(void **state) {
    (void)state;
    static view_options v;
    view_options_init(&v);
    assert_true(foresee(&v, "{\"step\": 7, \"field\": \"b\", \"fov\": 99, \"output\": \"x.png\"}"));
    assert_true(v.step == 7 && strcmp(v.field, "b") == 0 && !v.time.given);
    assert_true(foresee(&v, "{\"time\": 2.5, \"interpolate\": true}"));
    assert_true(v.time.given && v.time.interpolate && v.time.time == 2.5);
    assert_true(foresee(&v, "{\"step\": 8}") && v.step == 8 && !v.time.given);
    assert_true(foresee(&v, "{}") && v.step == 8);
    static const char *const wrong[] = {
        "", "{", "[8]", "{\"step\": -1}", "{\"step\": 1, \"step\": 2}", "{\"interpolate\": 3}"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_false(foresee(&v, wrong[i]));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_peek),
        cmocka_unit_test(test_peek_pipe),
        cmocka_unit_test(test_foresee),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
