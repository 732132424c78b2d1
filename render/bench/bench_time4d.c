#include "render/bench/bench_time4d.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/leaf/time_tree.h"
#include "render/app/view_camera.h"

/* Columns, in the order of add_row(); nodes and us are means of a question, of us the median over
 * runs:
 *   leaves     treelets of level 0, in all steps
 *   tree MB    ranges of nodes above the leaves; build ms: to make them
 *   step       which treelets have the isovalue in this step?
 *   series     which treelets have it in which steps?
 *   sweep      which steps have a value, for values from the least to the greatest
 *   first      in which step is it there first, for the same values
 *   met        answers: treelets and steps of the isovalue, and steps of all values
 *   differ     answers that a look at all ranges does not give, and those that are missing
 *   frame ms   CPU time of a picture of another step, one thread, all in memory */
const char bench_time4d_headings[] =
    "series|order|steps|leaves|tree MB|build ms|step nodes|step us|series nodes|series us|"
    "sweep nodes|sweep us|first nodes|first us|met|differ|frame ms";

enum { VALUES = 32, DIRECTORY = TIME_ORDERS, ROWS = TIME_ORDERS + 1 };
enum { STEP, SERIES, SWEEP, FIRST, QUESTIONS };

static const char *const order_names[ROWS] = {[TIME_ORDER_LEAST] = "least overlap",
                                              [TIME_ORDER_MOST] = "most overlap (M08)",
                                              [TIME_ORDER_LONG] = "longest side",
                                              [TIME_ORDER_STEPS] = "a tree a step",
                                              [DIRECTORY] = "all ranges"};

typedef struct series {
    const bench_subject *of;
    leaf_file *f;
    const time_tree *tree; /* NULL: look at all ranges */
    value_limits surface, values[VALUES];
    /* Answers, and those that are right: */
    uint8_t *want, *found;  /* per step and treelet; behind them has: per value and step */
    uint8_t *has;           /* of found */
    uint32_t first[VALUES]; /* a step; none: steps */
    uint64_t nodes;
} series;

/* ---- all ranges, one by one ---- */

static bool look(series *s, uint32_t step, uint32_t t, const value_limits *at) {
    const leaf_layout *l = &s->f->layout;
    const float *own = s->f->own[(size_t)step * l->treelets + t];
    s->nodes++;
    return value_limits_meet(at, own[0], own[1]);
}

static bool look_step(series *s, uint32_t step, const value_limits *at) {
    const leaf_level *l = &s->f->layout.level[0];
    for (uint32_t t = l->first; t < l->first + l->count; t++)
        if (look(s, step, t, at))
            return true;
    return false;
}

/* ---- the questions ---- */

static void note(time_query *q, uint32_t treelet, uint32_t step) {
    series *s = q->ctx;
    s->found[(size_t)step * s->f->layout.treelets + treelet] = 1;
}

/* Which treelets have the isovalue, in which of these steps? */
static void ask_treelets(series *s, uint32_t first, uint32_t end) {
    const leaf_level *l = &s->f->layout.level[0];
    time_query q = {
        .limits = &s->surface, .count = 1, .first = first, .end = end, .met = note, .ctx = s};
    if (s->tree)
        time_tree_ask(s->tree, &q);
    s->nodes += q.visited;
    for (uint32_t step = first; step < end && !s->tree; step++)
        for (uint32_t t = l->first; t < l->first + l->count; t++)
            if (look(s, step, t, &s->surface))
                note(&q, t, step);
}

/* In which steps is a value? */
static void ask_steps(series *s, const value_limits *at, uint8_t *has) {
    const uint32_t steps = s->f->layout.steps;
    if (s->tree)
        time_tree_steps(s->tree, *at, 0, steps, has, &s->nodes);
    for (uint32_t step = 0; step < steps && !s->tree; step++)
        has[step] = look_step(s, step, at);
}

