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

#include "render/app/image_out.h"

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
static const leafcast_image IMAGE = {.size = sizeof(leafcast_image),
                                     .r = red,
                                     .g = green,
                                     .b = blue,
                                     .a = alpha,
                                     .z = depth,
                                     .id = ids};

static size_t slurp(char *buffer, size_t room) {
    FILE *f = fopen(target, "rb");
    assert_non_null(f);
    const size_t n = fread(buffer, 1, room, f);
    fclose(f);
    return n;
}

static status write_it(const char *path, bool force, uint32_t width, uint32_t height,
                       const leafcast_image *image, const image_meta *meta, size_t count) {
    return image_out_write(
        &budget, path, force,
        &(picture){
            .width = width, .height = height, .image = image, .meta = meta, .meta_count = count});
}

/* The helper's answer is the stream itself. */
static void test_stream(void **state) {
    (void)state;
    enum { HEAD = 28 + 6 * 32 + 4 + 4 + 3 + 4 + 2, SIZE = HEAD + 6 * 6 * 4 };
    char script[128];
    snprintf(script, sizeof script, "printf 'LFOK\\%03o\\%03o\\0\\0\\0\\0\\0\\0'; exec cat",
             SIZE & 255, SIZE >> 8);
    play(script);
    const image_meta meta[] = {{"iso", "80"}};
    assert_int_equal(write_it(target, true, 3, 2, &IMAGE, meta, 1), ST_OK);
    char got[1024];
    assert_int_equal(slurp(got, sizeof got), SIZE);
    assert_memory_equal(got, "LFIM\2\0\0\0exr\0\0\0\0\0\3\0\0\0\2\0\0\0\6\0\0\0", 28);
    const char *names[6] = {"R", "G", "B", "A", "Z", "id"};
    for (int i = 0; i < 6; i++)
        assert_string_equal(got + 28 + 32 * i, names[i]);
    assert_memory_equal(got + 28 + 192, "\1\0\0\0\3\0\0\0iso\2\0\0\00080", 17);
    float planes[6][6];
    memcpy(planes, got + HEAD, sizeof planes);
    assert_memory_equal(planes[0], red, sizeof red);
    assert_true(planes[4][1] == INFINITY && planes[4][2] == 0.1f);
    assert_true(planes[5][1] == -1.0f && planes[5][5] == 5.0f);
}

/* Two pictures, one process: it counts its starts. */
static void test_helper_stays(void **state) {
    (void)state;
    char script[512], again[128], count[128];
    enum { SIZE = 28 + 6 * 32 + 4 + 6 * 6 * 4 };
    snprintf(again, sizeof again, "%s/y.exr", folder);
    snprintf(count, sizeof count, "%s/starts", folder);
    snprintf(script, sizeof script,
             "echo >>%s\nfor i in 1 2; do head -c %d >/dev/null; printf "
             "'LFOK\\003\\0\\0\\0\\0\\0\\0\\0%%s' \"no$i\"; done",
             count, SIZE);
    play(script);
    const image_out_options options = {.force = true, .threads = 1};
    const picture p = {.width = 3, .height = 2, .image = &IMAGE};
    image_out *o = NULL;
    assert_int_equal(image_out_open(&budget, &options, &o), ST_OK);
    const char *const paths[2] = {target, again};
    for (int i = 0; i < 2; i++) {
        image_target *t = NULL;
        assert_int_equal(image_out_begin(o, paths[i], &t), ST_OK);
        assert_int_equal(image_out_finish(t, &p), ST_OK);
    }
    image_out_close(o);
    char got[8] = "";
    assert_int_equal(slurp(got, sizeof got), 3);
    assert_memory_equal(got, "no1", 3);
    assert_int_equal(rename(again, target), 0);
    assert_int_equal(slurp(got, sizeof got), 3);
    assert_memory_equal(got, "no2", 3);
    assert_int_equal(rename(count, target), 0);
    assert_int_equal(slurp(got, sizeof got), 1);
}

static void fails(const char *script, status want, const char *says) {
    enum { SIDE = 512 }; /* more than a socket holds */
    static float plane[SIDE * SIDE];
    const leafcast_image image = {
        .size = sizeof(leafcast_image), .r = plane, .g = plane, .b = plane};
    play(script);
    unlink(target);
    assert_int_equal(write_it(target, false, SIDE, SIDE, &image, NULL, 0), want);
    if (!strstr(status_text(), says))
        fail_msg("\"%s\" does not say \"%s\"", status_text(), says);
    assert_non_null(strstr(status_text(), "x.exr"));
    assert_int_not_equal(access(target, F_OK), 0);
}

