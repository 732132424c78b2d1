/* bench_main.c - leafcast bench: the papers' tables and ours. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/file.h"
#include "formats/base/num.h"
#include "render/bench_figure.h"
#include "render/bench_intersect.h"
#include "render/bench_plot.h"
#include "render/bench_walk.h"
#include "render/view_options.h"

typedef struct bench_options {
    cli_common common;
    view_options view;
    const char *suite, *target, *plot;
    int runs, count;
    mem m;
    bench_table table;
} bench_options;

enum { RUNS = 0x3000, COUNT, PLOT };

static const struct argp_option OPTIONS[] = {
    {NULL, 0, NULL, 0, "Measuring:", 1},
    {"runs", RUNS, "N", 0, "runs of each, interleaved; medians are reported (9)", 0},
    {"ray-cells", COUNT, "N", 0, "intersectors: at most N ray-cells (500000)", 0},
    {"plot", PLOT, "FILE.svg", 0, "draw the table's main columns", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static status set_option(bench_options *o, int key, const char *text) {
    int64_t n = 0;
    status st = ST_OK;
    switch (key) {
    case RUNS:
        st = num_int(text, "--runs", 1, 1000, &n);
        o->runs = (int)n;
        return st;
    case COUNT:
        st = num_int(text, "--ray-cells", 1, 1 << 24, &n);
        o->count = (int)n;
        return st;
    case PLOT: o->plot = text; return ST_OK;
    default: return ST_AGAIN;
    }
}

static error_t parse(int key, char *arg, struct argp_state *state) {
    bench_options *o = state->input;
    status st = ST_OK;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = &o->common; return 0;
    case ARGP_KEY_ARG:
        if (!o->suite)
            o->suite = arg;
        else if (!o->target)
            o->target = arg;
        else
            argp_error(state, "%s: a suite and a file are enough", arg);
        return 0;
    default:
        st = set_option(o, key, arg);
        if (st == ST_AGAIN)
            st = view_options_set(&o->view, key, arg);
        if (st == ST_AGAIN)
            return ARGP_ERR_UNKNOWN;
    }
    if (st)
        argp_error(state, "%s", status_text());
    return 0;
}

/* ---- suites ---- */

static status ray_cells_of_file(bench_options *o, bench_ray_cells *cells) {
    const leafcast_options open = {.threads = 1, .memory = o->common.memory};
    leafcast *volume = NULL;
    status st = view_options_check(&o->view);
    if (st == ST_OK)
        st = (status)leafcast_open(o->target, &open, &volume);
    if (st == ST_OK)
        st = (status)leafcast_select(volume, o->view.surfaces, o->view.isos);
    if (st == ST_OK) {
        const leafcast_camera camera = view_options_camera(&o->view, volume);
        st = bench_ray_cells_record(&o->m, volume, &o->view.scene, &camera, (uint32_t)o->count,
                                    cells);
    }
    leafcast_close(volume);
    return st;
}

static status run_field(bench_options *o, const char *name, bool from_file) {
    bench_ray_cells cells = {0};
    status st = from_file ? ray_cells_of_file(o, &cells)
                          : bench_ray_cells_make(&o->m, name, (uint32_t)o->count, &cells);
    const char *slash = strrchr(name, '/');
    if (st == ST_OK)
        st = bench_intersect(&o->m, slash ? slash + 1 : name, &cells, o->runs, &o->table);
    mem_free(&o->m, cells.cells);
    return st;
}

static status intersectors(bench_options *o) {
    bench_table_init(&o->table,
                     "Cell intersectors (M08 4.3.3): against a long-double solution of every "
                     "ray-cell; distances in cells, medians of CPU time, runs interleaved",
                     bench_intersect_headings);
    if (o->target && strchr(o->target, '.'))
        return run_field(o, o->target, true);
    if (o->target)
        return run_field(o, o->target, false);
    status st = run_field(o, "marschner-lobb", false);
    return st == ST_OK ? run_field(o, "noise", false) : st;
}

static status walk(bench_options *o) {
    bench_table_init(
        &o->table,
        "E1, below 4^3 cells: one thread, all resident, the same depth bits; medians of CPU time, "
        "runs interleaved",
        bench_walk_headings);
    if (!o->target)
        return status_describe(ST_USAGE, "bench walk takes a treelet file");
    status st = view_options_check(&o->view);
    return st == ST_OK ? bench_walk(&o->m, o->target, &o->view, o->runs, &o->table) : st;
}

static status kernel(bench_options *o) {
    bench_table_init(&o->table,
                     "E2, the cell kernel: double throughout, and behind a float filter with a "
                     "proven bound",
                     bench_filter_headings);
    if (!o->target)
        return status_describe(ST_USAGE, "bench kernel takes a treelet file");
    status st = view_options_check(&o->view);
    return st == ST_OK ? bench_filter(o->target, &o->view, &o->table) : st;
}

