/* bench_main.c - leafcast bench: the papers' tables and ours. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "formats/base/printed_file.h"
#include "formats/base/sibling.h"
#include "formats/base/text.h"
#include "render/bench/bench_suites.h"
#include "render/experiments/experiments.h"

LINK_EXPERIMENTS;

typedef struct bench_options {
    cli_common common;
    const char *suite, *plot, *folder, *scratch, *data, *against, *baselines;
    int form; /* 0: as the suite says */
    bench_job job;
} bench_options;

enum {
    RUNS = 0x3000,
    COUNT,
    PLOT,
    OUT,
    SCRATCH,
    DATA,
    FORM,
    LARGEST,
    AGAINST,
    BASELINES,
    TRANSFER
};
enum { BRIEF = 1, FULL };

static const struct argp_option OPTIONS[] = {
    {NULL, 0, NULL, 0, "Measuring:", 1},
    {"against", AGAINST, "DIR", CLI_BASIC,
     "fail where a count is off its tolerance in DIR/SUITE.csv", 0},
    {"baselines", BASELINES, "DIR", 0, "write this run's counts, with tolerances, there", 0},
    {"data", DATA, "DIR", CLI_BASIC, "where the papers' volumes are ($LEAFCAST_DATA)", 0},
    {"form", FORM, "brief|full", CLI_BASIC, "brief (small volumes; what `all` does) or full", 0},
    {"largest", LARGEST, "N", 0, "figure414: up to N^3 samples (1024)", 0},
    {"out", OUT, "DIR", CLI_BASIC, "write SUITE.csv and SUITE.svg into this folder", 0},
    {"plot", PLOT, "FILE.svg", CLI_BASIC, "draw the table's main columns", 0},
    {"ray-cells", COUNT, "N", 0, "intersectors: at most N ray-cells (500000)", 0},
    {"runs", RUNS, "N", CLI_BASIC, "runs of each, interleaved; medians are reported (9, brief: 3)",
     0},
    {"scratch", SCRATCH, "DIR", 0, "keep converted volumes there (in $TMPDIR, for this run)", 0},
    {"tf", TRANSFER, "T", 0,
     "media: with this transfer function. Repeatable (opaque, thin, positive)", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static status add_transfer(bench_job *job, const char *text) {
    if (job->transfer_count == BENCH_TRANSFERS)
        return status_describe(ST_USAGE, "--tf: more than %d of them", BENCH_TRANSFERS);
    job->transfers[job->transfer_count++] = text;
    return ST_OK;
}

static status set_form(bench_options *o, const char *text) {
    o->form = strcmp(text, "brief") == 0 ? BRIEF : strcmp(text, "full") == 0 ? FULL : 0;
    return o->form ? ST_OK : status_describe(ST_USAGE, "--form: %s: brief or full", text);
}

static status set_option(void *own, int key, const char *text) {
    bench_options *o = own;
    switch (key) {
    case RUNS: return cli_int(text, "--runs", 1, 1000, &o->job.runs);
    case COUNT: return cli_int(text, "--ray-cells", 1, 1 << 24, &o->job.count);
    case LARGEST: return cli_int(text, "--largest", 32, 1024, &o->job.largest);
    case FORM: return set_form(o, text);
    case PLOT: o->plot = text; return ST_OK;
    case OUT: o->folder = text; return ST_OK;
    case SCRATCH: o->scratch = text; return ST_OK;
    case DATA: o->data = text; return ST_OK;
    case AGAINST: o->against = text; return ST_OK;
    case BASELINES: o->baselines = text; return ST_OK;
    case TRANSFER: return add_transfer(&o->job, text);
    default: return view_options_set(&o->job.view, key, text);
    }
}

static status take_arguments(void *own) {
    bench_options *o = own;
    o->suite = o->common.input;
    o->job.target = o->common.input_count > 1 ? o->common.inputs[1] : NULL;
    return ST_OK;
}

/* ---- results ---- */

typedef enum product { PRODUCT_CSV, PRODUCT_PLOT, PRODUCT_BASELINE } product;

typedef struct product_of {
    const bench_table *table;
    const bench_suite *suite;
    product what;
} product_of;

static void print_product(const void *ctx, FILE *out) {
    const product_of *p = ctx;
    const bench_suite *suite = p->suite;
    int charts = 0;
    while (charts < BENCH_SUITE_CHARTS && suite->charts[charts].column)
        charts++;
    if (p->what == PRODUCT_CSV)
        bench_table_csv(p->table, out);
    else if (p->what == PRODUCT_BASELINE)
        bench_baseline_write(p->table, suite->labels, suite->counts, out);
    else if (suite->curve.x)
        bench_curve_draw(p->table, &suite->curve, out);
    else
        bench_plot(p->table, suite->labels, suite->charts, charts, out);
}

static status write_product(bench_options *o, const bench_suite *suite, const char *path,
                            product what) {
    const product_of p = {&o->job.table, suite, what};
    return printed_file_write(&o->job.m, path, o->common.force, print_product, &p);
}

/* Told before the suite runs. */
static status check_product(bench_options *o, const char *path) {
    if (!path || !*path)
        return ST_OK;
    status st = file_guard_output(path);
    return st == ST_OK ? out_file_check(&o->job.m, path, o->common.force) : st;
}

/* DIR/SUITE.csv and the like, in the folders of --out and --baselines. */
typedef struct folder_names {
    char csv[PATH_MAX], svg[PATH_MAX], png[PATH_MAX], baseline[PATH_MAX];
} folder_names;

enum { FOLDER_MAX = 4000 }; /* bytes: the rest of a path is the suite's */

static status name_of(const char *folder, const bench_suite *suite, const char *extension,
                      char path[PATH_MAX]) {
    if (strlen(folder) > FOLDER_MAX)
        return status_describe(ST_USAGE, "a folder's path has %zu bytes: at most %d are possible",
                               strlen(folder), FOLDER_MAX);
    snprintf(path, PATH_MAX, "%.*s/%s%s", FOLDER_MAX, folder, suite->name, extension);
    return ST_OK;
}

static status name_in(bench_options *o, const char *folder, const bench_suite *suite,
                      const char *extension, char path[PATH_MAX]) {
    if (!folder)
        return ST_OK;
    status st = name_of(folder, suite, extension, path);
    if (st != ST_OK)
        return st;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return file_failed(errno, folder, "cannot make the folder");
    return check_product(o, path);
}

static status names_of(bench_options *o, const bench_suite *suite, folder_names *n) {
    status st = name_in(o, o->folder, suite, ".csv", n->csv);
    if (st == ST_OK)
        st = name_in(o, o->folder, suite, ".svg", n->svg);
    if (st == ST_OK && suite->picture)
        st = name_in(o, o->folder, suite, ".png", n->png);
    return st == ST_OK && suite->counts ? name_in(o, o->baselines, suite, ".csv", n->baseline) : st;
}

static status write_products(bench_options *o, const bench_suite *suite,
                             const folder_names *names) {
    const char *csv = suite->picture ? NULL : o->common.output;
    status st = csv ? write_product(o, suite, csv, PRODUCT_CSV) : ST_OK;
    if (st == ST_OK && o->plot)
        st = write_product(o, suite, o->plot, PRODUCT_PLOT);
    if (st == ST_OK && o->folder)
        st = write_product(o, suite, names->csv, PRODUCT_CSV);
    if (st == ST_OK && o->folder)
        st = write_product(o, suite, names->svg, PRODUCT_PLOT);
    if (st == ST_OK && o->baselines && suite->counts)
        st = write_product(o, suite, names->baseline, PRODUCT_BASELINE);
    return st;
}

static status check_counts(bench_options *o, const bench_suite *suite) {
    char path[PATH_MAX];
    bench_verdict v;
    if (!o->against || !suite->counts)
        return ST_OK;
    status st = name_of(o->against, suite, ".csv", path);
    if (st != ST_OK)
        return st;
    st = bench_baseline_check(&o->job.m, &o->job.table, suite->labels, path, &v);
    cli_note(&o->common, 1, "%s: %d counts within tolerance, %d off, %d of kernels not here",
             suite->name, v.within, v.off, v.absent);
    return st;
}

/* What the suite reads; its outputs are held against it. */
static status guard_inputs(const bench_options *o, const bench_suite *suite) {
    char path[PATH_MAX];
    status st = file_guard_input(o->job.target);
    if (st != ST_OK || !o->against || !suite->counts)
        return st;
    st = name_of(o->against, suite, ".csv", path);
    return st == ST_OK ? file_guard_input(path) : st;
}

static status run_suite(bench_options *o, const bench_suite *suite) {
    folder_names names;
    status st = guard_inputs(o, suite);
    if (st == ST_OK)
        st = names_of(o, suite, &names);
    if (st == ST_OK)
        st = check_product(o, o->common.output);
    if (st == ST_OK)
        st = check_product(o, o->plot);
    if (st != ST_OK)
        return st;
    o->job.output = o->folder && !o->common.output ? names.png : o->common.output;
    st = suite->run(&o->job);
    cli_results(&o->common, false);
    bench_machine(cpu_best(), BENCH_COMMIT, o->job.table.machine);
    if (o->job.table.rows > 0 && !o->common.json)
        bench_table_print(&o->job.table, stdout);
    if (st == ST_OK)
        st = cli_flush();
    if (st == ST_OK)
        st = write_products(o, suite, &names);
    if (st == ST_OK)
        st = check_counts(o, suite);
    if (st == ST_OK && o->common.json)
        st = cli_print_json(&o->common, bench_table_json(&o->job.table, suite->name));
    return st;
}

/* Every suite; one that lacks something here is passed over, one whose counts are off does not
 * keep the others from being looked at. */
static status run_all(bench_options *o) {
    if (o->common.output || o->plot || o->job.target)
        return status_describe(ST_USAGE, "bench all takes no file and no -o; --out DIR");
    status_note off = {ST_OK, ""};
    status st = ST_OK;
    const bench_suite *suite;
    for (int i = 0; (suite = bench_suite_at(i)) && st == ST_OK; i++) {
        if (suite->picture && !o->folder)
            continue;
        cli_note(&o->common, 1, "%s", suite->name);
        st = run_suite(o, suite);
        if (st == ST_UNSUPPORTED)
            cli_note(&o->common, 1, "%s: passed over: %s", suite->name, status_text());
        if (st == ST_FAILED && off.st == ST_OK)
            status_note_take(&off, st);
        if (st == ST_UNSUPPORTED || st == ST_FAILED)
            st = ST_OK;
    }
    return st == ST_OK && off.st != ST_OK ? status_note_raise(&off) : st;
}

/* ---- what would change nothing ---- */

/* suite: NULL for all of them. */
static bool has_sizes(const bench_options *o, const bench_suite *suite) {
    return !o->job.brief && (!suite || suite == bench_suite_find("figure414"));
}

static bool has_ray_cells(const bench_options *o, const bench_suite *suite) {
    (void)o;
    return !suite || suite == bench_suite_find("intersectors");
}

static bool has_counts(const bench_options *o, const bench_suite *suite) {
    (void)o;
    return !suite || suite->counts;
}

static bool has_runs(const bench_options *o, const bench_suite *suite) {
    (void)o;
    return !suite || !suite->once;
}

static bool has_media(const bench_options *o, const bench_suite *suite) {
    (void)o;
    return !suite || suite->media;
}

static bool has_budget(const bench_options *o, const bench_suite *suite) {
    return !o->common.memory || (suite && suite->budget);
}

static bool has_store(const bench_options *o, const bench_suite *suite) {
    (void)suite;
    return !o->job.target;
}

static status check_needs(const bench_options *o, const bench_suite *suite) {
    static const struct {
        int key;
        bool (*met)(const bench_options *o, const bench_suite *suite);
        const char *why;
    } needs[] = {{LARGEST, has_sizes, "--largest: is for figure414 --form full"},
                 {COUNT, has_ray_cells, "--ray-cells: is for intersectors"},
                 {AGAINST, has_counts, "--against: this suite has no counts"},
                 {BASELINES, has_counts, "--baselines: this suite has no counts"},
                 {TRANSFER, has_media, "--tf: is for media"},
                 {RUNS, has_runs, "--runs: this suite needs one"},
                 {DATA, has_store, "--data: there is a file already"},
                 {SCRATCH, has_store, "--scratch: there is a file already"}};
    for (size_t i = 0; i < sizeof needs / sizeof *needs; i++)
        if (cli_given(&o->common, needs[i].key) && !needs[i].met(o, suite))
            return status_describe(ST_USAGE, "%s", needs[i].why);
    return has_budget(o, suite) ? ST_OK : status_describe(ST_USAGE, "--memory: is for streaming");
}

/* The flags of a view that a suite goes by. Its own volumes have isovalues of their own; a field
 * has no view at all. */
static status check_view(const bench_options *o, const bench_suite *suite) {
    const char *target = o->job.target, *name = suite ? suite->name : "all";
    char names[256] = "size", who[64];
    const bool field = target && !strchr(target, '.') && has_ray_cells(o, suite);
    if (suite && target && !suite->surfaces)
        return status_describe(ST_USAGE, "%s: bench %s takes no file", target, name);
    if (suite)
        snprintf(names, sizeof names, "%s %s", field ? "" : suite->view,
                 target && !field ? suite->surfaces : "");
    snprintf(who, sizeof who, "bench %s", name);
    status st = view_options_only(&o->job.view, names, who);
    if (st == ST_OK && o->job.view.isos > 1 && !suite->several)
        st = status_describe(ST_USAGE, "--iso: bench %s draws one isosurface", name);
    return st == ST_OK ? view_options_check_either(&o->job.view) : st;
}

static status run(bench_options *o) {
    bench_job *job = &o->job;
    const char *name = o->suite ? o->suite : "intersectors";
    const bench_suite *suite = bench_suite_find(name);
    const bool all = strcmp(name, "all") == 0;
    o->common.json_lines = all;
    if (o->common.output && strcmp(o->common.output, "-") == 0)
        return status_describe(ST_USAGE, "-o -: standard output has the table already");
    if (!suite && !all)
        return status_describe(ST_USAGE, "no suite \"%s\"; --help lists them", name);
    if ((job->view.field[0] && !(suite && suite->series)) || job->view.step)
        return status_describe(ST_USAGE,
                               "%s: suites draw the first field at the first step; "
                               "bench time --field NAME draws all steps",
                               job->view.step ? "--step" : "--field");
    job->brief = o->form == BRIEF || (all && o->form != FULL);
    status st = check_needs(o, suite);
    if (st == ST_OK)
        st = check_view(o, suite);
    if (st != ST_OK)
        return st;
    job->runs = job->runs ? job->runs : job->brief ? 3 : 9;
    job->threads = o->common.threads;
    job->memory = o->common.memory;
    job->force = o->common.force;
    if (job->view.camera.width == 0)
        job->view.camera.width = job->view.camera.height = job->brief ? 128 : 1024;
    const char *data = o->data ? o->data : getenv("LEAFCAST_DATA");
    st = bench_store_open(&job->m, o->scratch, data && *data ? data : NULL, o->common.threads,
                          &job->store);
    if (st == ST_OK)
        st = all ? run_all(o) : run_suite(o, suite);
    bench_store_close(job->store);
    return st;
}

/* --help's text, with the table of suites. */
static const char *describe(void) {
    static char text[32768] =
        "Measure: the papers' tables and ours, each number with its error.\v"
        "Example:\n  leafcast bench frames bonsai.leaf --iso 37\n\nSuites (--help-all): ";
    const bench_suite *suite;
    for (int i = 0; (suite = bench_suite_at(i)); i++)
        text_add(text, sizeof text, "%s, ", suite->name);
    text_add(text, sizeof text, "peers and all.\vSuites:\n");
    for (int i = 0; (suite = bench_suite_at(i)); i++) {
        text_add(text, sizeof text, "  %s%s%s\n      ", suite->name, *suite->takes ? " " : "",
                 suite->takes);
        for (const char *at = suite->about; *at; at++)
            text_add(text, sizeof text, "%c%s", *at, *at == '\n' ? "      " : "");
        text_add(text, sizeof text, "\n");
    }
    text_add(
        text, sizeof text, "%s",
        "  peers F.leaf --iso V\n      Embree and VTK on the same picture; bench peers --help\n"
        "  all\n      all of them, in brief\n"
        "The table goes to standard output, with -o FILE.csv also there as CSV. Suites that are "
        "given no file measure the papers' volumes, from the data folder where they are there, "
        "and generated ones.\n\n"
        "M08: Gerd Marmitt, Interactive Volume Ray Tracing, 2008. W07: Ingo Wald, Heiko "
        "Friedrich, Aaron Knoll, Charles Hansen, Interactive Isosurface Ray Tracing of "
        "Time-Varying Tetrahedral Volumes, 2007.");
    return text;
}

/* Beside other libraries: a program of its own, which links them. */
static int hand_over(char **argv) {
    char program[SIBLING_PATH];
    if (sibling_find("leafcast-bench-peers", program))
        execv(program, argv);
    fprintf(stderr, "leafcast bench: leafcast-bench-peers is not there\n");
    return 1;
}

static const output_kind *output(const void *own) {
    static const output_kind kind = {.what = "a table, or of some suites a picture",
                                     .suffixes = ".csv .png "};
    (void)own;
    return &kind;
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "peers") == 0)
        return hand_over(argv + 1);
    static bench_options o = {.common = {.verb = "bench"},
                              .job = {.count = 500000, .largest = 1024}};
    struct argp_option options[VIEW_OPTIONS_ROOM];
    view_options_join(options, OPTIONS, false, "iso size");
    const cli_verb verb = {.options = options,
                           .set_option = set_option,
                           .check = take_arguments,
                           .output = output,
                           .inputs_max = 2,
                           .args_doc = "[SUITE [F.leaf]]",
                           .doc = describe()};
    view_options_init(&o.job.view);
    o.job.view.fit = false;      /* what is measured stays what it was */
    o.job.view.camera.width = 0; /* not given */
    mem_init(&o.job.m, 0);
    cli_parse(&verb, &o.common, argc, argv);
    o.job.progress = cli_progress(&o.common);
    return cli_finish(&o.common, run(&o));
}
