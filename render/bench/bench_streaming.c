#include "render/bench/bench_streaming.h"

#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "formats/base/clock.h"
#include "formats/base/pool.h"
#include "formats/leaf/leaf_unpacker.h"
#include "render/bench/bench_store.h"
#include "render/door/leafcast_volume.h"
#include "render/leafcast.h"

/* Columns, in the order of add_row():
 *   first      seconds from opening the file to a preview; exact: to the exact picture
 *   load       the payloads of the picture loaded by as many threads, and nothing else; 0 for
 *              another isovalue, as most are resident
 *   wait       the longest time between two pieces of a render thread's work in which it did not
 *              run; faults: major ones of render threads, cold
 *   frame      the exact picture once more
 *   x cold     exact over the longer of load and frame; x warm: likewise
 * Times in ms; waits and faults are the worst of all runs, other times medians. */
const char bench_streaming_headings[] =
    "volume|file|view|backend|file MB|active MB|visible MB|read MB|loads|first MB|cold first|"
    "cold exact|+-|cold load|cold wait|faults|warm first|warm exact|warm load|warm wait|frame|"
    "x cold|x warm|differ";

enum { FILES = 2, BACKENDS = 2, CASES = FILES * BACKENDS };

/* ---- Views ---- */

typedef enum view_place { VIEW_STANDARD, VIEW_CLOSE, VIEW_INSIDE, VIEW_ISOVALUE, VIEWS } view_place;

static const struct {
    const char *name;
    double distance; /* in longest edges */
} places[VIEWS] = {{"standard", 2.2}, {"close", 1.1}, {"inside", 1.1}, {"isovalue", 2.2}};

static leafcast_camera camera_at(leafcast *volume, view_place place, uint32_t size) {
    leafcast_camera c = leafcast_standard_view(volume, places[place].distance, size, size);
    const leafcast_info info = leafcast_describe(volume);
    for (int a = 0; a < 3 && place == VIEW_INSIDE; a++) {
        const double ahead = c.look_at[a] - c.eye[a];
        c.eye[a] = 0.5 * (info.bounds[0][a] + info.bounds[1][a]) + 0.1234 * info.cell_size;
        c.look_at[a] = c.eye[a] + ahead;
    }
    return c;
}

/* ---- How long render threads stand still ---- */

typedef struct stalls {
    uint64_t picture; /* number of it */
    _Atomic uint64_t wait_ns, faults;
} stalls;

/* What a thread told last, and during which picture: threads may outlive one. */
static _Thread_local struct {
    uint64_t picture;
    double wall, cpu;
    long faults;
} told;

static double thread_seconds(void) {
    struct timespec t;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Called by each render thread before each piece of its work. */
static bool note_stall(void *ctx, double done) {
    stalls *s = ctx;
    struct rusage used = {0};
    (void)done;
    (void)getrusage(RUSAGE_THREAD, &used);
    const double wall = clock_seconds(), cpu = thread_seconds();
    if (told.picture == s->picture) {
        const double idle = fmax(wall - told.wall - (cpu - told.cpu), 0.0);
        const uint64_t ns = (uint64_t)(1e9 * idle);
        uint64_t most = atomic_load(&s->wait_ns);
        while (ns > most && !atomic_compare_exchange_weak(&s->wait_ns, &most, ns))
            ;
        atomic_fetch_add(&s->faults, (uint64_t)(used.ru_majflt - told.faults));
    }
    told.picture = s->picture;
    told.wall = wall;
    told.cpu = cpu;
    told.faults = used.ru_majflt;
    return true;
}

/* ---- One way to a picture ---- */

typedef enum temperature { COLD, WARM, TEMPERATURES } temperature;

typedef struct way {
    const char *file, *path;
    leafcast_backend backend;
    double *first[TEMPERATURES], *exact[TEMPERATURES], *load[TEMPERATURES], *frame;
    double wait[TEMPERATURES];    /* the worst */
    uint64_t faults, first_bytes; /* the most, cold */
    leafcast_stats stats;         /* of the exact picture */
    double *depth;                /* likewise */
} way;

typedef struct streaming {
    bench_job *job;
    view_place place;
    double isovalue;
    uint32_t size;
    float *colours;
    double *passing; /* depths that nobody looks at */
    stalls stalls;
    way ways[CASES];
    int count;
} streaming;

static status draw(streaming *s, leafcast *volume, bool preview, double *depth,
                   leafcast_stats *stats) {
    const size_t pixels = (size_t)s->size * s->size;
    const leafcast_camera view = camera_at(volume, s->place, s->size);
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof(leafcast_image),
                                  .r = s->colours,
                                  .g = s->colours + pixels,
                                  .b = s->colours + 2 * pixels,
                                  .z = depth};
    scene.preview = preview;
    *stats = (leafcast_stats){.size = sizeof *stats};
    s->stalls.picture++;
    s->stalls.wait_ns = s->stalls.faults = 0;
    return (status)leafcast_trace(volume, &scene, &view, &image, stats, note_stall, &s->stalls);
}

