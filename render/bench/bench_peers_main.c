/* bench_peers_main.c - leafcast bench peers: beside Embree on the extracted mesh, and VTK.
 *
 * A program of its own, to which `leafcast bench` hands over: Embree is linked nowhere else.
 */
#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/cpu.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "formats/base/printed_file.h"
#include "render/app/image_out.h"
#include "render/app/picture_scene.h"
#include "render/bench/bench_plot.h"
#include "render/bench/peer_media.h"
#include "render/bench/peer_race.h"

enum { TRANSFERS_MAX = 8 };

typedef struct peers_options {
    cli_common common;
    view_options view;
    const char *picture, *plot;
    cpu_isa isa; /* CPU_SCALAR: the best */
    int runs;
    bool media;
    const char *transfers[TRANSFERS_MAX]; /* so many; none: opaque, thin, positive */
    int transfer_count;
    double step;
    mem m;
    bench_table table;
} peers_options;

enum { RUNS = 0x3000, PICTURE, PLOT, STEP, MEDIA, TRANSFER, ISA };

static const struct argp_option OPTIONS[] = {
    {NULL, 0, NULL, 0, "Measuring:", 1},
    {"media", MEDIA, NULL, CLI_BASIC, "the volume itself is seen: beside VTK's ray caster", 0},
    {"isa", ISA, "sse42|avx2|avx512", 0,
     "instructions that leafcast and Embree use (each its best)", 0},
    {"picture", PICTURE, "FILE.png", CLI_BASIC, "ours, Embree's, and how far apart, side by side",
     0},
    {"plot", PLOT, "FILE.svg", CLI_BASIC, "draw the table's main columns", 0},
    {"runs", RUNS, "N", CLI_BASIC, "runs of each, interleaved; medians are reported (9)", 0},
    {"step", STEP, "D", CLI_BASIC, "between new isovalues (a thousandth of the volume's range)", 0},
    {"tf", TRANSFER, "T", CLI_BASIC,
     "--media: with this transfer function, as bench media has it. Repeatable (opaque, thin, "
     "positive)",
     0},
    {NULL, 0, NULL, 0, NULL, 0}};

static status add_transfer(peers_options *o, const char *text) {
    if (o->transfer_count == TRANSFERS_MAX)
        return status_describe(ST_USAGE, "--tf: more than %d of them", TRANSFERS_MAX);
    o->transfers[o->transfer_count++] = text;
    return ST_OK;
}

static status set_step(peers_options *o, const char *text) {
    status st = num_double(text, "--step", &o->step);
    if (st == ST_OK && (!isfinite(o->step) || o->step == 0.0))
        st = status_describe(ST_USAGE, "--step: %s: expected a finite number, not 0", text);
    return st;
}

static status set_isa(peers_options *o, const char *text) {
    if (cpu_isa_find(text, &o->isa) && o->isa != CPU_SCALAR)
        return ST_OK;
    return status_describe(ST_USAGE, "--isa: %s: expected sse42, avx2 or avx512, of this CPU",
                           text);
}

static status set_option(void *own, int key, const char *text) {
    peers_options *o = own;
    status st = ST_OK;
    switch (key) {
    case RUNS: return cli_int(text, "--runs", 1, 1000, &o->runs);
    case STEP: return set_step(o, text);
    case PICTURE: o->picture = text; return ST_OK;
    case PLOT: o->plot = text; return ST_OK;
    case ISA: return set_isa(o, text);
    case MEDIA: o->media = true; return ST_OK;
    case TRANSFER: return add_transfer(o, text);
    default:
        st = view_options_set(&o->view, key, text);
        if (st == ST_OK && o->view.field[0])
            st = status_describe(ST_USAGE, "--field: peers draw a file's first field");
        return st;
    }
}

static status check_options(void *own) {
    const peers_options *o = own;
    return o->common.input ? ST_OK : status_describe(ST_USAGE, "which treelet file?");
}

static void print_csv(const void *table, FILE *out) {
    bench_table_csv(table, out);
}

static void print_bars(const void *table, FILE *out) {
    static const bench_chart charts[] = {
        {"ms", "+-", false}, {"x Embree", NULL, false}, {"x ours", NULL, false}};
    const bench_table *t = table;
    const int labels = bench_table_column(t, "transfer") == 0 ? 3 : 2;
    bench_plot(t, labels, charts, sizeof charts / sizeof *charts, out);
}

static status write_table(peers_options *o, const char *path,
                          void (*print)(const void *table, FILE *out)) {
    return path ? printed_file_write(&o->m, path, o->common.force, print, &o->table) : ST_OK;
}

/* Those that peer_race_check() looks at are among them. */
#define PEER_FLAGS                                                                            \
    "iso colour opacity layers size samples view eye look-at up fov ambient shading normals " \
    "light point-light shadows clip-box clip-plane lod preview"

/* What would change nothing. */
static status check_flags(const peers_options *o) {
    if (!o->media && o->transfer_count > 0)
        return status_describe(ST_USAGE, "--tf: is for --media");
    if (o->media && (o->picture || o->step != 0.0 || o->isa))
        return status_describe(ST_USAGE, "%s: is not for --media",
                               o->picture       ? "--picture"
                               : o->step != 0.0 ? "--step"
                                                : "--isa");
    return view_options_only(&o->view,
                             o->media     ? "size view eye look-at up fov ortho"
                             : o->picture ? PEER_FLAGS " background"
                                          : PEER_FLAGS,
                             o->media ? "bench peers --media" : "bench peers");
}

