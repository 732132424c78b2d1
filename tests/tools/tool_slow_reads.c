/* tool_slow_reads.c - frames whose reads take long, and how often threads wait for a lock.
 *
 *   tool_slow_reads FILE.leaf --iso V [options]
 *
 * Opens the file anew for each frame, so that nothing is resident, and then delays every read:
 *
 *   --us N         by so many microseconds (1000)
 *   --slots N      treelets at a time; several times for several rows (0: all that there are, and a
 *                  quarter and a sixteenth of what the frame reads)
 *   --threads N    that render; several times for several rows (2 and 16)
 *   --size N       pixels on a side (512)
 *   --distance D   of the standard view (1.1)
 *   --light        one, from the side, that casts shadows
 *   --runs N       frames of each row, of which the table has the medians (5)
 *
 * Prints a table: slots, threads, milliseconds of the frame, treelets read, how often all threads
 * came together, and how often one found a lock taken (of any kind: pthread_mutex_lock() of this
 * program counts). A depth that differs from that of the first frame is an error.
 */
#include <dlfcn.h>
#include <getopt.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/fault.h"
#include "render/leafcast_experimental.h"

enum { ROWS_MAX = 8, RUNS_MAX = 99 };

typedef int lock_fn(pthread_mutex_t *);

static atomic_ulong lock_waits;
static _Atomic(lock_fn *) system_lock;

int pthread_mutex_lock(pthread_mutex_t *m) {
    if (pthread_mutex_trylock(m) == 0)
        return 0;
    lock_fn *lock = atomic_load(&system_lock);
    if (!lock) {
        void *found = dlsym(RTLD_NEXT, "pthread_mutex_lock");
        memcpy(&lock, &found, sizeof lock);
        atomic_store(&system_lock, lock);
    }
    atomic_fetch_add_explicit(&lock_waits, 1, memory_order_relaxed);
    return lock(m);
}

typedef struct slow {
    const char *path;
    double iso, distance;
    long us;
    int size, runs, slots_count, threads_count;
    bool light;
    uint32_t slots[ROWS_MAX];
    int threads[ROWS_MAX];
    double *depth, *first;
} slow;

typedef struct row {
    double ms[RUNS_MAX], reads[RUNS_MAX], rounds[RUNS_MAX], waits[RUNS_MAX];
} row;

static _Noreturn void give_up(const char *what) {
    fprintf(stderr, "tool_slow_reads: %s\n", what);
    exit(1);
}

static void must(leafcast_status st) {
    if (st != LEAFCAST_OK)
        give_up(leafcast_error_text());
}

/* A frame of a volume that nobody has looked at. */
static void draw(slow *s, uint32_t slots, int threads, row *r, int run) {
    leafcast *v = NULL;
    const leafcast_experiments e = {.size = sizeof e, .treelet_limit = slots};
    const leafcast_options options = {
        .size = sizeof options, .threads = threads, .experiments = &e};
    const size_t bytes = (size_t)s->size * (size_t)s->size * sizeof *s->depth;
    must(leafcast_open(s->path, &options, &v));
    const leafcast_surface surface = leafcast_surface_default(s->iso);
    leafcast_scene scene = leafcast_scene_default();
    if (s->light) {
        scene.light_count = 1;
        scene.lights[0] = (leafcast_light){.vector = {1, 0.3, 0.9}, .rgb = {1, 1, 1}};
        scene.shadows = true;
    }
    const leafcast_camera camera =
        leafcast_standard_view(v, s->distance, (uint32_t)s->size, (uint32_t)s->size);
    must(leafcast_select(v, &surface, 1));
    leafcast_stats stats = {.size = sizeof stats};
    fault_delay(FAULT_READ, s->us);
    atomic_store(&lock_waits, 0);
    const double start = clock_seconds();
    const leafcast_image image = {.size = sizeof image, .z = s->depth};
    must(leafcast_trace(v, &scene, &camera, &image, &stats, NULL, NULL));
    r->ms[run] = 1e3 * (clock_seconds() - start);
    r->waits[run] = (double)atomic_load(&lock_waits);
    fault_delay(FAULT_READ, 0);
    r->reads[run] = (double)stats.treelets_loaded;
    r->rounds[run] = (double)stats.passes;
    leafcast_close(v);
    if (s->first[0] == 0.0)
        memcpy(s->first, s->depth, bytes);
    if (memcmp(s->first, s->depth, bytes) != 0)
        give_up("the picture differs from the first");
}

