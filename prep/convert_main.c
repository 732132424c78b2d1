/* leafcast convert - turns a volume or a mesh into a treelet file. */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/clock.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/input_open.h"
#include "formats/trust_options.h"
#include "prep/convert_choices.h"
#include "prep/convert_defaults.h"
#include "prep/convert_notes.h"
#include "prep/convert_report.h"
#include "prep/convert_sets.h"

enum { ZSTD_LEVEL_DEFAULT = 3, ZSTD_LEVEL_MAX = 22 };

typedef struct arguments {
    cli_common common;
    volume_hints hints;
    mesh_hints mesh;
    convert_sets sets;
    uint32_t treelet_tets, leaf_tets, coarse_dims;
    bool coarse, sah;
    leaf_parameters file;
    bool gradients, dry_run, allow_empty;
} arguments;

enum {
    KEY_COMPRESS = 0x2000,
    KEY_TREELET,
    KEY_HALO,
    KEY_DRY_RUN,
    KEY_DIMS,
    KEY_TYPE,
    KEY_BIG_ENDIAN,
    KEY_SKIP,
    KEY_SPACING,
    KEY_MISSING,
    KEY_ORIGIN,
    KEY_EXAGGERATE,
    KEY_AXES,
    KEY_UNIT,
    KEY_AXIS_X,
    KEY_AXIS_Y,
    KEY_AXIS_Z,
    KEY_FIELD,
    KEY_FIELDS,
    KEY_TIMES,
    KEY_COMPONENT,
    KEY_STEP,
    KEY_STEPS,
    KEY_CELLS_TO_POINTS,
    KEY_TREELET_TETS,
    KEY_LEAF_TETS,
    KEY_BUILD,
    KEY_COARSE,
    KEY_GRADIENTS,
    KEY_NAME,
    KEY_ALLOW_EMPTY
};

static const struct argp_option options[] = {
    {"compress", KEY_COMPRESS, "zstd:N|none", CLI_BASIC,
     "payloads: zstd of level 1 to 22, or none (default)", 0},
    {"treelet", KEY_TREELET, "CELLS", CLI_EXPERIMENT,
     "cells per axis of a treelet: 16, 32 (default) or 64", 0},
    {"halo", KEY_HALO, "0|1", CLI_EXPERIMENT, "samples around a treelet, for normals (default 1)",
     0},
    {"name", KEY_NAME, "TEXT", 0,
     "of the data set (default: what the input says itself; its file's name stays out)", 0},
    {"allow-empty", KEY_ALLOW_EMPTY, NULL, 0, "convert an input without any finite number, too", 0},
    {"dry-run", KEY_DRY_RUN, NULL, CLI_BASIC,
     "print sizes, memory, levels and treelets; write nothing", 0},
    TRUST_OPTIONS(0),
    {NULL, 0, NULL, 0, "What a raw input does not say itself:", 1},
    {"dims", KEY_DIMS, "X,Y,Z", CLI_BASIC, "samples per axis", 1},
    {"type", KEY_TYPE, "TYPE", CLI_BASIC, "u8 i8 u16 i16 u32 i32 u64 i64 f16 f32 f64", 1},
    {"big-endian", KEY_BIG_ENDIAN, NULL, 0, "most significant byte first", 1},
    {"skip", KEY_SKIP, "BYTES", 0, "header bytes to pass over", 1},
    {NULL, 0, NULL, 0, "What any grid may have wrong:", 2},
    {"spacing", KEY_SPACING, "X,Y,Z", CLI_BASIC,
     "distance of samples, or scale of an axis' coordinates; may be negative", 2},
    {"missing", KEY_MISSING, "VALUE", 0,
     "this value stands for no data; integers are then kept as f32", 2},
    {"origin", KEY_ORIGIN, "X,Y,Z", 0, "world position of the first sample", 2},
    {"exaggerate", KEY_EXAGGERATE, "Z", 0,
     "factor on the world's z: where degrees stand beside metres", 2},
    {"axes", KEY_AXES, "none|LPS|RAS", 0,
     "which way the axes point in a body: x to the left and y to the back (LPS), or x to the right "
     "and y to the front (RAS)",
     2},
    {"unit", KEY_UNIT, "NAME", 0, "of lengths, such as mm", 2},
    {"axis-x", KEY_AXIS_X, "FILE", 0,
     "text file with one coordinate per sample: a rectilinear grid", 2},
    {"axis-y", KEY_AXIS_Y, "FILE", 0, NULL, 2},
    {"axis-z", KEY_AXIS_Z, "FILE", 0, NULL, 2},
    {NULL, 0, NULL, 0, "Inputs with several fields, and meshes:", 3},
    {"field", KEY_FIELD, "NAME", CLI_BASIC,
     "an array, grid, data set or variable to take, may be repeated (default: the first; of a "
     "mesh, "
     "of its points)",
     3},
    {"step", KEY_STEP, "N", 0,
     "of several time steps in one file, from 0 on (default 0; of VTK's collections all)", 3},
    {"fields", KEY_FIELDS, "all", CLI_BASIC,
     "take all fields: of a mesh all arrays of the points (or cells), of a grid all that are like "
     "the first",
     3},
    {"steps", KEY_STEPS, STEP_LIST_FORM, CLI_BASIC, "take these time steps of one file", 3},
    {"times", KEY_TIMES, "T0,T1,..", 0,
     "times of the steps (default: those of the file, else 0, 1, ..)", 3},
    {"component", KEY_COMPONENT, "N", 0,
     "of vectors and colours: 1, 2, ..; default: their magnitude, or luminance", 3},
    {"cells-to-points", KEY_CELLS_TO_POINTS, NULL, 0,
     "take an array of the cells, averaged to the points", 3},
    {"coarse", KEY_COARSE, "N", OPTION_ARG_OPTIONAL,
     "with a regular grid of the values, for previews: N nodes along the longest edge (default: "
     "half as many nodes as tets)",
     3},
    {"treelet-tets", KEY_TREELET_TETS, "N", CLI_EXPERIMENT,
     "at most so many in a treelet (default 4096)", 3},
    {"leaf-tets", KEY_LEAF_TETS, "N", CLI_EXPERIMENT,
     "at most so many in a leaf of its tree (default 12)", 3},
    {"build", KEY_BUILD, "bih|sah", CLI_EXPERIMENT,
     "trees of treelets: by keys (default), or by the surface area heuristic, for comparison", 3},
    {"gradients", KEY_GRADIENTS, NULL, CLI_BASIC,
     "store the gradient at each vertex, too, for smooth normals", 3},
    {NULL, 0, NULL, 0, NULL, 0}};