static uint32_t ask_first(series *s, const value_limits *at) {
    const uint32_t steps = s->f->layout.steps;
    uint32_t first = 0;
    if (s->tree)
        return time_tree_first(s->tree, *at, 0, steps, &s->nodes);
    while (first < steps && !look_step(s, first, at))
        first++;
    return first;
}

/* Ask a question of a kind for the i-th time. Returns false when there are no more. */
static bool question(series *s, int kind, uint32_t i) {
    const uint32_t steps = s->f->layout.steps;
    if (i == (kind == STEP ? steps : kind == SERIES ? 1 : VALUES))
        return false;
    switch (kind) {
    case STEP: ask_treelets(s, i, i + 1); return true;
    case SERIES: ask_treelets(s, 0, steps); return true;
    case SWEEP: ask_steps(s, &s->values[i], s->has + (size_t)i * steps); return true;
    default: s->first[i] = ask_first(s, &s->values[i]); return true;
    }
}

typedef struct tally {
    double nodes[QUESTIONS], *us[QUESTIONS];
    double build;
    size_t bytes;
    uint64_t met, differ;
} tally;

static void interrogate(series *s, int run, tally *t) {
    for (int kind = 0; kind < QUESTIONS; kind++) {
        uint32_t asked = 0;
        s->nodes = 0;
        const double from = clock_cpu_seconds();
        while (question(s, kind, asked))
            asked++;
        t->us[kind][run] = 1e6 * (clock_cpu_seconds() - from) / asked;
        t->nodes[kind] = (double)s->nodes / asked;
    }
}

static size_t answers(const series *s) {
    return (size_t)s->f->layout.steps * (s->f->layout.treelets + VALUES);
}

/* The first step with a value follows from those that have it. */
static uint32_t first_of(const series *s, int i) {
    const uint32_t steps = s->f->layout.steps;
    const uint8_t *has = s->want + (s->has - s->found) + (size_t)i * steps;
    const uint8_t *at = memchr(has, 1, steps);
    return at ? (uint32_t)(at - has) : steps;
}

static void judge(const series *s, tally *t) {
    t->met = t->differ = 0;
    for (size_t i = 0; i < answers(s); i++) {
        t->met += s->found[i];
        t->differ += s->found[i] != s->want[i];
    }
    for (int i = 0; i < VALUES; i++)
        t->differ += s->first[i] != first_of(s, i);
}

/* ---- frames ---- */

static status draw(bench_job *job, const series *s, double *ms) {
    const leafcast_options options = {.size = sizeof options, .threads = 1};
    const uint32_t steps = s->f->layout.steps;
    const size_t pixels = (size_t)job->view.camera.width * job->view.camera.height;
    double *depth = mem_array(&job->m, pixels, sizeof *depth);
    double *times = mem_array(&job->m, steps, sizeof *times);
    leafcast *volume = NULL;
    status st = depth && times ? (status)leafcast_open(s->of->path, &options, &volume) : ST_NOMEM;
    if (st == ST_OK)
        st = (status)leafcast_select(volume, s->of->view.surfaces, s->of->view.isos);
    for (uint32_t frame = 0; frame < 2 * steps && st == ST_OK; frame++) {
        const leafcast_camera camera = view_camera_of(&s->of->view, volume);
        const leafcast_image image = {.size = sizeof image, .z = depth};
        const double from = clock_cpu_seconds();
        st = (status)leafcast_select_set(volume, 0, frame % steps);
        if (st == ST_OK)
            st = (status)leafcast_trace(volume, &s->of->view.scene, &camera, &image, NULL, NULL,
                                        NULL);
        times[frame % steps] = clock_cpu_seconds() - from;
    }
    if (st == ST_OK)
        *ms = 1e3 * bench_median(times, (int)steps, NULL);
    leafcast_close(volume);
    mem_free(&job->m, times);
    mem_free(&job->m, depth);
    return st;
}

/* ---- rows ---- */