/* What would fail only after minutes. */
static status check(peers_options *o) {
    const char *const outputs[] = {o->common.output, o->plot};
    status st = check_flags(o);
    if (st == ST_OK && o->media)
        st = view_options_check_either(&o->view);
    if (st == ST_OK)
        st = file_guard_input(o->common.input);
    for (int i = 0; i < 2 && st == ST_OK; i++) {
        st = file_guard_output(outputs[i]);
        if (st == ST_OK && outputs[i])
            st = out_file_check(&o->m, outputs[i], o->common.force);
    }
    if (st == ST_OK)
        st = file_guard_output(o->picture);
    if (st == ST_OK && o->picture)
        st = image_out_check(&(image_out_options){.force = o->common.force}, o->picture);
    return st;
}

/* What is drawn, as render chooses it; steps of a thousandth of the volume's range, unless said
 * otherwise. */
static status choose(peers_options *o) {
    leafcast *volume = NULL;
    double suggested[LEAFCAST_SUGGESTIONS_MAX];
    int count;
    if (o->media)
        return ST_OK;
    status st = (status)leafcast_open(o->common.input, NULL, &volume);
    if (st == ST_OK) {
        const leafcast_info info = leafcast_describe(volume);
        if (o->step == 0.0)
            o->step = 1e-3 * (info.value_max - info.value_min);
        st = picture_scene_choose(volume, &o->view, suggested, &count);
    }
    if (st == ST_OK)
        st = picture_scene_check_used(volume, &o->view);
    if (st == ST_OK)
        st = peer_race_check(&o->view);
    leafcast_close(volume);
    return st;
}

static status run_surfaces(peers_options *o, const peer_race_options *race,
                           peer_race_missing *missing) {
    bench_table_init(&o->table,
                     "Peers: the same volume, isovalue, camera, picture, shading and threads; "
                     "medians of wall clock, runs interleaved",
                     peer_race_headings);
    return peer_race_run(&o->m, race, &o->table, missing);
}

static status run_media(peers_options *o, const peer_race_options *race,
                        peer_race_missing *missing) {
    static const char *const own[] = {"opaque", "thin", "positive"};
    const int count = o->transfer_count > 0 ? o->transfer_count : 3;
    status st = ST_OK;
    bench_table_init(&o->table,
                     "Peers: the same volume, transfer function, camera, pixels and threads; "
                     "medians of wall clock, runs interleaved",
                     peer_media_headings);
    for (int i = 0; i < count && st == ST_OK; i++)
        st = peer_media_run(&o->m, race, o->transfer_count > 0 ? o->transfers[i] : own[i],
                            &o->table, missing);
    return st;
}

static status run(peers_options *o) {
    peer_race_missing missing = {0};
    status st = check(o);
    if (st == ST_OK)
        st = choose(o);
    if (st)
        return st;
    const peer_race_options race = {.path = o->common.input,
                                    .view = &o->view,
                                    .step = o->step,
                                    .threads = o->common.threads,
                                    .runs = o->runs,
                                    .isa = o->isa,
                                    .memory = o->common.memory,
                                    .picture = o->picture,
                                    .force = o->common.force,
                                    .progress = cli_progress(&o->common)};
    st = o->media ? run_media(o, &race, &missing) : run_surfaces(o, &race, &missing);
    if (st)
        return st;
    cli_results(&o->common, false);
    bench_machine(o->isa ? o->isa : cpu_best(), BENCH_COMMIT, o->table.machine);
    if (!o->common.json)
        bench_table_print(&o->table, stdout);
    if (missing.embree[0])
        cli_note(&o->common, 1, "no Embree: %s", missing.embree);
    if (missing.vtk[0])
        cli_note(&o->common, 1, "no VTK: %s", missing.vtk);
    st = write_table(o, o->common.output, print_csv);
    if (st == ST_OK)
        st = write_table(o, o->plot, print_bars);
    if (st == ST_OK && o->common.json)
        st = cli_print_json(&o->common, bench_table_json(&o->table, "peers"));
    return st;
}

int main(int argc, char **argv) {
    static peers_options o = {.common = {.verb = "bench peers"}, .runs = 9};
    struct argp_option options[VIEW_OPTIONS_ROOM];
    view_options_join(options, OPTIONS, false, "iso size opacity layers light shadows");
    const cli_verb verb = {
        .options = options,
        .set_option = set_option,
        .check = check_options,
        .input = "file",
        .args_doc = "F.leaf [--iso V]",
        .doc = "Measure beside others: Embree on the extracted triangles, or those of the file, "
               "VTK's flying edges; "
               "with --media, VTK's ray caster.\v"
               "Example:\n  leafcast bench peers bonsai.leaf --iso 37 --light 0,1,2 --shadows\v"
               "The same volume, isovalue, camera, picture and threads, in turn. A new isovalue: "
               "another one for each picture; `ms` then holds what it takes to get at it. "
               "Embree's rows are its rtcIntersectN, with rtcOccludedN to lights; `x Embree` is "
               "against "
               "the fastest of them. What is not installed is left out, and said."};
    view_options_init(&o.view);
    o.view.fit = false; /* what is measured stays what it was */
    mem_init(&o.m, 0);
    cli_parse(&verb, &o.common, argc, argv);
    return cli_finish(&o.common, run(&o));
}
