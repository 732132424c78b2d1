#include "render/bench/bench_packets.h"

#include <math.h>

#include "formats/base/clock.h"
#include "render/bench/bench_race.h"
#include "render/ray/open_volume.h"

static const char *const NAMES[] = {"bucky-32", "bucky-2x32", "bucky-4x32", NULL};
static const char *const BRIEF[] = {"bucky-12", NULL};

enum { CONTESTANTS = 5, SMALLEST = 1 };
static const int SIDES[CONTESTANTS] = {0, 2, 4, 8, 16};

/* A count in millions, and how many times as many the smallest packets make of it. */
static void add_count(bench_table *t, uint64_t smallest, uint64_t count) {
    bench_table_add(t, "%.4f", (double)count * 1e-6);
    if (count > 0)
        bench_table_add(t, "%.2f", (double)smallest / (double)count);
    else
        bench_table_add(t, "-");
}

static void add_row(bench_table *t, const bench_subject *s, const bench_racer r[CONTESTANTS],
                    int i) {
    const leafcast_stats *now = &r[i].stats, *first = &r[SMALLEST].stats;
    bench_table_add(t, "%s", s->label);
    bench_table_add(t, "%g", s->view.surfaces[0].isovalue);
    bench_table_add(t, SIDES[i] ? "%dx%d" : "tile", SIDES[i], SIDES[i]);
    bench_table_add(t, "%.2f", r[i].median * 1e3);
    bench_table_add(t, "%.2f", r[i].spread * 1e3);
    bench_table_add(t, "%.3f", r[i].median / r[0].median);
    add_count(t, first->box_tests, now->box_tests);
    add_count(t, first->polygon_tests, now->polygon_tests);
    add_count(t, first->isorange_tests, now->isorange_tests);
    add_count(t, first->isopolygons, now->isopolygons);
    bench_table_add(t, "%.4f", (double)now->interval_tests * 1e-6);
    bench_table_add(t, "%.3f", (double)now->bytes_peak * 1e-6);
    bench_table_add(t, "%llu", (unsigned long long)bench_race_differing(&r[i], &r[0]));
}

static status enter(const bench_subject *s, int side, leafcast_isopolygons how, bench_racer *r) {
    const leafcast_experiments e = {.size = sizeof e, .packets = side, .isopolygons = how};
    const leafcast_options options = {.size = sizeof options, .threads = 1, .experiments = &e};
    const uint32_t size = s->view.camera.width;
    *r = (bench_racer){.scene = leafcast_scene_default()};
    status st = (status)leafcast_open(s->path, &options, &r->volume);
    if (st == ST_OK && !r->volume->kernels.tile)
        st = status_describe(ST_UNSUPPORTED, "this CPU has no vectors for packets");
    if (st == ST_OK)
        st = (status)leafcast_select(r->volume, s->view.surfaces, s->view.isos);
    if (st == ST_OK)
        r->camera = leafcast_standard_view(r->volume, s->view.distance, size, size);
    return st;
}

static status race(bench_job *job, const bench_subject *s) {
    bench_racer r[CONTESTANTS] = {{0}};
    status st = ST_OK;
    for (int i = 0; i < CONTESTANTS && st == ST_OK; i++)
        st = enter(s, SIDES[i], LEAFCAST_ISOPOLYGONS_ONTHEFLY, &r[i]);
    if (st == ST_OK)
        st = bench_race_run(&job->m, r, CONTESTANTS, job->runs, job->progress, NULL, NULL);
    for (int i = 0; i < CONTESTANTS && st == ST_OK; i++)
        add_row(&job->table, s, r, i);
    bench_race_leave(&job->m, r, CONTESTANTS);
    return st;
}

