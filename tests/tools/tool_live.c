/* tool_live.c - what a step of a live volume costs: a sphere of which every sample changes, or,
 * with `part`, an eighth of it.
 *
 *     tool_live NODES u8|u16|f32 THREADS ROUNDS [part]
 *
 * Medians in ms, by the clock and of all threads' CPU time: all samples given, the step committed,
 * its first picture of 256 x 256 (treelets copied, their codes and masks made), and the second one.
 * Beside these, all samples copied by one thread's memcpy().
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "render/leafcast.h"

enum { ROUNDS_MAX = 101, SIDE = 256, STAGES = 5 };

static const char *const stages[STAGES] = {"memcpy", "update", "commit", "first", "second"};

typedef struct job {
    uint32_t nodes;
    size_t width, bytes;
    leafcast_grid grid;
    char *samples[2], *copy;
    leafcast *volume;
    double clock[STAGES][ROUNDS_MAX], cpu[STAGES][ROUNDS_MAX];
} job;

static double seconds(clockid_t of) {
    struct timespec now;
    clock_gettime(of, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void needs(leafcast_status st) {
    if (st == LEAFCAST_OK)
        return;
    fprintf(stderr, "%s\n", leafcast_error_text());
    exit((int)st);
}

/* Squared distances from the middle, in the second step one more; all samples differ then. */
static void fill(job *j, int which, bool part) {
    const double middle = 0.5 * (j->nodes - 1), most = 3 * middle * middle;
    char *to = j->samples[which];
    for (uint32_t z = 0; z < j->nodes; z++)
        for (uint32_t y = 0; y < j->nodes; y++)
            for (uint32_t x = 0; x < j->nodes; x++, to += j->width) {
                const double a = x - middle, b = y - middle, c = z - middle;
                const double share = (a * a + b * b + c * c) / most;
                const bool moves = !part || (x < middle && y < middle && z < middle);
                const uint32_t whole =
                    (uint32_t)(share * (j->width == 1 ? 250 : 60000)) + (moves ? which : 0);
                const float real = (float)whole;
                memcpy(to, j->width == 4 ? (const void *)&real : &whole, j->width);
            }
}

static void draw(const job *j) {
    static double z[SIDE * SIDE];
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera camera = leafcast_standard_view(j->volume, 2.2, SIDE, SIDE);
    const leafcast_image image = {.size = sizeof image, .z = z};
    needs(leafcast_trace(j->volume, &scene, &camera, &image, NULL, NULL, NULL));
}

static void run(job *j, int stage, int round) {
    const double start = seconds(CLOCK_MONOTONIC), cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    switch (stage) {
    case 0: memcpy(j->copy, j->samples[round & 1], j->bytes); break;
    case 1: needs(leafcast_update(j->volume, NULL, NULL, j->samples[round & 1], NULL)); break;
    case 2: needs(leafcast_commit(j->volume, round)); break;
    default: draw(j);
    }
    j->clock[stage][round] = 1e3 * (seconds(CLOCK_MONOTONIC) - start);
    j->cpu[stage][round] = 1e3 * (seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu);
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double of[], int count) {
    qsort(of, (size_t)count, sizeof *of, by_size);
    return of[count / 2];
}

int main(int argc, char **argv) {
    static job j;
    const char *const types[] = {"u8", "u16", "f32"};
    const leafcast_sample_type type_of[] = {LEAFCAST_U8, LEAFCAST_U16, LEAFCAST_F32};
    int type = 0;
    while (argc >= 5 && type < 3 && strcmp(argv[2], types[type]) != 0)
        type++;
    const int rounds = argc >= 5 ? atoi(argv[4]) : 0;
    if (argc < 5 || type == 3 || rounds < 1 || rounds > ROUNDS_MAX) {
        fprintf(stderr, "tool_live NODES u8|u16|f32 THREADS ROUNDS [part]\n");
        return 2;
    }
    const bool part = argc > 5;
    j.nodes = (uint32_t)atoi(argv[1]);
    j.width = (size_t)1 << type;
    j.bytes = (size_t)j.nodes * j.nodes * j.nodes * j.width;
    j.grid = (leafcast_grid){
        .size = sizeof j.grid, .dims = {j.nodes, j.nodes, j.nodes}, .type = type_of[type]};
    j.copy = calloc(j.bytes, 1);
    for (int i = 0; i < 2; i++) {
        j.samples[i] = malloc(j.bytes);
        if (!j.samples[i] || !j.copy)
            return LEAFCAST_NOMEM;
        fill(&j, i, part);
    }
    const leafcast_options options = {.size = sizeof options, .threads = atoi(argv[3])};
    const leafcast_surface surface = leafcast_surface_default(type == 0 ? 50.5 : 12000.5);
    needs(leafcast_open_live(&j.grid, &options, &j.volume));
    needs(leafcast_select(j.volume, &surface, 1));
    for (int round = 0; round < rounds; round++)
        for (int stage = 0; stage < STAGES; stage++)
            run(&j, stage, round);
    printf("%u^3 %s, %s threads:", j.nodes, argv[2], argv[3]);
    for (int stage = 0; stage < STAGES; stage++)
        printf(" %s %.2f (CPU %.2f)", stages[stage], median(j.clock[stage], rounds),
               median(j.cpu[stage], rounds));
    printf(" ms\n");
    leafcast_close(j.volume);
    free(j.copy);
    free(j.samples[0]);
    free(j.samples[1]);
    return 0;
}