/* Classes of inputs, and which of them can use an option. Options not listed here work for all. */
enum {
    RAW = 1,
    HEADED = 2,
    FIELDS = 4,
    GRID = RAW | HEADED | FIELDS,
    LONE_MESH = 8,
    STEP_MESH = 16,   /* its format may hold several steps */
    NAMING_MESH = 32, /* its file names other files that hold the mesh or its steps */
    STEPS = STEP_MESH | NAMING_MESH,
    MESH = LONE_MESH | STEPS
};
static const char *const input_names[] = {[RAW] = "raw samples",
                                          [GRID] = "grids",
                                          [FIELDS] = "grids of formats that have several",
                                          [FIELDS | STEPS] = "formats of several steps",
                                          [GRID | STEPS] = "grids and meshes of several steps",
                                          [GRID | NAMING_MESH] = "grids and collections of VTK",
                                          [MESH] = "meshes",
                                          [FIELDS | MESH] = "formats that have several"};
static const cli_use uses[] = {{TRUST_KEY_LINKS, GRID | NAMING_MESH},
                               {TRUST_KEY_MISSING, GRID},
                               {KEY_TREELET, GRID},
                               {KEY_HALO, GRID},
                               {KEY_DIMS, RAW},
                               {KEY_TYPE, RAW},
                               {KEY_BIG_ENDIAN, RAW},
                               {KEY_SKIP, RAW},
                               {KEY_SPACING, GRID},
                               {KEY_MISSING, GRID},
                               {KEY_ORIGIN, GRID},
                               {KEY_EXAGGERATE, GRID},
                               {KEY_AXES, GRID},
                               {KEY_UNIT, GRID},
                               {KEY_AXIS_X, GRID},
                               {KEY_AXIS_Y, GRID},
                               {KEY_AXIS_Z, GRID},
                               {KEY_FIELD, FIELDS | MESH},
                               {KEY_FIELDS, GRID | MESH},
                               {KEY_COMPONENT, FIELDS | MESH},
                               {KEY_STEP, FIELDS | STEPS},
                               {KEY_STEPS, GRID | STEPS},
                               {KEY_CELLS_TO_POINTS, MESH},
                               {KEY_COARSE, MESH},
                               {KEY_TREELET_TETS, MESH},
                               {KEY_LEAF_TETS, MESH},
                               {KEY_BUILD, MESH},
                               {KEY_GRADIENTS, MESH}};