status bench_packets(bench_job *job) {
    bench_table_init(&job->table,
                     "W07 table 4: packets of N x N rays through a mesh, and our tiles; counts in "
                     "millions, x: times fewer than 2x2's. One thread, medians of CPU time, runs "
                     "interleaved",
                     "mesh|isovalue|packets|ms|+-|x tile|box tests|box x|polygon tests|polygon x|"
                     "isorange tests|isorange x|isopolygons|isopolygon x|interval tests|peak MB|"
                     "differ");
    return bench_suite_each(job, NAMES, BRIEF, race);
}

/* ---- isopolygons that are kept ---- */

enum { WAYS = 3, KEEPERS = 2 * WAYS };
static const char *const WAY_NAMES[WAYS] = {"onthefly", "precompute", "cache"};

/* Frames each of which has another isovalue, near the subject's. */
static status draw_new(const bench_subject *s, bench_racer *r, int runs, double *seconds) {
    const leafcast_image image = {.size = sizeof(leafcast_image), .z = r->depth};
    status st = ST_OK;
    for (int run = 0; run < runs && st == ST_OK; run++) {
        leafcast_surface surface = s->view.surfaces[0];
        surface.isovalue *= 1.0 + (run % 2 ? 1e-6 : -1e-6);
        const double start = clock_cpu_seconds();
        st = (status)leafcast_select(r->volume, &surface, 1);
        if (st == ST_OK)
            st = (status)leafcast_trace(r->volume, &r->scene, &r->camera, &image, NULL, NULL, NULL);
        seconds[run] = clock_cpu_seconds() - start;
    }
    return st;
}

static status add_keeper(bench_job *job, const bench_subject *s, bench_racer r[KEEPERS], int i,
                         uint64_t differ) {
    bench_table *t = &job->table;
    double *seconds = mem_array(&job->m, (size_t)job->runs, sizeof *seconds), spread = 0.0;
    status st = seconds ? draw_new(s, &r[i], job->runs, seconds) : ST_NOMEM;
    if (st == ST_OK) {
        bench_table_add(t, "%s", s->label);
        bench_table_add(t, "%g", s->view.surfaces[0].isovalue);
        bench_table_add(t, "%s", i < WAYS ? "tile" : "16x16");
        bench_table_add(t, "%s", WAY_NAMES[i % WAYS]);
        bench_table_add(t, "%.2f", r[i].median * 1e3);
        bench_table_add(t, "%.2f", r[i].spread * 1e3);
        bench_table_add(t, "%.3f", r[i].median / r[i - i % WAYS].median);
        bench_table_add(t, "%.2f", bench_median(seconds, job->runs, &spread) * 1e3);
        bench_table_add(t, "%.3f", (double)r[i].stats.bytes_peak * 1e-6);
        bench_table_add(t, "%llu", (unsigned long long)differ);
    }
    mem_free(&job->m, seconds);
    return st;
}

static status race_keepers(bench_job *job, const bench_subject *s) {
    bench_racer r[KEEPERS] = {{0}};
    uint64_t differ[KEEPERS];
    status st = ST_OK;
    for (int i = 0; i < KEEPERS && st == ST_OK; i++)
        st = enter(s, i < WAYS ? 0 : 16, (leafcast_isopolygons)(i % WAYS), &r[i]);
    if (st == ST_OK)
        st = bench_race_run(&job->m, r, KEEPERS, job->runs, job->progress, NULL, NULL);
    for (int i = 0; i < KEEPERS && st == ST_OK; i++)
        differ[i] = bench_race_differing(&r[i], &r[0]);
    for (int i = 0; i < KEEPERS && st == ST_OK; i++)
        st = add_keeper(job, s, r, i, differ[i]);
    bench_race_leave(&job->m, r, KEEPERS);
    return st;
}

status bench_isopolygons(bench_job *job) {
    bench_table_init(
        &job->table,
        "W07 4.4: isopolygons made on the fly, with the masks, or kept when first met; "
        "new: each frame with another isovalue. One thread, medians of CPU time, runs "
        "interleaved",
        "mesh|isovalue|packets|isopolygons|ms|+-|x onthefly|new ms|peak MB|differ");
    return bench_suite_each(job, NAMES, BRIEF, race_keepers);
}