static status select_value(leafcast *volume, double isovalue) {
    const leafcast_surface surface = leafcast_surface_default(isovalue);
    return (status)leafcast_select(volume, &surface, 1);
}

/* Open the file, and select what the picture shows. The clock starts with that; for another
 * isovalue, when the picture of the first one has been drawn. */
static status approach(streaming *s, const way *w, bool cold, leafcast **volume, double *start) {
    const leafcast_options options = {.size = sizeof options,
                                      .memory = s->job->memory,
                                      .threads = s->job->threads,
                                      .backend = w->backend};
    if (cold)
        bench_store_forget(w->path);
    *start = clock_seconds();
    status st = (status)leafcast_open(w->path, &options, volume);
    if (st == ST_OK)
        st = select_value(*volume, s->isovalue);
    if (st != ST_OK || s->place != VIEW_ISOVALUE)
        return st;
    leafcast_stats ignored;
    st = draw(s, *volume, false, s->passing, &ignored);
    const double most = leafcast_describe(*volume).value_max;
    if (cold)
        bench_store_forget(w->path);
    *start = clock_seconds();
    return st == ST_OK ? select_value(*volume, s->isovalue + 0.25 * (most - s->isovalue)) : st;
}

static status draw_first(streaming *s, way *w, temperature t, int run) {
    leafcast *volume = NULL;
    leafcast_stats stats = {.size = sizeof stats};
    double start;
    status st = approach(s, w, t == COLD, &volume, &start);
    if (st == ST_OK)
        st = draw(s, volume, true, s->passing, &stats);
    w->first[t][run] = clock_seconds() - start;
    if (st == ST_OK && t == COLD && stats.bytes_read > w->first_bytes)
        w->first_bytes = stats.bytes_read;
    leafcast_close(volume);
    return st;
}

/* ---- The same payloads, and nothing else ---- */

typedef struct loading {
    leaf_file *f;
    const uint32_t *payloads;
    leaf_unpacker **unpackers;
    void **rooms;
} loading;

static status load_one(void *ctx, size_t index, int worker) {
    const loading *x = ctx;
    return leaf_file_load(x->f, x->payloads[index], x->unpackers ? x->unpackers[worker] : NULL,
                          x->rooms[worker]);
}

/* List the payloads of the treelets that the last picture saw. */
static size_t payloads_of(const leafcast *v, uint32_t payloads[]) {
    const leaf_layout *l = &v->file->layout;
    size_t count = 0;
    for (uint32_t t = 0; t < l->treelets; t++) {
        if (!atomic_load_explicit(&v->touched[t], memory_order_relaxed))
            continue;
        payloads[count++] = v->file->mesh ? t : leaf_layout_samples(l, 0, t);
        if (v->file->mesh || v->file->besides)
            payloads[count++] = leaf_layout_values(l, 0, t);
    }
    return count;
}

static status load_seen(streaming *s, const way *w, const uint32_t payloads[], size_t count,
                        bool cold, double *seconds) {
    mem *m = &s->job->m;
    const int threads = s->job->threads;
    loading x = {.payloads = payloads};
    pool *p = NULL;
    status st = leaf_file_open(m, w->path, &x.f);
    if (st == ST_OK)
        st = leaf_unpackers_create(m, x.f, threads, &x.unpackers);
    if (st == ST_OK)
        st = pool_create(m, threads, &p);
    x.rooms = mem_array(m, (size_t)threads, sizeof *x.rooms);
    for (int i = 0; i < threads && x.rooms && st == ST_OK; i++) {
        x.rooms[i] = mem_alloc(m, leaf_layout_payload_max(&x.f->layout));
        st = x.rooms[i] ? ST_OK : ST_NOMEM;
    }
    if (cold)
        bench_store_forget(w->path);
    const double start = clock_seconds();
    if (st == ST_OK)
        st = x.rooms ? pool_run(p, count, load_one, &x) : ST_NOMEM;
    *seconds = clock_seconds() - start;
    pool_destroy(p);
    for (int i = 0; i < threads && x.rooms; i++)
        mem_free(m, x.rooms[i]);
    mem_free(m, x.rooms);
    if (x.f)
        leaf_unpackers_destroy(m, x.unpackers, threads);
    leaf_file_close(x.f);
    return st;
}