static status set_spacing(arguments *a, const char *text) {
    status st = num_doubles(text, "--spacing", ", ", 3, a->hints.spacing);
    for (int i = 0; i < 3 && st == ST_OK; i++)
        if (!isfinite(a->hints.spacing[i]) || a->hints.spacing[i] == 0)
            st = status_describe(ST_USAGE, "--spacing: \"%s\": expected three numbers other than 0",
                                 text);
    return st;
}

static status set_exaggerate(volume_hints *h, const char *text) {
    status st = num_double(text, "--exaggerate", &h->exaggerate);
    if (st == ST_OK && !(h->exaggerate > 0 && isfinite(h->exaggerate)))
        st = status_describe(ST_USAGE, "--exaggerate: \"%s\": expected a number above 0", text);
    return st;
}

static status set_compress(arguments *a, const char *text) {
    if (strcmp(text, "none") == 0) {
        a->file.codec = LEAF_CODEC_RAW;
        return ST_OK;
    }
    if (strncmp(text, "zstd", 4) != 0 || (text[4] != '\0' && text[4] != ':'))
        return status_describe(ST_USAGE, "--compress: \"%s\" is neither zstd:N nor none", text);
    a->file.codec = LEAF_CODEC_ZSTD;
    a->file.zstd_level = ZSTD_LEVEL_DEFAULT;
    return text[4] ? cli_int(text + 5, "--compress zstd", 1, ZSTD_LEVEL_MAX, &a->file.zstd_level)
                   : ST_OK;
}

static status set_treelet(arguments *a, const char *text) {
    uint32_t cells = 0;
    status st =
        cli_uint(text, "--treelet", 1 << LEAF_CELLS_LOG2_MIN, 1 << LEAF_CELLS_LOG2_MAX, &cells);
    if (st == ST_OK && (cells & (cells - 1)))
        st = status_describe(ST_USAGE, "--treelet: %s is none of 16, 32, 64", text);
    if (st == ST_OK)
        a->file.cells_log2 = (uint32_t)__builtin_ctz(cells);
    return st;
}

static status set_build(arguments *a, const char *name) {
    a->sah = strcmp(name, "sah") == 0;
    if (a->sah || strcmp(name, "bih") == 0)
        return ST_OK;
    return status_describe(ST_USAGE, "--build: \"%s\" is neither bih nor sah", name);
}

static status add_field(arguments *a, const char *name) {
    status st = convert_sets_add(&a->sets, name);
    if (st == ST_OK && a->sets.count == 1) {
        a->mesh.field = a->sets.names[0];
        a->hints.field = name;
    }
    return st;
}

static status set_fields(const char *text, bool *all) {
    *all = strcmp(text, "all") == 0;
    return *all ? ST_OK : status_describe(ST_USAGE, "--fields takes all; --field NAME takes one");
}

static status set_axes(volume_hints *h, const char *text) {
    h->has_axes = world_axes_find(text, &h->axes);
    return h->has_axes
               ? ST_OK
               : status_describe(ST_USAGE, "--axes: \"%s\": expected none, LPS or RAS", text);
}

static status set_grid(volume_hints *h, int key, const char *text) {
    switch (key) {
    case KEY_DIMS: return cli_dims(text, "--dims", 1, GRID_DIM_MAX, h->dims);
    case KEY_TYPE: return cli_sample_type(text, &h->type);
    case KEY_BIG_ENDIAN: h->big_endian = true; return ST_OK;
    case KEY_SKIP: return num_size(text, "--skip", &h->skip);
    case KEY_MISSING: h->has_missing = true; return num_double(text, "--missing", &h->missing);
    case KEY_ORIGIN: h->has_origin = true; return num_doubles(text, "--origin", ", ", 3, h->origin);
    case KEY_AXES: return set_axes(h, text);
    case KEY_UNIT: h->unit = text; return ST_OK;
    case KEY_EXAGGERATE: return set_exaggerate(h, text);
    case KEY_AXIS_X:
    case KEY_AXIS_Y:
    case KEY_AXIS_Z: h->axis_file[key - KEY_AXIS_X] = text; return ST_OK;
    default: return ST_AGAIN;
    }
}

static status set_component(arguments *a, const char *text) {
    status st = cli_int(text, "--component", 1, INT_MAX, &a->mesh.component);
    a->hints.component = (uint32_t)a->mesh.component;
    return st;
}

