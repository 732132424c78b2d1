#include "prep/grid/convert_grids.h"

#include <string.h>

#include "formats/base/clock.h"
#include "formats/grid/chunk_array.h"
#include "formats/grid/slice_folder.h"
#include "formats/grid/volume_kind.h"
#include "formats/leaf/outside_samples.h"
#include "prep/convert_append.h"
#include "prep/convert_choices.h"
#include "prep/grid/convert_grid_append.h"
#include "prep/grid/convert_grid_report.h"
#include "prep/grid/convert_grid_sets.h"
#include "prep/grid/convert_notes.h"

/* ---- notes ---- */

static bool is_collection(const void *own) {
    return strcmp(volume_format(own), VOLUME_COLLECTION) == 0;
}

static status take_choice(void *ctx, const slice_field *f) {
    convert_choices_take(ctx, f);
    return ST_OK;
}

static void note_choices(const convert_request *a, const volume *v) {
    convert_choices c = {.common = &a->common,
                         .sets = &a->sets,
                         .component = a->hints.grid.component,
                         .step = a->step || step_list_given(&a->sets.taken)};
    if (a->common.verbosity <= 0 || !volume_has_fields(v))
        return;
    if (volume_fields(v, &(slice_fields){take_choice, &c}) == ST_OK)
        convert_choices_note(&c);
    else
        cli_note(&a->common, 1, "%s: what else it has cannot be listed: %s", a->common.input,
                 status_text());
}

static void note(const convert_request *a, const void *own) {
    if (volume_importer(own))
        cli_note(&a->common, 1, "%s: %s, read by leafcast import-%s", a->common.input,
                 volume_format(own), volume_importer(own));
    convert_note_grid(&a->common, volume_grid(own), a->hints.grid.exaggerate != 0);
    note_choices(a, own);
}

/* ---- in place ---- */

/* Where samples stay: the sections of the file. The volume rests before they are written. */
typedef struct staying {
    leaf_outside outside;
    chunk_entry *chunks; /* NULL: none; to be freed, */
    slice_file *slices;  /* like this */
} staying;

/* Keep copies of the tables of a place, of a grid of so many slices. */
static status keep_tables(mem *m, const sample_place *at, uint32_t slices, staying *out,
                          leaf_parameters *p) {
    if (!at->table)
        return ST_OK;
    out->chunks = mem_array(m, at->table_count, sizeof *out->chunks);
    out->slices = at->slices ? mem_array(m, slices, sizeof *out->slices) : NULL;
    if (!out->chunks || (at->slices && !out->slices))
        return ST_NOMEM;
    memcpy(out->chunks, at->table, at->table_count * sizeof *out->chunks);
    if (at->slices)
        memcpy(out->slices, at->slices, slices * sizeof *out->slices);
    p->chunks = out->chunks;
    p->chunk_count = at->table_count;
    p->slices = out->slices;
    return ST_OK;
}

/* Say in *out where the samples stay, and set the parameters for that. */
static status stay_in_place(const convert_request *a, mem *m, const volume *v,
                            const grid_series *series, staying *out, leaf_parameters *p) {
    sample_place at;
    if (series->of.sets.fields * series->of.sets.steps > 1)
        return status_describe(ST_UNSUPPORTED,
                               "%s: --in-place takes one field at one step: --field, --step",
                               a->common.input);
    if (!a->codec_is_given)
        leaf_parameters_compress(p, 1);
    if (p->codec == LEAF_CODEC_RAW)
        return status_describe(ST_USAGE, "--in-place compresses: without --compress none");
    if (!volume_place(v, &at))
        return status_describe(
            ST_UNSUPPORTED,
            "%s: --in-place takes samples that lie in one file as they are, x "
            "fastest, or in chunks of Zarr, HDF5 or netCDF-4, or pages of TIFFs: "
            "not packed, no text, no pipe",
            a->common.input);
    if (at.refused)
        return status_describe(ST_UNSUPPORTED, "%s: --in-place: it cannot stay as it is stored: %s",
                               a->common.input, at.refused);
    p->outside = &out->outside;
    const status st = keep_tables(m, &at, volume_grid(v)->dims[2], out, p);
    return st == ST_OK ? outside_samples_describe(m, &at, a->common.output ? a->common.output : "",
                                                  &out->outside)
                       : st;
}

/* ---- one series ---- */