/* ---- Runs ---- */

static void note_worst(const streaming *s, way *w, temperature t) {
    w->wait[t] = fmax(w->wait[t], 1e-9 * (double)s->stalls.wait_ns);
    if (t == COLD && s->stalls.faults > w->faults)
        w->faults = s->stalls.faults;
}

static status draw_exact(streaming *s, way *w, temperature t, int run) {
    leafcast *volume = NULL;
    double start;
    status st = approach(s, w, t == COLD, &volume, &start);
    if (st == ST_OK)
        st = draw(s, volume, false, w->depth, &w->stats);
    w->exact[t][run] = clock_seconds() - start;
    if (st == ST_OK) {
        note_worst(s, w, t);
        leafcast_stats ignored;
        const double again = clock_seconds();
        st = draw(s, volume, false, s->passing, &ignored);
        w->frame[run] = clock_seconds() - again;
    }
    uint32_t *payloads =
        volume ? mem_array(&s->job->m, 2 * (size_t)volume->file->layout.treelets, sizeof *payloads)
               : NULL;
    const size_t count = payloads ? payloads_of(volume, payloads) : 0;
    leafcast_close(volume);
    if (st == ST_OK && !payloads)
        st = ST_NOMEM;
    /* Of another isovalue's, most are resident. */
    if (st == ST_OK && s->place != VIEW_ISOVALUE)
        st = load_seen(s, w, payloads, count, t == COLD, &w->load[t][run]);
    mem_free(&s->job->m, payloads);
    return st;
}

/* All ways in turn, run by run. */
static status draw_in_turn(streaming *s) {
    status st = ST_OK;
    for (int run = 0; run < s->job->runs && st == ST_OK; run++) {
        st = progress_step(s->job->progress, places[s->place].name, (double)run / s->job->runs);
        for (int i = 0; i < s->count && st == ST_OK; i++)
            for (int t = 0; t < TEMPERATURES && st == ST_OK; t++) {
                st = draw_first(s, &s->ways[i], (temperature)t, run);
                if (st == ST_OK)
                    st = draw_exact(s, &s->ways[i], (temperature)t, run);
            }
    }
    return st;
}

/* ---- Rows ---- */

static double megabytes(uint64_t bytes) {
    return 1e-6 * (double)bytes;
}

static uint64_t differing(const streaming *s, const way *w) {
    uint64_t count = 0;
    for (size_t i = 0; i < (size_t)s->size * s->size; i++)
        count += memcmp(&w->depth[i], &s->ways->depth[i], sizeof *w->depth) != 0;
    return count;
}

static void add_row(const streaming *s, const char *label, way *w) {
    bench_table *t = &s->job->table;
    const int runs = s->job->runs;
    double spread, exact[TEMPERATURES], load[TEMPERATURES];
    const double frame = bench_median(w->frame, runs, NULL);
    for (int i = 0; i < TEMPERATURES; i++)
        load[i] = bench_median(w->load[i], runs, NULL);
    exact[WARM] = bench_median(w->exact[WARM], runs, NULL);
    exact[COLD] = bench_median(w->exact[COLD], runs, &spread);
    bench_table_add(t, "%s", label);
    bench_table_add(t, "%s", w->file);
    bench_table_add(t, "%s", places[s->place].name);
    bench_table_add(t, "%s", w->backend == LEAFCAST_BACKEND_MAPPED ? "mapped" : "arena");
    bench_table_add(t, "%.3f", megabytes(w->stats.bytes_file));
    bench_table_add(t, "%.3f", megabytes(w->stats.bytes_active));
    bench_table_add(t, "%.3f", megabytes(w->stats.bytes_visible));
    bench_table_add(t, "%.3f", megabytes(w->stats.bytes_read));
    bench_table_add(t, "%llu", (unsigned long long)w->stats.treelets_loaded);
    bench_table_add(t, "%.3f", megabytes(w->first_bytes));
    bench_table_add(t, "%.1f", 1e3 * bench_median(w->first[COLD], runs, NULL));
    bench_table_add(t, "%.1f", 1e3 * exact[COLD]);
    bench_table_add(t, "%.1f", 1e3 * spread);
    bench_table_add(t, "%.1f", 1e3 * load[COLD]);
    bench_table_add(t, "%.1f", 1e3 * w->wait[COLD]);
    bench_table_add(t, "%llu", (unsigned long long)w->faults);
    bench_table_add(t, "%.1f", 1e3 * bench_median(w->first[WARM], runs, NULL));
    bench_table_add(t, "%.1f", 1e3 * exact[WARM]);
    bench_table_add(t, "%.1f", 1e3 * load[WARM]);
    bench_table_add(t, "%.1f", 1e3 * w->wait[WARM]);
    bench_table_add(t, "%.1f", 1e3 * frame);
    bench_table_add(t, "%.2f", exact[COLD] / fmax(load[COLD], frame));
    bench_table_add(t, "%.2f", exact[WARM] / fmax(load[WARM], frame));
    bench_table_add(t, "%llu", (unsigned long long)differing(s, w));
}

