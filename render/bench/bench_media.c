#include "render/bench/bench_media.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/app/view_camera.h"

/* ---- Ways ---- */

typedef struct way {
    const char *name, *setting;
    double error; /* certified: what is asked for */
    double share; /* of the values: a threshold of homogeneity */
    leafcast_scene_experiments how;
} way;

#define CERTIFIED(text, e)                             \
    {                                                  \
        "certified", text, e, 0.0, {                   \
            .size = sizeof(leafcast_scene_experiments) \
        }                                              \
    }
#define STEPS(text, h)                                                                       \
    {                                                                                        \
        "steps", text, 0.0, 0.0, {                                                           \
            .size = sizeof(leafcast_scene_experiments), .summing = LEAFCAST_STEPS, .step = h \
        }                                                                                    \
    }

#define PREINTEGRATED(text, h, side)                                                       \
    {                                                                                      \
        "preintegrated-" #side, text, 0.0, 0.0, {                                          \
            .size = sizeof(leafcast_scene_experiments), .summing = LEAFCAST_PREINTEGRATED, \
            .step = h, .table = side                                                       \
        }                                                                                  \
    }

/* Nodes whose values differ by less than that share of all are taken as if they had one. */
#define THRESHOLD(text, part)                          \
    {                                                  \
        "threshold", text, 1.0 / 510.0, part, {        \
            .size = sizeof(leafcast_scene_experiments) \
        }                                              \
    }

static const way WAYS[] = {CERTIFIED("1", 1.0),
                           CERTIFIED("1/4", 0x1p-2),
                           CERTIFIED("1/16", 0x1p-4),
                           CERTIFIED("1/64", 0x1p-6),
                           CERTIFIED("1/256", 0x1p-8),
                           CERTIFIED("1/510", 1.0 / 510.0),
                           CERTIFIED("1/1024", 0x1p-10),
                           CERTIFIED("1/4096", 0x1p-12),
                           STEPS("2", 2.0),
                           STEPS("1", 1.0),
                           STEPS("1/2", 0.5),
                           STEPS("1/4", 0.25),
                           STEPS("1/8", 0.125),
                           STEPS("1/16", 0.0625),
                           STEPS("1/32", 0.03125),
                           PREINTEGRATED("2", 2.0, 256),
                           PREINTEGRATED("1", 1.0, 256),
                           PREINTEGRATED("1/2", 0.5, 256),
                           PREINTEGRATED("1/4", 0.25, 256),
                           PREINTEGRATED("1/8", 0.125, 256),
                           PREINTEGRATED("1/16", 0.0625, 256),
                           PREINTEGRATED("1", 1.0, 512),
                           PREINTEGRATED("1/2", 0.5, 512),
                           PREINTEGRATED("1/4", 0.25, 512),
                           PREINTEGRATED("1/8", 0.125, 512),
                           THRESHOLD("3/4", 0.75),
                           THRESHOLD("1/2", 0.5),
                           THRESHOLD("1/4", 0.25),
                           THRESHOLD("1/16", 0.0625)};
enum { WAY_COUNT = sizeof WAYS / sizeof *WAYS };

/* Those that certified ones are compared with: columns. */
static const char *const OTHERS[] = {"steps", "preintegrated-256", "preintegrated-512"};
enum { OTHER_COUNT = sizeof OTHERS / sizeof *OTHERS };

static const char HEADINGS[] =
    "volume|transfer|way|setting|ms|+-|worst|99 %|rms|> 1/510 %|claimed|ref bound|speed-up|"
    "steps/this|pre-256/this|pre-512/this|cells/ray|read MB|front";

typedef struct entrant {
    double *seconds; /* of every run */
    double median, spread, claimed;
    bench_media_error error;
    leafcast_stats stats;
    bool front;
} entrant;

typedef struct trial {
    mem *m;
    const bench_subject *subject;
    const char *transfer;
    leafcast *volume;
    transfer_list points;
    leafcast_medium medium;
    leafcast_shown shown;
    leafcast_camera camera;
    size_t pixels;
    double *truth, *rgba, *error, *offs;
    double bound; /* of the truth */
    double range; /* from the least to the greatest value */
    entrant all[WAY_COUNT];
} trial;

/* ---- Transfer functions ---- */

static void thin_out(transfer_list *t, double factor) {
    for (size_t i = 0; i < t->count; i++)
        t->points[i].extinction *= factor;
}

status bench_media_transfer(const char *name, const leafcast *volume, transfer_list *out) {
    const bool opaque = strcmp(name, "opaque") == 0, thin = strcmp(name, "thin") == 0;
    medium_options o = {.opacities = 0};
    double range[2];
    status st = (status)leafcast_range(volume, 0, 0, range);
    if (st == ST_OK && strcmp(name, "positive") == 0) {
        snprintf(o.colour_map, sizeof o.colour_map, "viridis");
        for (int i = 0; i < 2; i++) {
            o.opacity[i][0] = range[i];
            o.opacity[i][1] = i ? 0.8 : 0.05;
        }
        o.opacities = 2;
    } else if (st == ST_OK) {
        st = medium_options_set(&o, MEDIUM_TF, opaque || thin ? "auto" : name);
    }
    if (st == ST_OK)
        st = medium_options_make(&o, volume, 0, 0, false, out);
    if (st == ST_OK)
        thin_out(out, opaque ? 10.0 : thin ? 0.1 : 1.0);
    return st;
}