static int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *of, int count) {
    qsort(of, (size_t)count, sizeof *of, by_value);
    return of[count / 2];
}

static void measure(slow *s, uint32_t slots, int threads) {
    row r;
    for (int run = 0; run < s->runs; run++)
        draw(s, slots, threads, &r, run);
    printf("%8u %8d %10.1f %8.0f %8.0f %10.0f\n", slots, threads, median(r.ms, s->runs),
           median(r.reads, s->runs), median(r.rounds, s->runs), median(r.waits, s->runs));
    fflush(stdout);
}

/* Without --slots: all that there are, and shares of what a frame reads. */
static void choose_slots(slow *s) {
    row r;
    const long us = s->us;
    s->us = 0;
    draw(s, 0, 2, &r, 0);
    s->us = us;
    s->slots[s->slots_count++] = 0;
    s->slots[s->slots_count++] = (uint32_t)r.reads[0] / 4 + 1;
    s->slots[s->slots_count++] = (uint32_t)r.reads[0] / 16 + 1;
}

static void read_options(slow *s, int argc, char **argv) {
    static const struct option names[] = {
        {"iso", 1, NULL, 'i'},     {"us", 1, NULL, 'u'},    {"slots", 1, NULL, 'p'},
        {"threads", 1, NULL, 't'}, {"size", 1, NULL, 's'},  {"distance", 1, NULL, 'd'},
        {"runs", 1, NULL, 'r'},    {"light", 0, NULL, 'l'}, {NULL, 0, NULL, 0}};
    for (int c; (c = getopt_long(argc, argv, "", names, NULL)) != -1;) {
        switch (c) {
        case 'i': s->iso = atof(optarg); break;
        case 'u': s->us = atol(optarg); break;
        case 'p':
            if (s->slots_count < ROWS_MAX)
                s->slots[s->slots_count++] = (uint32_t)atol(optarg);
            break;
        case 't':
            if (s->threads_count < ROWS_MAX)
                s->threads[s->threads_count++] = atoi(optarg);
            break;
        case 's': s->size = atoi(optarg); break;
        case 'd': s->distance = atof(optarg); break;
        case 'l': s->light = true; break;
        case 'r': s->runs = atoi(optarg) < RUNS_MAX ? atoi(optarg) : RUNS_MAX; break;
        default: give_up("see the head of tests/tools/tool_slow_reads.c");
        }
    }
    if (optind + 1 != argc || s->runs < 1 || s->size < 1)
        give_up("see the head of tests/tools/tool_slow_reads.c");
    s->path = argv[optind];
}

int main(int argc, char **argv) {
    slow s = {.distance = 1.1, .us = 1000, .size = 512, .runs = 5};
    read_options(&s, argc, argv);
    s.depth = calloc((size_t)s.size * (size_t)s.size, sizeof *s.depth);
    s.first = calloc((size_t)s.size * (size_t)s.size, sizeof *s.first);
    if (!s.depth || !s.first)
        give_up("no memory");
    if (s.threads_count == 0) {
        s.threads[s.threads_count++] = 2;
        s.threads[s.threads_count++] = 16;
    }
    if (s.slots_count == 0)
        choose_slots(&s);
    printf("   slots  threads         ms    reads   rounds lock waits\n");
    for (int p = 0; p < s.slots_count; p++)
        for (int t = 0; t < s.threads_count; t++)
            measure(&s, s.slots[p], s.threads[t]);
    free(s.first);
    free(s.depth);
    return 0;
}