static void test_helper_fails(void **state) {
    (void)state;
    signal(SIGPIPE, SIG_DFL); /* it must not come */
    signal(SIGINT, SIG_DFL);  /* ignored by what runs in the background, and so by its helpers */
    fails("echo leafcast-write-image: no luck >&2; exit 1", ST_IO, "x.exr: no luck");
    fails("head -c 3145856 >/dev/null; echo full >&2; exit 1", ST_IO, "full");
    fails("echo leafcast-write-image: no room >&2; exit 4", ST_NOMEM, "x.exr: no room");
    fails("exit 0", ST_IO, "gave up");
    fails("exit 3", ST_IO, "gave up");
    fails("kill -9 $$", ST_FAILED, "signal 9");
    fails("echo so it ends >&2; kill -6 $$", ST_FAILED, "signal 6: so it ends");
    fails("head -c 3145856 >/dev/null; kill -2 $$", ST_STOPPED, "signal 2");
    fails("printf 'LFOK\\377\\0\\0\\0\\0\\0\\0\\0'; exit 1", ST_IO, "gave up");
    fails("head -c 1000 >/dev/null; printf 'LFNO\\0\\0\\0\\0\\0\\0\\0\\0'; exec cat >/dev/null",
          ST_FAILED, "gave no picture");
}

/* More on standard error than a pipe holds, before a byte is read: neither side waits for the
 * other. */
static void test_helper_speaks_first(void **state) {
    (void)state;
    alarm(60);
    fails("head -c 300000 /dev/zero | tr '\\0' x >&2; head -c 3145856 >/dev/null; exit 1", ST_IO,
          "xxx");
    alarm(0);
}

/* A helper that owes no picture is not waited for: it has no time to say that it ended by itself.
 */
static void test_helper_is_let_go(void **state) {
    (void)state;
    char script[256], mark[128];
    snprintf(mark, sizeof mark, "%s/ended", folder);
    snprintf(script, sizeof script, "cat >/dev/null; echo >%s", mark);
    play(script);
    const image_out_options options = {.force = true, .threads = 1};
    image_out *o = NULL;
    image_target *t = NULL;
    assert_int_equal(image_out_open(&budget, &options, &o), ST_OK);
    assert_int_equal(image_out_begin(o, target, &t), ST_OK);
    image_out_discard(t);
    image_out_close(o);
    assert_int_not_equal(access(mark, F_OK), 0);
}

static void test_check(void **state) {
    (void)state;
    const image_out_options plain = {.threads = 1}, force = {.threads = 1, .force = true};
    play("exit 0");
    unlink(target);
    assert_int_equal(image_out_check(&plain, target), ST_OK);
    assert_int_equal(image_out_check(&plain, "x.jpg"), ST_USAGE);
    assert_int_equal(image_out_check(&plain, ".png"), ST_USAGE);
    assert_int_equal(image_out_check(&plain, "x.PnG"), ST_OK);
    assert_false(image_out_wants_all(&plain, "x.png"));
    assert_true(image_out_wants_all(&plain, "x.EXR"));
    image_out *o = NULL;
    image_target *t = NULL;
    assert_int_equal(image_out_open(&budget, &plain, &o), ST_OK);
    assert_int_equal(image_out_begin_raw(o, target, IMAGE_DEPTH, &t), ST_OK);
    assert_int_equal(image_out_finish(t, &(picture){.width = 3, .height = 2, .image = &IMAGE}),
                     ST_OK);
    image_out_close(o);
    assert_int_equal(image_out_check(&plain, target), ST_EXISTS);
    assert_int_equal(image_out_check(&force, target), ST_OK);
    double got[7];
    assert_int_equal(slurp((char *)got, sizeof got), sizeof depth);
    assert_memory_equal(got, depth, sizeof depth);
    unlink(helper);
    if (image_out_check(&force, target) != ST_OK) /* unless a real one is on PATH */
        assert_non_null(strstr(status_text(), "leafcast-write-image is not there"));
    assert_int_equal(image_out_check(&plain, "x.png"), ST_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stream),           cmocka_unit_test(test_helper_stays),
        cmocka_unit_test(test_helper_fails),     cmocka_unit_test(test_helper_speaks_first),
        cmocka_unit_test(test_helper_is_let_go), cmocka_unit_test(test_check),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