/* ---- Pictures ---- */

/* Of the volume, into t->rgba and t->error. */
static status draw(trial *t, const way *w, double *seconds, leafcast_stats *stats) {
    leafcast_scene scene = t->subject->view.scene;
    const leafcast_image image = {
        .size = sizeof(leafcast_image), .rgba = t->rgba, .error = t->error};
    scene.volumes = &t->shown;
    scene.volume_count = 1;
    scene.media = &t->medium;
    scene.media_count = 1;
    leafcast_scene_experiments how = w->how;
    how.homogeneous = w->share * t->range;
    scene.experiments = &how;
    scene.error = w->error;
    stats->size = sizeof *stats;
    const double start = clock_cpu_seconds();
    status st = (status)leafcast_trace(t->volume, &scene, &t->camera, &image, stats, NULL, NULL);
    *seconds = clock_cpu_seconds() - start;
    return st;
}

static double most_of(const double *x, size_t count) {
    double most = 0.0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, x[i]);
    return most;
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bench_media_error bench_media_judge(const double *rgba, const double *truth, size_t pixels,
                                    double *offs) {
    bench_media_error e = {0};
    double sum = 0.0;
    size_t beyond = 0;
    for (size_t i = 0; i < pixels; i++) {
        double most = 0.0;
        for (size_t c = 4 * i; c < 4 * i + 4; c++) {
            offs[c] = fabs(rgba[c] - truth[c]);
            most = fmax(most, offs[c]);
            sum += offs[c] * offs[c];
        }
        beyond += most > 1.0 / 510.0;
    }
    qsort(offs, 4 * pixels, sizeof *offs, by_size);
    e.worst = offs[4 * pixels - 1];
    e.p99 = offs[(size_t)(0.99 * (double)(4 * pixels - 1))];
    e.rms = sqrt(sum / (4.0 * (double)pixels));
    e.share = (double)beyond / (double)pixels;
    return e;
}

/* The reference, which also brings in what is needed. */
static status draw_truth(trial *t) {
    static const way exact = CERTIFIED("1e-6", 1e-6);
    leafcast_stats stats;
    double ignored;
    status st = draw(t, &exact, &ignored, &stats);
    memcpy(t->truth, t->rgba, 4 * t->pixels * sizeof *t->truth);
    t->bound = most_of(t->error, t->pixels);
    return st;
}

static status race(bench_job *job, trial *t) {
    status st = draw_truth(t);
    for (int run = 0; run < job->runs && st == ST_OK; run++) {
        st = progress_step(job->progress, "drawing", (double)run / job->runs);
        for (int i = 0; i < WAY_COUNT && st == ST_OK; i++) {
            entrant *e = &t->all[i];
            st = draw(t, &WAYS[i], &e->seconds[run], &e->stats);
            if (run > 0)
                continue;
            e->claimed = most_of(t->error, t->pixels);
            e->error = bench_media_judge(t->rgba, t->truth, t->pixels, t->offs);
        }
    }
    for (int i = 0; i < WAY_COUNT && st == ST_OK; i++)
        t->all[i].median = bench_median(t->all[i].seconds, job->runs, &t->all[i].spread);
    return st;
}

/* ---- What is made of it ---- */

static void find_front(trial *t) {
    for (int i = 0; i < WAY_COUNT; i++) {
        entrant *e = &t->all[i];
        e->front = true;
        for (int k = 0; k < WAY_COUNT; k++) {
            const entrant *o = &t->all[k];
            e->front &= !(o->median <= e->median && o->error.worst <= e->error.worst &&
                          (o->median < e->median || o->error.worst < e->error.worst));
        }
    }
}

/* The least time in which a way comes as near as that, between neighbouring settings by the
 * logarithms of both. INFINITY: it never does. */
static double time_to_reach(const trial *t, const char *name, double worst) {
    double least = INFINITY;
    for (int i = 0; i < WAY_COUNT; i++) {
        if (strcmp(WAYS[i].name, name) != 0 || t->all[i].error.worst > worst)
            continue;
        const entrant *fine = &t->all[i], *coarse = fine - 1;
        const bool between = i > 0 && strcmp(WAYS[i - 1].name, name) == 0 &&
                             coarse->error.worst > worst && coarse->median < fine->median &&
                             fine->error.worst > 0.0;
        const double share =
            between ? log(worst / fine->error.worst) / log(coarse->error.worst / fine->error.worst)
                    : 0.0;
        least =
            fmin(least, fine->median * pow(coarse[between ? 0 : 1].median / fine->median, share));
    }
    return least;
}

static double most_accurate(const trial *t) {
    int last = 0;
    while (last + 1 < WAY_COUNT && strcmp(WAYS[last + 1].name, "certified") == 0)
        last++;
    return t->all[last].median;
}

