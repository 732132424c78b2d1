/* tool_between.c F.leaf ISO [SIZE [THREADS [RUNS]]] - what a picture at a time between two steps of
 * a series of a grid costs, beside those of the steps: CPU time of all threads, medians, and the
 * bytes that were read. The file needs three steps.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "render/leafcast.h"

enum { RUNS_MAX = 99 };

typedef struct job {
    leafcast *volume;
    leafcast_scene scene;
    leafcast_camera view;
    leafcast_image image;
} job;

static _Noreturn void stop(void) {
    fprintf(stderr, "tool_between: %s\n", leafcast_error_text());
    exit(1);
}

static double cpu_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Draw. Returns the milliseconds; *read: the bytes. */
static double draw(const job *j, uint32_t step, double between, uint64_t *read) {
    leafcast_stats stats = {.size = sizeof stats};
    const double begun = cpu_ms();
    if (leafcast_select_between(j->volume, 0, step, between) != LEAFCAST_OK ||
        leafcast_trace(j->volume, &j->scene, &j->view, &j->image, &stats, NULL, NULL) !=
            LEAFCAST_OK)
        stop();
    *read = stats.bytes_read;
    return cpu_ms() - begun;
}

static void row(const char *name, double *ms, int runs, uint64_t read) {
    qsort(ms, (size_t)runs, sizeof *ms, ascending);
    printf("%-34s %8.1f ms %10llu bytes\n", name, ms[runs / 2], (unsigned long long)read);
}

int main(int argc, char **argv) {
    const uint32_t size = argc > 3 ? (uint32_t)atoi(argv[3]) : 512;
    const leafcast_options o = {.size = sizeof o, .threads = argc > 4 ? atoi(argv[4]) : 2};
    const int runs = argc > 5 && atoi(argv[5]) < RUNS_MAX ? atoi(argv[5]) : 9;
    enum { FIRST, STEP, BETWEEN_FIRST, BETWEEN, ANOTHER, NEXT, ROWS };
    static const char *const names[ROWS] = {"a step, first",        "a step, again",
                                            "between, first",       "between, again",
                                            "another time between", "between the next two"};
    static double ms[ROWS][RUNS_MAX];
    uint64_t read[ROWS] = {0};
    if (argc < 3) {
        fprintf(stderr, "tool_between: F.leaf ISO [SIZE [THREADS [RUNS]]]\n");
        return 2;
    }
    float *plane[3];
    for (int c = 0; c < 3; c++)
        plane[c] = calloc((size_t)size * size, sizeof *plane[c]);
    job j = {.scene = leafcast_scene_default(),
             .image = {.size = sizeof j.image, .r = plane[0], .g = plane[1], .b = plane[2]}};
    for (int i = 0; i < runs; i++) {
        const leafcast_surface surface = leafcast_surface_default(atof(argv[2]));
        if (leafcast_open(argv[1], &o, &j.volume) != LEAFCAST_OK ||
            leafcast_select(j.volume, &surface, 1) != LEAFCAST_OK)
            stop();
        j.view = leafcast_standard_view(j.volume, 2.2, size, size);
        ms[FIRST][i] = draw(&j, 0, 0, &read[FIRST]);
        ms[STEP][i] = draw(&j, 0, 0, &read[STEP]);
        ms[BETWEEN_FIRST][i] = draw(&j, 0, 0.5, &read[BETWEEN_FIRST]);
        ms[BETWEEN][i] = draw(&j, 0, 0.5, &read[BETWEEN]);
        ms[ANOTHER][i] = draw(&j, 0, 0.55, &read[ANOTHER]);
        ms[NEXT][i] = draw(&j, 1, 0.5, &read[NEXT]);
        leafcast_close(j.volume);
    }
    for (int r = 0; r < ROWS; r++)
        row(names[r], ms[r], runs, read[r]);
    for (int c = 0; c < 3; c++)
        free(plane[c]);
    return 0;
}