static status set_mesh(arguments *a, int key, const char *text) {
    switch (key) {
    case KEY_FIELD: return add_field(a, text);
    case KEY_FIELDS: return set_fields(text, &a->sets.all_fields);
    case KEY_STEPS: return step_list_parse(text, "--steps", &a->sets.taken);
    case KEY_TIMES: a->sets.times = text; return ST_OK;
    case KEY_COMPONENT: return set_component(a, text);
    case KEY_STEP: return cli_uint(text, "--step", 0, INT_MAX, &a->hints.step);
    case KEY_CELLS_TO_POINTS: a->mesh.cells_to_points = true; return ST_OK;
    case KEY_TREELET_TETS:
        return cli_uint(text, "--treelet-tets", 1, LEAF_TREELET_TETS_MAX, &a->treelet_tets);
    case KEY_LEAF_TETS: return cli_uint(text, "--leaf-tets", 1, LEAF_LEAF_TETS_MAX, &a->leaf_tets);
    case KEY_BUILD: return set_build(a, text);
    case KEY_COARSE:
        a->coarse = true;
        a->coarse_dims = 0;
        return text ? cli_uint(text, "--coarse", 2, GRID_DIM_MAX, &a->coarse_dims) : ST_OK;
    case KEY_GRADIENTS: a->gradients = true; return ST_OK;
    default: return ST_AGAIN;
    }
}

static status set_option(void *own, int key, const char *text) {
    arguments *a = own;
    switch (key) {
    case KEY_COMPRESS: return set_compress(a, text);
    case KEY_TREELET: return set_treelet(a, text);
    case KEY_HALO: return cli_uint(text, "--halo", 0, 1, &a->file.halo);
    case KEY_DRY_RUN: a->dry_run = true; return ST_OK;
    case KEY_SPACING: return set_spacing(a, text);
    case KEY_ALLOW_EMPTY: a->allow_empty = true; return ST_OK;
    case KEY_NAME: a->hints.name = a->mesh.name = text; return ST_OK;
    default: break;
    }
    status st = trust_option(&a->hints.trust, key);
    if (st == ST_AGAIN)
        st = set_grid(&a->hints, key, text);
    return st == ST_AGAIN ? set_mesh(a, key, text) : st;
}

static status check(void *own) {
    const arguments *a = own;
    if (!a->common.input || (!a->common.output && !a->dry_run))
        return status_describe(ST_USAGE, "an INPUT and -o are needed");
    return convert_sets_check(&a->sets, a->common.input_count, cli_given(&a->common, KEY_STEP));
}

static const output_kind *output(const void *own) {
    static const output_kind leaf = {.what = "a treelet file",
                                     .suffixes = ".leaf ",
                                     .instead = "`leafcast export F.leaf -o FILE' writes others"};
    (void)own;
    return &leaf;
}

static const cli_verb verb = {
    .options = options,
    .set_option = set_option,
    .check = check,
    .output = output,
    .inputs_max = LEAF_SETS_MAX,
    .args_doc = "INPUT... -o F.leaf",
    .doc =
        "Convert a volume or a mesh to a treelet file. INPUT: NRRD, MHD/MHA, VTK grids "
        "(.vti, .vtr, straight .vts, legacy .vtk; in pieces: .pvti, .pvtr, .pvts), NIfTI, NumPy "
        "arrays, MRC, FreeSurfer (.mgh, .mgz), PVM, SLC, XDMF, Zarr 2 and OME-Zarr (a folder), raw "
        "samples "
        "(dimensions in the file's name, in a JSON beside it, or given); a mesh of tetrahedra: "
        "TetGen (.node, .ele), VTK (.vtk, .vtu; in files: .pvtu, .vtm), Gmsh (.msh), a mesh "
        "stream; "
        "VTK's collections of either (.pvd), with all their steps; packed by gzip, "
        "bzip2, xz or zstd; or - for any of these on standard input that takes one file and one "
        "pass. OpenVDB, images (a file of several, a folder), DICOM series (a folder), HDF5 and "
        "NetCDF are read by the verbs import-vdb, import-images and so on, if they are there. "
        "Several inputs are the steps "
        "of a time series: grids of the same sizes and place; meshes of the same tets, whose "
        "points may move."
        "\vExample:\n  leafcast convert bonsai_256x256x256_uint8.raw -o bonsai.leaf\v"
        "The input is read once. Memory stays below --memory "
        "(default 2G) whatever its size; "
        "what does not fit (of a volume: two slabs in half of it) goes through temporary files "
        "beside the output. The output's bytes depend on neither --memory nor --threads, "
        "nor on what the input's file is called.",
};

