/* test_fork.c - a child of fork() is told that volumes, devices and frames from before are not its
 * own, by every call that needs threads or locks, while they are held or not; closing them does not
 * hang; what it opens itself works; the parent goes on with the same bits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/fixture.h"
#include "tests/support/public_calls.h"

enum { PATIENCE_S = 60, REFUSED = 2, NAMED = 3, DRAWN = 4 };

/* Calls that need no more than the file, or nothing. */
static bool works_anywhere(const char *name) {
    static const char *const names[] = {
        "leafcast_device_create", "leafcast_open",          "leafcast_open_memory",
        "leafcast_open_live",     "leafcast_get_info",      "leafcast_find_field",
        "leafcast_find_time",     "leafcast_range",         "leafcast_find_steps",
        "leafcast_init_scene",    "leafcast_pixel_ray",     "leafcast_get_standard_view",
        "leafcast_get_histogram", "leafcast_data_range",    "leafcast_suggested_isovalues",
        "leafcast_fit_view",      "leafcast_fit_slice",     "leafcast_plane_slice",
        "leafcast_layer_slice",   "leafcast_open_triangles"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return strncmp(name, "leafcast_convert_", 17) == 0;
}

/* The child's exit status: what is wrong, or 0. */
static int child(calls_lab *l, const double z[CALLS_SIDE * CALLS_SIDE]) {
    int count;
    const public_call *calls = public_calls(&count);
    alarm(PATIENCE_S);
    for (int i = 0; i < count; i++) {
        const bool works = calls[i].call && works_anywhere(calls[i].name);
        const leafcast_status st = calls[i].call ? calls[i].call(l) : LEAFCAST_OK;
        if (calls[i].call && (st == LEAFCAST_USAGE) == works) {
            fprintf(stderr, "%s(): status %d, \"%s\"\n", calls[i].name, (int)st,
                    leafcast_error_text());
            return REFUSED;
        }
        if (calls[i].call && !works && !strstr(leafcast_error_text(), "fork"))
            return NAMED;
    }
    const leafcast_options on_it = {.size = sizeof on_it, .device = l->device};
    leafcast *other = NULL;
    if (leafcast_open(l->p[CALLS_PATH], &on_it, &other) != LEAFCAST_USAGE)
        return REFUSED;
    if (leafcast_describe(l->p[CALLS_LIVE]).steps != 1)
        return REFUSED;
    leafcast_close(l->p[CALLS_LIVE]);
    leafcast_stop_reading(l->p[CALLS_VOLUME]);
    leafcast_frame_cancel(l->p[CALLS_FRAME]);
    leafcast_frame_end(l->p[CALLS_FRAME]);
    leafcast_close(l->p[CALLS_VOLUME]);
    leafcast_device_destroy(l->device);
    double own[CALLS_SIDE * CALLS_SIDE];
    l->p[CALLS_VOLUME] = fixture_open(l->p[CALLS_PATH], &(leafcast_options){.size = sizeof on_it});
    public_calls_draw(l, own);
    leafcast_close(l->p[CALLS_VOLUME]);
    return memcmp(own, z, sizeof own) == 0 ? 0 : DRAWN;
}

static void check_fork(calls_lab *l, const double z[CALLS_SIDE * CALLS_SIDE]) {
    int how = -1;
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0)
        _exit(child(l, z));
    assert_int_equal(waitpid(pid, &how, 0), pid);
    if (!WIFEXITED(how) || WEXITSTATUS(how) != 0)
        fail_msg("the child ends with %s %d", WIFEXITED(how) ? "status" : "signal",
                 WIFEXITED(how) ? WEXITSTATUS(how) : WTERMSIG(how));
}

static void test_quiet(void **state) {
    calls_lab *l = *state;
    double z[CALLS_SIDE * CALLS_SIDE], after[CALLS_SIDE * CALLS_SIDE];
    public_calls_draw(l, z);
    check_fork(l, z);
    public_calls_draw(l, after);
    assert_memory_equal(z, after, sizeof z);
}

/* ---- While a picture is drawn ---- */

typedef struct held {
    calls_lab *lab;
    atomic_bool there, end;
} held;

static bool watch(void *ctx, double done) {
    held *h = ctx;
    (void)done;
    atomic_store(&h->there, true);
    while (!atomic_load(&h->end))
        usleep(1000);
    return true;
}

static void *hold(void *arg) {
    held *h = arg;
    const leafcast_scene scene = leafcast_scene_default();
    (void)leafcast_trace(h->lab->p[CALLS_VOLUME], &scene, h->lab->p[CALLS_CAMERA],
                         h->lab->p[CALLS_IMAGE], NULL, watch, h);
    return NULL;
}

static void test_held(void **state) {
    held h = {.lab = *state};
    double z[CALLS_SIDE * CALLS_SIDE], after[CALLS_SIDE * CALLS_SIDE];
    pthread_t thread;
    public_calls_draw(h.lab, z);
    assert_int_equal(pthread_create(&thread, NULL, hold, &h), 0);
    while (!atomic_load(&h.there))
        usleep(1000);
    check_fork(h.lab, z);
    atomic_store(&h.end, true);
    pthread_join(thread, NULL);
    public_calls_draw(h.lab, after);
    assert_memory_equal(z, after, sizeof z);
}

static int set_up(void **state) {
    static calls_lab lab;
    public_calls_set_up(&lab);
    assert_int_equal(leafcast_device_create(NULL, &lab.device), LEAFCAST_OK);
    *state = &lab;
    return 0;
}

static int tear_down(void **state) {
    calls_lab *l = *state;
    public_calls_tear_down(l);
    leafcast_device_destroy(l->device);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_quiet), cmocka_unit_test(test_held)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
