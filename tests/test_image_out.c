/* test_image_out.c - the stream the picture helper is fed, and what becomes of a helper that fails.
 * The helper is played by shell scripts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "render/image_out.h"

static char folder[] = "/tmp/leafcast-image-XXXXXX";
static char helper[128], target[128];
static mem budget;

static void play(const char *script) {
    unlink(helper);
    FILE *f = fopen(helper, "w");
    assert_non_null(f);
    fprintf(f, "#!/bin/sh\n%s\n", script);
    fclose(f);
    chmod(helper, 0755);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&budget, 0);
    if (!mkdtemp(folder))
        return 1;
    char *path = NULL;
    if (asprintf(&path, "%s:%s", folder, getenv("PATH")) < 0)
        return 1;
    setenv("PATH", path, 1);
    free(path);
    snprintf(helper, sizeof helper, "%s/leafcast-write-image", folder);
    snprintf(target, sizeof target, "%s/x.exr", folder);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    unlink(helper);
    unlink(target);
    rmdir(folder);
    return mem_used(&budget) != 0;
}

static float red[6] = {0.25f, 0.5f, 0, 1, 2, 3}, green[6] = {0}, blue[6] = {0};
static float alpha[6] = {0.5f, 1, 0, 1, 1, 1};
static double depth[6] = {1.5, INFINITY, 0.1, 3, 4, 5};
static int32_t ids[6] = {0, -1, 2, 3, 4, 5};
static const leafcast_image IMAGE = {
    .r = red, .g = green, .b = blue, .a = alpha, .z = depth, .id = ids};

static size_t slurp(char *buffer, size_t room) {
    FILE *f = fopen(target, "rb");
    assert_non_null(f);
    const size_t n = fread(buffer, 1, room, f);
    fclose(f);
    return n;
}

static void test_stream(void **state) {
    (void)state;
    play("cat >\"$1\"; [ \"$2\" = --force ]");
    const image_meta meta[] = {{"iso", "80"}};
    assert_int_equal(image_out_write(&budget, target, true, 3, 2, &IMAGE, meta, 1), ST_OK);
    char got[1024];
    const size_t n = slurp(got, sizeof got);
    const size_t head = 20 + 6 * 32 + 4 + 4 + 3 + 4 + 2;
    assert_int_equal(n, head + 6 * 6 * 4);
    assert_memory_equal(got, "LFIM\1\0\0\0\3\0\0\0\2\0\0\0\6\0\0\0", 20);
    const char *names[6] = {"R", "G", "B", "A", "Z", "id"};
    for (int i = 0; i < 6; i++)
        assert_string_equal(got + 20 + 32 * i, names[i]);
    assert_memory_equal(got + 20 + 192, "\1\0\0\0\3\0\0\0iso\2\0\0\00080", 17);
    float planes[6][6];
    memcpy(planes, got + head, sizeof planes);
    assert_memory_equal(planes[0], red, sizeof red);
    assert_true(planes[4][1] == INFINITY && planes[4][2] == 0.1f);
    assert_true(planes[5][1] == -1.0f && planes[5][5] == 5.0f);
}

/* PNG keeps colour and coverage apart. */
static void test_png_is_not_premultiplied(void **state) {
    (void)state;
    char png[128];
    snprintf(png, sizeof png, "%s/x.png", folder);
    play("cat >\"$1\"");
    assert_int_equal(image_out_write(&budget, png, false, 3, 2, &IMAGE, NULL, 0), ST_OK);
    assert_int_equal(rename(png, target), 0);
    char got[1024];
    const size_t n = slurp(got, sizeof got), head = 20 + 4 * 32 + 4;
    assert_int_equal(n, head + 4 * 6 * 4);
    float planes[4][6];
    memcpy(planes, got + head, sizeof planes);
    assert_true(planes[0][0] == 0.5f && planes[0][1] == 0.5f && planes[0][2] == 0.0f);
    assert_memory_equal(planes[3], alpha, sizeof alpha);
}

static void fails(const char *script, status want, const char *says) {
    enum { SIDE = 512 }; /* more than a socket holds */
    static float plane[SIDE * SIDE];
    const leafcast_image image = {.r = plane, .g = plane, .b = plane};
    play(script);
    assert_int_equal(image_out_write(&budget, target, true, SIDE, SIDE, &image, NULL, 0), want);
    if (!strstr(status_text(), says))
        fail_msg("\"%s\" does not say \"%s\"", status_text(), says);
    assert_non_null(strstr(status_text(), "x.exr"));
}

static void test_helper_fails(void **state) {
    (void)state;
    signal(SIGPIPE, SIG_DFL); /* it must not come */
    signal(SIGINT, SIG_DFL);  /* ignored by what runs in the background, and so by its helpers */
    fails("echo leafcast-write-image: no luck >&2; exit 1", ST_IO, "x.exr: no luck");
    fails("cat >/dev/null; echo full >&2; exit 1", ST_IO, "full");
    fails("exit 0", ST_IO, "gave up");
    fails("exit 3", ST_IO, "gave up");
    fails("kill -9 $$", ST_FAILED, "signal 9");
    fails("cat >/dev/null; kill -2 $$", ST_STOPPED, "signal 2");
}

static void test_check(void **state) {
    (void)state;
    play("exit 0");
    unlink(target);
    assert_int_equal(image_out_check(target, false), ST_OK);
    assert_int_equal(image_out_check("x.jpg", false), ST_USAGE);
    assert_int_equal(image_out_check(".png", false), ST_USAGE);
    assert_int_equal(image_out_depth(&budget, target, false, depth, 6), ST_OK);
    assert_int_equal(image_out_check(target, false), ST_EXISTS);
    assert_int_equal(image_out_check(target, true), ST_OK);
    double got[7];
    assert_int_equal(slurp((char *)got, sizeof got), sizeof depth);
    assert_memory_equal(got, depth, sizeof depth);
    unlink(helper);
    if (image_out_check(target, true) != ST_OK) /* unless a real one is on PATH */
        assert_non_null(strstr(status_text(), "leafcast-write-image is not there"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stream),
        cmocka_unit_test(test_png_is_not_premultiplied),
        cmocka_unit_test(test_helper_fails),
        cmocka_unit_test(test_check),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