/* in_place: room for what stays. */
static status convert_staying(convert_request *a, mem *m, volume *v, const grid_series *series,
                              double start, staying *in_place) {
    convert_options o = {.file = a->file,
                         .series = series,
                         .memory = m->limit - convert_append_memory(a, m),
                         .threads = a->common.threads,
                         .force = a->common.force,
                         .refuse_empty = !a->allow_empty,
                         .work = a->work.folder,
                         .grows = a->append,
                         .grow = a->grow,
                         .job = &a->work.job};
    convert_plan plan;
    status st = a->in_place ? stay_in_place(a, m, v, series, in_place, &o.file) : ST_OK;
    if (st == ST_OK)
        st = convert_plan_make(m, volume_grid(v), &o, &plan);
    if (st != ST_OK)
        return st;
    if (a->dry_run)
        return convert_grid_report(a, &plan, volume_grid(v), NULL);
    if (plan.spilled_levels)
        cli_note(&a->common, 1,
                 "%u levels go through a temporary file of %.1f MiB; %.1f MiB of memory would "
                 "avoid that",
                 plan.spilled_levels, (double)plan.spill_bytes / 0x1p20,
                 (double)plan.memory_in_core / 0x1p20);
    char text[ABSENT_TEXT];
    convert_outcome out;
    st = convert_run(m, v, a->common.output, &o, &plan, cli_progress(&a->common), &out.result);
    if (st != ST_OK)
        return st;
    out.seconds = clock_seconds() - start;
    if (out.result.trailing_bytes)
        cli_note(&a->common, 1, "%s: %llu bytes behind the samples are ignored", a->common.input,
                 (unsigned long long)out.result.trailing_bytes);
    convert_note_marker(&a->common, &out.result.marker);
    convert_append_note(a, &series->of.sets);
    if (out.result.absent.count)
        cli_note(&a->common, 1, "%s: %s", a->common.input, absent_print(&out.result.absent, text));
    return convert_grid_report(a, &plan, volume_grid(v), &out);
}

static status convert_grid(convert_request *a, mem *m, volume *v, const grid_series *series,
                           double start) {
    staying in_place = {.chunks = NULL};
    const status st = convert_staying(a, m, v, series, start, &in_place);
    mem_free(m, in_place.chunks);
    mem_free(m, in_place.slices);
    return st;
}

static void note_left_out(void *ctx, const char *name, const char *why) {
    const convert_request *a = ctx;
    cli_note(&a->common, 1, "field %s is left out: %s", name, why);
}

/* Open each of several sets by itself. The first volume rests meanwhile, so that an importer gets
 * the whole share of memory for importers. */
static status begin_series(convert_request *a, mem *m, grid_series *series, input *in) {
    volume *first = in->own;
    if (series->of.sets.fields * series->of.sets.steps > 1)
        volume_rest(first);
    status st = convert_grid_sets_alike(&a->sets, series, first, note_left_out, a);
    series->fields_alike = a->sets.all_fields;
    if (st == ST_OK)
        st = grid_series_check(m, series, first);
    if (st != ST_OK || !volume_rests(first))
        return st;
    volume *again = NULL;
    input_close(in);
    st = grid_series_open(m, series, 0, &again);
    if (st == ST_OK)
        *in = (input){&volume_kind, again};
    return st;
}

/* Terrain has large treelets, as they are thin. It has no halo: its normals are the patches' own.
 * It is compressed, as a raw file would have each height twice. */
static void prepare_heights(convert_request *a) {
    if (!a->codec_is_given)
        leaf_parameters_compress(&a->file, 1);
    a->file.cells_log2 = a->treelet_is_given ? a->file.cells_log2 : LEAF_CELLS_LOG2_MAX;
    a->file.halo = a->halo_is_given ? a->file.halo : 0;
}

static status run(convert_request *a, mem *m, input *in, double start) {
    if (volume_grid(in->own)->heights)
        prepare_heights(a);
    status st = convert_grid_sets(&a->sets, in->own, a->common.input);
    if (st == ST_OK)
        st = convert_request_times(a);
    grid_series series = {.of = convert_request_series(a), .hints = a->hints.grid};
    if (st == ST_OK)
        st = begin_series(a, m, &series, in);
    if (st == ST_OK)
        st = convert_grid_append_check(a, volume_grid(in->own), &series.of.sets);
    return st == ST_OK ? convert_grid(a, m, in->own, &series, start) : st;
}

const convert_kind convert_grids = {
    .of = &volume_kind, .is_collection = is_collection, .note = note, .run = run};