/* -o is the picture here, not the table. */
static status figure49(bench_options *o) {
    const char *path = o->common.output ? o->common.output : "figure49.png";
    bench_figure r;
    bench_table_init(&o->table, "M08 figure 4.9: two surfaces in one cell",
                     "intersector|rays|surfaces|missed");
    status st = bench_figure_draw(&o->m, path, o->common.force, o->view.camera.height / 2, &r);
    if (st)
        return st;
    for (int i = 0; i < 2; i++) {
        const uint64_t seen = i ? r.right : r.left;
        bench_table_add(&o->table, "%s", i ? "marmitt" : "neubauer");
        bench_table_add(&o->table, "%llu", (unsigned long long)r.rays);
        bench_table_add(&o->table, "%llu", (unsigned long long)seen);
        bench_table_add(&o->table, "%llu", (unsigned long long)(r.right - seen));
    }
    cli_note(&o->common, 1, "%s: neubauer on the left, marmitt on the right", path);
    return ST_OK;
}

static const struct suite {
    const char *name;
    status (*run)(bench_options *o);
    bool csv; /* -o takes the table */
    int labels;
    bench_chart charts[2];
} SUITES[] = {
    {"intersectors",
     intersectors,
     true,
     2,
     {{"ns/ray-cell", "+-", false}, {"rms cells", NULL, true}}},
    {"figure49", figure49, false, 1, {{"surfaces", NULL, false}, {"missed", NULL, false}}},
    {"walk", walk, true, 2, {{"ns/ray", "+-", false}, {"new isovalue ms", "+-", false}}},
    {"kernel", kernel, true, 1, {{"double ns/16", NULL, false}, {"filtered ns/16", NULL, false}}}};
enum { SUITE_COUNT = sizeof SUITES / sizeof *SUITES };

/* ---- results ---- */

/* What a printer prints, to a file that appears when it is complete. */
static status write_printed(bench_options *o, const struct suite *suite, bool plot) {
    const char *path = plot ? o->plot : o->common.output;
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return status_describe(ST_NOMEM, "no memory for the table");
    if (plot)
        bench_plot(&o->table, suite->labels, suite->charts, 2, stream);
    else
        bench_table_csv(&o->table, stream);
    fclose(stream);
    out_file *f = NULL;
    status st = out_file_create(&o->m, path, o->common.force, &f);
    if (st == ST_OK) {
        st = out_file_append(f, text, size);
        if (st == ST_OK)
            st = out_file_commit(f);
        else
            out_file_discard(f);
    }
    free(text);
    return st;
}

static status refuse_existing(const bench_options *o, const char *path) {
    if (!path || o->common.force || access(path, F_OK) != 0)
        return ST_OK;
    return status_describe(ST_EXISTS, "%s exists (--force overwrites)", path);
}

static status run(bench_options *o) {
    const char *name = o->suite ? o->suite : "intersectors";
    const struct suite *suite = NULL;
    for (int i = 0; i < SUITE_COUNT; i++)
        if (strcmp(SUITES[i].name, name) == 0)
            suite = &SUITES[i];
    if (!suite)
        return status_describe(ST_USAGE, "no suite \"%s\": intersectors, figure49, walk, kernel",
                               name);
    status st = refuse_existing(o, o->common.output);
    if (st == ST_OK)
        st = refuse_existing(o, o->plot);
    if (st == ST_OK)
        st = suite->run(o);
    if (st)
        return st;
    bench_table_print(&o->table, stdout);
    if (suite->csv && o->common.output)
        st = write_printed(o, suite, false);
    return st == ST_OK && o->plot ? write_printed(o, suite, true) : st;
}

int main(int argc, char **argv) {
    static bench_options o = {.common = {.verb = "bench"}, .runs = 9, .count = 500000};
    const struct argp_child children[] = {{&cli_common_argp, 0, NULL, 0}, {0}};
    struct argp_option options[VIEW_OPTIONS_ROOM];
    view_options_join(options, OPTIONS);
    const struct argp table = {
        .options = options,
        .parser = parse,
        .args_doc = "[SUITE [F.leaf]]",
        .doc = "Measure: the papers' tables and ours, each number with its error.\v"
               "Suites:\n"
               "  intersectors [F.leaf --iso V | marschner-lobb | noise]\n"
               "               the six cell intersectors: what they miss, how far off\n"
               "               they are, how long they take (M08 tables 4.5)\n"
               "  figure49 [-o FILE.png]  M08 figure 4.9, two surfaces in a cell\n"
               "  walk F.leaf --iso V     experiment E1: below 4^3 cells\n"
               "  kernel F.leaf --iso V   experiment E2: a float filter\n"
               "The table goes to standard output, with -o FILE.csv also there as CSV.",
        .children = children};
    view_options_init(&o.view);
    mem_init(&o.m, 0);
    cli_parse(&table, &o.common, argc, argv, &o);
    (void)cli_progress(&o.common);
    return cli_finish(&o.common, run(&o));
}