/* ---- one input ---- */

static status convert_grid(arguments *a, mem *m, volume *v, const grid_series *series,
                           double start) {
    convert_options o = {.file = a->file,
                         .series = series,
                         .memory = m->limit,
                         .threads = a->common.threads,
                         .force = a->common.force,
                         .refuse_empty = !a->allow_empty};
    const convert_report how = {&a->common, &a->sets, a->dry_run};
    convert_plan plan;
    status st = convert_plan_make(m, volume_grid(v), &o, &plan);
    if (st != ST_OK)
        return st;
    if (a->dry_run)
        return convert_report_grid(&how, &plan, volume_grid(v), NULL);
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
    if (out.result.absent.count)
        cli_note(&a->common, 1, "%s: %s", a->common.input, absent_print(&out.result.absent, text));
    return convert_report_grid(&how, &plan, volume_grid(v), &out);
}

static status convert_mesh(arguments *a, mem *m, mesh_input *x, const mesh_series *series,
                           double start) {
    const mesh_options o = {.file = a->file,
                            .series = series,
                            .treelet_tets = a->treelet_tets,
                            .leaf_tets = a->leaf_tets,
                            .sah = a->sah,
                            .coarse = a->coarse,
                            .coarse_dims = a->coarse_dims,
                            .memory = m->limit,
                            .threads = a->common.threads,
                            .force = a->common.force,
                            .gradients = a->gradients,
                            .refuse_empty = !a->allow_empty};
    mesh_result r;
    const progress *p = cli_progress(&a->common);
    status st = a->dry_run ? mesh_convert_dry(m, x, &o, p, &r)
                           : mesh_convert_run(m, x, a->common.output, &o, p, &r);
    if (st == ST_OK)
        st = convert_report_mesh(&(convert_report){&a->common, &a->sets, a->dry_run}, &r,
                                 clock_seconds() - start);
    return st;
}

/* ---- a series ---- */

static leaf_sets leaf_sets_of(const arguments *a) {
    return (leaf_sets){.fields = a->sets.count ? (uint32_t)a->sets.count : 1,
                       .steps = convert_sets_count_steps(&a->sets, a->common.input_count),
                       .names = a->sets.count ? a->sets.names : NULL,
                       .times = a->sets.parsed,
                       .time_unit = a->sets.time_unit[0] ? a->sets.time_unit : NULL};
}

static status convert_meshes(arguments *a, mem *m, mesh_input *x, double start) {
    status st = convert_sets_of_mesh(&a->sets, x, a->common.input);
    if (st == ST_OK)
        st =
            convert_sets_times(&a->sets, convert_sets_count_steps(&a->sets, a->common.input_count));
    const leaf_sets sets = leaf_sets_of(a);
    const mesh_series series = {.paths = (const char *const *)a->common.inputs,
                                .in_file = a->sets.steps > 0 ? &a->sets.taken : NULL,
                                .steps = sets.steps,
                                .names = sets.names,
                                .fields = sets.fields,
                                .times = sets.times,
                                .hints = a->mesh};
    if (st == ST_OK)
        st = mesh_series_check(&series);
    return st == ST_OK ? convert_mesh(a, m, x, &series, start) : st;
}

static void note_left_out(void *ctx, const char *name, const char *why) {
    const arguments *a = ctx;
    cli_note(&a->common, 1, "field %s is left out: %s", name, why);
}

/* Open each of several sets by itself. The first volume rests meanwhile, so that an importer gets
 * the whole share of memory for importers. */
static status begin_series(arguments *a, mem *m, grid_series *series, volume **v) {
    volume *first = *v;
    if (series->sets.fields * series->sets.steps > 1)
        volume_rest(first);
    status st = convert_sets_keep_alike(&a->sets, series, first, note_left_out, a);
    series->fields_alike = a->sets.all_fields;
    if (st == ST_OK)
        st = grid_series_check(m, series, first);
    if (st != ST_OK || !volume_rests(first))
        return st;
    *v = NULL;
    volume_close(first);
    return grid_series_open(m, series, 0, v);
}