/* ---- The suite ---- */

static status prepare(streaming *s) {
    mem *m = &s->job->m;
    const size_t pixels = (size_t)s->size * s->size, runs = (size_t)s->job->runs;
    s->colours = mem_array(m, 3 * pixels, sizeof *s->colours);
    s->passing = mem_array(m, pixels, sizeof *s->passing);
    bool failed = !s->colours || !s->passing;
    for (int i = 0; i < s->count; i++) {
        way *w = &s->ways[i];
        w->depth = mem_array(m, pixels, sizeof *w->depth);
        w->frame = mem_array(m, runs, sizeof *w->frame);
        failed |= !w->depth || !w->frame;
        for (int t = 0; t < TEMPERATURES; t++) {
            w->first[t] = mem_array(m, runs, sizeof(double));
            w->exact[t] = mem_array(m, runs, sizeof(double));
            w->load[t] = mem_array(m, runs, sizeof(double));
            failed |= !w->first[t] || !w->exact[t] || !w->load[t];
        }
    }
    return failed ? ST_NOMEM : ST_OK;
}

static void release(streaming *s) {
    mem *m = &s->job->m;
    for (int i = 0; i < s->count; i++) {
        way *w = &s->ways[i];
        for (int t = 0; t < TEMPERATURES; t++) {
            mem_free(m, w->load[t]);
            mem_free(m, w->exact[t]);
            mem_free(m, w->first[t]);
        }
        mem_free(m, w->frame);
        mem_free(m, w->depth);
    }
    mem_free(m, s->passing);
    mem_free(m, s->colours);
}

static status measure_view(bench_job *job, const bench_subject *subject, const char *compressed,
                           view_place place) {
    const char *const paths[FILES] = {subject->path, compressed};
    static const char *const names[FILES] = {"raw", "zstd"};
    streaming s = {.job = job,
                   .place = place,
                   .isovalue = subject->view.surfaces[0].isovalue,
                   .size = job->view.camera.width};
    for (int i = 0; i < FILES && paths[i]; i++)
        for (int b = 0; b < BACKENDS; b++)
            s.ways[s.count++] =
                (way){.file = subject->name ? names[i] : "-",
                      .path = paths[i],
                      .backend = b ? LEAFCAST_BACKEND_ARENA : LEAFCAST_BACKEND_MAPPED};
    status st = prepare(&s);
    if (st == ST_OK)
        st = draw_in_turn(&s);
    for (int i = 0; i < s.count && st == ST_OK; i++)
        add_row(&s, subject->label, &s.ways[i]);
    release(&s);
    return st;
}

static status measure(bench_job *job, const bench_subject *subject) {
    bench_stored small = {.path = NULL};
    status st = subject->name ? bench_store_compressed(job->store, subject->name, &small) : ST_OK;
    for (int place = 0; place < VIEWS && st == ST_OK; place++)
        st = measure_view(job, subject, small.path, (view_place)place);
    return st;
}

status bench_streaming(bench_job *job) {
    static const char *const names[] = {"bonsai", "engine",         "ct-head-u16", "stent-f32",
                                        "ml-512", "attractor-1024", "bucky-32",    NULL};
    static const char *const brief[] = {"ml-64", "orbital-64", "bucky-12", NULL};
    bench_table_init(&job->table,
                     "What pictures read: MB of the file, of what holds the isovalue, of what rays "
                     "see, of what is read; ms to a first and to the exact picture, with the file "
                     "dropped from the page cache and with it there; runs interleaved",
                     bench_streaming_headings);
    return bench_suite_each(job, names, brief, measure);
}
