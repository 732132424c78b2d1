/* test_json_text.c - of what jansson gives nothing for: malformed text, or no memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/json_text.h"
#include "tests/support/watched.h"

static long fails_at, calls; /* the k-th block is refused; 0: none */

static void *take(size_t size) {
    return ++calls == fails_at ? NULL : malloc(size);
}

static void *take_again(void *block, size_t size) {
    return ++calls == fails_at ? NULL : realloc(block, size);
}

static int refuse_later(void **state) {
    (void)state;
#if JANSSON_VERSION_HEX >= 0x020f00
    json_set_alloc_funcs2(take, take_again, free);
#else
    (void)take_again;
    json_set_alloc_funcs(take, free);
#endif
    return 0;
}

static const char text[] = "{\"shape\": [4, 4, 4], \"name\": \"a name of more than a few bytes, so "
                           "that its buffer grows once, and \\u00e9 twice\", \"x\": 1.5e300}";

/* Each block in turn: what the library has no words for is a lack of memory. */
static void test_no_memory(void **state) {
    (void)state;
    json_t *root = NULL;
    for (fails_at = 1; !root; fails_at++) {
        json_error_t error;
        calls = 0;
        root = json_loadb(text, sizeof text - 1, 0, &error);
        if (root)
            break;
        assert_true(calls >= fails_at);
        const bool silent = !error.text[0];
        assert_int_equal(json_text_status(&error, ST_CORRUPT), silent ? ST_NOMEM : ST_CORRUPT);
        if (silent)
            assert_string_equal(error.text, "no memory to parse it");
    }
    assert_true(fails_at > 10);
    fails_at = 0;
    json_decref(root);
}

/* It calls some of them malformed: not where the system has no memory. */
static void test_short(void **state) {
    (void)state;
    if (WATCHED)
        skip();
    int end = 0;
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        const struct rlimit none = {1 << 16, RLIM_INFINITY};
        json_error_t error = {.text = "string or '}' expected near '\"name\"'"};
        _exit(setrlimit(RLIMIT_DATA, &none) != 0                 ? 99
              : json_text_status(&error, ST_CORRUPT) == ST_NOMEM ? 7
                                                                 : 8);
    }
    assert_int_equal(waitpid(pid, &end, 0), pid);
    assert_true(WIFEXITED(end));
    assert_int_equal(WEXITSTATUS(end), 7);
}

static void test_malformed(void **state) {
    (void)state;
    static const char *const bad[] = {"", "{", "[1,", "{\"a\": }", "\"\xff\"", "{} {}", "1e999"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        json_error_t error;
        assert_null(json_loadb(bad[i], strlen(bad[i]), 0, &error));
        assert_int_equal(json_text_status(&error, ST_CORRUPT), ST_CORRUPT);
        assert_int_equal(json_text_status(&error, ST_USAGE), ST_USAGE);
        assert_true(error.text[0]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_memory),
                                       cmocka_unit_test(test_short),
                                       cmocka_unit_test(test_malformed)};
    return cmocka_run_group_tests(tests, refuse_later, NULL);
}