static void add_row(bench_job *job, const series *s, int order, tally *t, double frame) {
    bench_table *table = &job->table;
    bench_table_add(table, "%s", s->of->label);
    bench_table_add(table, "%s", order_names[order]);
    bench_table_add(table, "%u", s->f->layout.steps);
    bench_table_add(table, "%llu",
                    (unsigned long long)s->f->layout.level[0].count * s->f->layout.steps);
    bench_table_add(table, "%.3f", 1e-6 * (double)t->bytes);
    bench_table_add(table, "%.3f", 1e3 * t->build);
    for (int kind = 0; kind < QUESTIONS; kind++) {
        bench_table_add(table, "%.1f", t->nodes[kind]);
        bench_table_add(table, "%.2f", bench_median(t->us[kind], job->runs, NULL));
    }
    bench_table_add(table, "%llu", (unsigned long long)t->met);
    bench_table_add(table, "%llu", (unsigned long long)t->differ);
    bench_table_add(table, "%.3f", frame);
}

static status run(bench_job *job, series *s, int order, tally *t) {
    time_tree *tree = NULL;
    status st = ST_OK;
    const double from = clock_cpu_seconds();
    if (order != DIRECTORY)
        st = time_tree_create(&job->m, s->f, 0, (time_order)order, &tree);
    if (st != ST_OK)
        return st;
    t->build = tree ? clock_cpu_seconds() - from : 0.0;
    t->bytes = tree ? time_tree_bytes(tree) : 0;
    s->tree = tree;
    memset(s->found, 0, answers(s));
    for (int n = 0; n < job->runs; n++)
        interrogate(s, n, t);
    if (order == DIRECTORY)
        memcpy(s->want, s->found, answers(s));
    judge(s, t);
    time_tree_destroy(tree);
    return ST_OK;
}

static status compare(bench_job *job, series *s) {
    double frame = 0.0;
    tally t = {0};
    status st = draw(job, s, &frame);
    for (int kind = 0; kind < QUESTIONS && st == ST_OK; kind++) {
        t.us[kind] = mem_array(&job->m, (size_t)job->runs, sizeof *t.us[kind]);
        st = t.us[kind] ? ST_OK : ST_NOMEM;
    }
    for (int order = DIRECTORY; order >= 0 && st == ST_OK; order--) {
        st = run(job, s, order, &t);
        if (st == ST_OK)
            add_row(job, s, order, &t, frame);
    }
    for (int kind = 0; kind < QUESTIONS; kind++)
        mem_free(&job->m, t.us[kind]);
    return st;
}

static status measure(bench_job *job, const bench_subject *subject) {
    series s = {.of = subject};
    status st = leaf_file_open(&job->m, subject->path, &s.f);
    if (st == ST_OK && s.f->layout.steps < 2)
        st = status_describe(ST_UNSUPPORTED, "%s: no time series", subject->path);
    if (st == ST_OK) {
        s.surface = value_limits_of_isovalue(subject->view.surfaces[0].isovalue);
        for (int i = 0; i < VALUES; i++)
            s.values[i] = value_limits_of_isovalue(
                s.f->header.value_min +
                (i + 0.5) / VALUES * (s.f->header.value_max - s.f->header.value_min));
        s.want = mem_alloc(&job->m, answers(&s));
        s.found = mem_alloc(&job->m, answers(&s));
        s.has = s.found + (size_t)s.f->layout.steps * s.f->layout.treelets;
        st = s.want && s.found ? compare(job, &s) : ST_NOMEM;
    }
    mem_free(&job->m, s.found);
    mem_free(&job->m, s.want);
    leaf_file_close(s.f);
    return st;
}

status bench_time4d(bench_job *job) {
    static const char *const names[] = {"drop-100", "jets-100", "vortex-100", "fingers", "isabel",
                                        "ocean",    "fluid",    "ball-32",    NULL};
    static const char *const brief[] = {"drop-64", "jets-64", "vortex-64", "ball-12", NULL};
    bench_table_init(
        &job->table,
        "M08 5.1.3: one tree over treelets and steps, by the order of its splits, "
        "beside a tree a step and a look at all ranges; one thread, medians of CPU time",
        bench_time4d_headings);
    return bench_suite_each(job, names, brief, measure);
}