static void add_ratios(bench_table *table, const trial *t, int i) {
    for (int k = 0; k < OTHER_COUNT; k++) {
        const double seconds = time_to_reach(t, OTHERS[k], t->all[i].error.worst);
        if (strcmp(WAYS[i].name, "certified") != 0)
            bench_table_add(table, "-");
        else if (seconds < INFINITY)
            bench_table_add(table, "%.3g", seconds / t->all[i].median);
        else
            bench_table_add(table, "not reached");
    }
}

static void add_row(bench_table *table, const trial *t, int i) {
    const entrant *e = &t->all[i];
    bench_table_add(table, "%s", t->subject->label);
    bench_table_add(table, "%s", t->transfer);
    bench_table_add(table, "%s", WAYS[i].name);
    bench_table_add(table, "%s", WAYS[i].setting);
    bench_table_add(table, "%.2f", e->median * 1e3);
    bench_table_add(table, "%.2f", e->spread * 1e3);
    bench_table_add(table, "%.3e", e->error.worst);
    bench_table_add(table, "%.3e", e->error.p99);
    bench_table_add(table, "%.3e", e->error.rms);
    bench_table_add(table, "%.3f", 100.0 * e->error.share);
    if (isfinite(e->claimed))
        bench_table_add(table, "%.3e", e->claimed);
    else
        bench_table_add(table, "-");
    bench_table_add(table, "%.1e", t->bound);
    bench_table_add(table, "%.2f", most_accurate(t) / e->median);
    add_ratios(table, t, i);
    bench_table_add(table, "%.3f", (double)e->stats.cells / (double)e->stats.rays);
    bench_table_add(table, "%.3f", (double)e->stats.bytes_read * 1e-6);
    bench_table_add(table, "%s", e->front ? "front" : "-");
}

/* ---- A trial ---- */

static status enter(bench_job *job, trial *t) {
    const leafcast_options options = {.size = sizeof options, .threads = 1};
    status st = (status)leafcast_open(t->subject->path, &options, &t->volume);
    if (st == ST_OK)
        st = bench_media_transfer(t->transfer, t->volume, &t->points);
    if (st != ST_OK)
        return st;
    double range[2];
    st = (status)leafcast_range(t->volume, 0, 0, range);
    if (st != ST_OK)
        return st;
    t->range = fmax(range[1] - range[0], 0.0);
    t->medium = (leafcast_medium){t->points.points, (int)t->points.count};
    t->shown = (leafcast_shown){.volume = t->volume};
    t->camera = view_camera_of(&t->subject->view, t->volume);
    t->pixels = (size_t)t->camera.width * t->camera.height;
    t->truth = mem_array(t->m, 4 * t->pixels, sizeof(double));
    t->rgba = mem_array(t->m, 4 * t->pixels, sizeof(double));
    t->offs = mem_array(t->m, 4 * t->pixels, sizeof(double));
    t->error = mem_array(t->m, t->pixels, sizeof(double));
    bool failed = !t->truth || !t->rgba || !t->offs || !t->error;
    for (int i = 0; i < WAY_COUNT; i++) {
        t->all[i].seconds = mem_array(t->m, (size_t)job->runs, sizeof(double));
        failed |= !t->all[i].seconds;
    }
    return failed ? ST_NOMEM : ST_OK;
}

static void leave(trial *t) {
    leafcast_close(t->volume);
    transfer_list_release(&t->points);
    mem_free(t->m, t->truth);
    mem_free(t->m, t->rgba);
    mem_free(t->m, t->offs);
    mem_free(t->m, t->error);
    for (int i = 0; i < WAY_COUNT; i++)
        mem_free(t->m, t->all[i].seconds);
}

static status try_transfer(bench_job *job, const bench_subject *s, const char *transfer) {
    trial t = {.m = &job->m, .subject = s, .transfer = transfer, .points = {.m = &job->m}};
    status st = enter(job, &t);
    if (st == ST_OK)
        st = race(job, &t);
    if (st == ST_OK)
        find_front(&t);
    for (int i = 0; i < WAY_COUNT && st == ST_OK; i++)
        add_row(&job->table, &t, i);
    leave(&t);
    return st;
}

static status try_volume(bench_job *job, const bench_subject *s) {
    static const char *const own[] = {"opaque", "thin", "positive"};
    status st = ST_OK;
    for (int i = 0; i < job->transfer_count && st == ST_OK; i++)
        st = try_transfer(job, s, job->transfers[i]);
    for (int i = 0; i < 3 && job->transfer_count == 0 && st == ST_OK; i++)
        st = try_transfer(job, s, own[i]);
    return st;
}

status bench_media(bench_job *job) {
    static const char *const names[] = {"bonsai", "engine", "ch2better", "ml-256", NULL};
    static const char *const brief[] = {"ml-32", NULL};
    bench_table_init(&job->table,
                     "Media, time against error: the same pieces of rays, certified and in steps, "
                     "against what is certified to 1e-6; one thread, medians of CPU time, runs "
                     "interleaved",
                     HEADINGS);
    status st = medium_options_set(&job->view.medium, MEDIUM_TF, "auto"); /* it is filled */
    return st == ST_OK ? bench_suite_each(job, names, brief, try_volume) : st;
}