static status convert_volumes(arguments *a, mem *m, volume **v, double start) {
    status st = convert_sets_of_grid(&a->sets, *v, a->common.input);
    if (a->sets.times_fall)
        cli_note(&a->common, 1, "%s: its times do not ascend: 0, 1, .. instead", a->common.input);
    if (st == ST_OK)
        st =
            convert_sets_times(&a->sets, convert_sets_count_steps(&a->sets, a->common.input_count));
    grid_series series = {.paths = (const char *const *)a->common.inputs,
                          .in_file = a->sets.steps > 0 ? &a->sets.taken : NULL,
                          .sets = leaf_sets_of(a),
                          .fields = a->sets.count ? a->sets.asked : NULL,
                          .hints = a->hints};
    if (st == ST_OK)
        st = begin_series(a, m, &series, v);
    return st == ST_OK ? convert_grid(a, m, *v, &series, start) : st;
}

/* ---- the kind of input ---- */

/* A VTK collection is a list of steps. All are taken, as if they were given one by one. */
static bool is_collection(const input *in) {
    return in->x ? mesh_input_names_files(in->x) && mesh_input_times(in->x)
                 : strcmp(volume_format(in->v), VOLUME_COLLECTION) == 0;
}

static status convert_opened(arguments *a, mem *m, input *in, double start) {
    const char *format = in->x ? mesh_input_format(in->x) : volume_format(in->v);
    const int kind = in->x && mesh_input_names_files(in->x)      ? NAMING_MESH
                     : in->x && mesh_input_may_have_steps(in->x) ? STEP_MESH
                     : in->x                                     ? LONE_MESH
                     : strcmp(format, VOLUME_RAW_SAMPLES) == 0   ? RAW
                     : volume_has_fields(in->v)                  ? FIELDS
                                                                 : HEADED;
    status st =
        cli_check_uses(&a->common, uses, sizeof uses / sizeof *uses, kind, input_names, format);
    if (st != ST_OK)
        return st;
    if (is_collection(in) && a->common.input_count == 1 && !cli_given(&a->common, KEY_STEP))
        convert_sets_take_all(&a->sets);
    if (in->v && volume_importer(in->v))
        cli_note(&a->common, 1, "%s: %s, read by leafcast import-%s", a->common.input, format,
                 volume_importer(in->v));
    if (in->v)
        convert_note_grid(&a->common, volume_grid(in->v), a->hints.exaggerate != 0);
    if (in->v)
        convert_note_volume(&a->common, in->v, &a->hints, cli_given(&a->common, KEY_STEP),
                            &a->sets);
    else
        convert_note_mesh(&a->common, in->x, &a->mesh, cli_given(&a->common, KEY_STEP), &a->sets);
    return in->x ? convert_meshes(a, m, in->x, start) : convert_volumes(a, m, &in->v, start);
}

/* Check all paths before an input is opened, which may take hours. */
static status guard_files(const arguments *a) {
    const char *output = a->dry_run ? NULL : a->common.output;
    if (output && strcmp(output, "-") == 0)
        return status_describe(ST_USAGE, "-o -: a treelet file cannot go to standard output: its "
                                         "header is written last (./- is a file)");
    file_guard_watch();
    status st = ST_OK;
    for (int i = 0; i < a->common.input_count && st == ST_OK; i++)
        st = file_guard_input(a->common.inputs[i]);
    for (int i = 0; i < 3 && st == ST_OK; i++)
        st = file_guard_input(a->hints.axis_file[i]);
    return st == ST_OK ? file_guard_output(output) : st;
}

static status run(arguments *a) {
    mem m;
    mem_init(&m, a->common.memory ? a->common.memory : CONVERT_MEMORY_DEFAULT);
    const double start = clock_seconds();
    input in = {0};
    a->sets.m = &m;
    convert_sets_first_step(&a->sets, &a->hints.step);
    a->mesh.step = a->hints.step;
    a->mesh.trust = a->hints.trust;
    status st = guard_files(a);
    if (st == ST_OK)
        st = input_open(&m, a->common.input, &a->hints, &a->mesh, &in);
    if (st == ST_OK)
        st = convert_opened(a, &m, &in, start);
    input_close(&in);
    convert_sets_release(&a->sets);
    return st;
}

int main(int argc, char **argv) {
    arguments a = {.common = {.verb = "convert"},
                   .treelet_tets = MESH_TREELET_TETS,
                   .leaf_tets = MESH_LEAF_TETS,
                   .file = convert_parameters_default()};
    cli_parse(&verb, &a.common, argc, argv);
    return cli_finish(&a.common, run(&a));
}
