/* leafcast convert - turns a volume or a mesh into a treelet file. */
#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/clock.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "formats/base/path_pattern.h"
#include "formats/base/text.h"
#include "formats/curvilinear_options.h"
#include "formats/grid/grid.h"
#include "formats/input_open.h"
#include "formats/trust_options.h"
#include "prep/convert_append.h"
#include "prep/convert_defaults.h"
#include "prep/convert_watch.h"
#include "prep/curvilinear/convert_curvilinear.h"
#include "prep/grid/convert_grids.h"
#include "prep/mesh/convert_meshes.h"
#include "prep/mesh/mesh_convert.h"

enum { ZSTD_LEVEL_DEFAULT = 1, ZSTD_LEVEL_MAX = 22 };

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
    KEY_HEIGHTS,
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
    KEY_BY_CORNERS,
    KEY_TREELET_TETS,
    KEY_LEAF_TETS,
    KEY_BUILD,
    KEY_COARSE,
    KEY_GRADIENTS,
    KEY_WHOLE,
    KEY_NORMALS,
    KEY_NAME,
    KEY_ALLOW_EMPTY,
    KEY_IN_PLACE,
    KEY_LEVELS,
    KEY_RESUME,
    KEY_CHECKPOINT,
    KEY_APPEND,
    KEY_WATCH,
    KEY_UNTIL,
    KEY_SETTLE
};

static const struct argp_option options[] = {
    {"compress", KEY_COMPRESS, "zstd:N|none", CLI_BASIC,
     "small files: zstd, of level 1 (if none is said) to 22; or none (default)", 0},
    {"treelet", KEY_TREELET, "CELLS", CLI_EXPERIMENT,
     "cells per axis of a treelet: 16, 32 (default) or 64", 0},
    {"halo", KEY_HALO, "0|1", CLI_EXPERIMENT, "samples around a treelet, for normals (default 1)",
     0},
    {"name", KEY_NAME, "TEXT", 0,
     "of the data set (default: what the input says itself; its file's name stays out)", 0},
    {"allow-empty", KEY_ALLOW_EMPTY, NULL, 0, "convert an input without any finite number, too", 0},
    {"dry-run", KEY_DRY_RUN, NULL, CLI_BASIC,
     "print sizes, memory, levels and treelets; write nothing", 0},
    {"in-place", KEY_IN_PLACE, NULL, CLI_BASIC,
     "leave the samples in the input's file or chunks, which must stay as they are: the output is "
     "an index with the coarse levels, compressed, or without them",
     0},
    {"levels", KEY_LEVELS, "1|all", 0,
     "1: no coarse levels of detail, which exact pictures do not need (default all)", 0},
    {"append", KEY_APPEND, NULL, CLI_BASIC,
     "add the input as further steps to the output, which stays whole if anything fails; make it "
     "if "
     "it is not there",
     0},
    {"watch", KEY_WATCH, NULL, 0,
     "the same with each file that comes to fit INPUT, a pattern such as 'step_*.nrrd'", 0},
    {"until", KEY_UNTIL, "N", 0, "with --watch: end when the output has N steps", 0},
    {"settle", KEY_SETTLE, "SECONDS", 0,
     "with --watch: a file is whole when it has not changed for so long (default 2)", 0},
    {"resume", KEY_RESUME, NULL, CLI_BASIC,
     "go on where a run of the same command ended early, or had ended; else begin", 0},
    {"checkpoint", KEY_CHECKPOINT, "SECONDS", 0,
     "save what --resume needs every so often (default 1), or less often where that costs more "
     "than "
     "a twentieth of the time",
     0},
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
    {"heights", KEY_HEIGHTS, NULL, 0, "a grid of one slice is terrain: its samples are elevations",
     2},
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
    {"by-corners", KEY_BY_CORNERS, NULL, 0,
     "take cells of higher order as linear ones of their corners, without what they hold in "
     "between (default: refuse them)",
     3},
    {"coarse", KEY_COARSE, "N", OPTION_ARG_OPTIONAL,
     "of meshes and curvilinear grids: with a regular grid of the values, for previews: N nodes "
     "along the longest edge (default: half as many nodes as tets, as many as of whole cells; of "
     "curvilinear grids every second or n-th node first)",
     3},
    {"treelet-tets", KEY_TREELET_TETS, "N", CLI_EXPERIMENT,
     "at most so many in a treelet (default 4096)", 3},
    {"leaf-tets", KEY_LEAF_TETS, "N", CLI_EXPERIMENT,
     "at most so many in a leaf of its tree (default 12)", 3},
    {"build", KEY_BUILD, "bih|sah", CLI_EXPERIMENT,
     "trees of treelets: by keys (default), or by the surface area heuristic, for comparison", 3},
    {"gradients", KEY_GRADIENTS, NULL, CLI_BASIC,
     "store the gradient at each vertex, too, for smooth normals", 3},
    {"whole-cells", KEY_WHOLE, NULL, 0,
     "keep hexahedra, wedges and pyramids as they are, each with its own interpolant (default: "
     "split them into tets)",
     3},
    {"normals", KEY_NORMALS, "file|smooth|flat", 0,
     "of surfaces: those that the file has at its vertices (default), or made from the triangles "
     "around each, or none: triangles look flat",
     3},
    CURVILINEAR_OPTIONS(3),
    {NULL, 0, NULL, 0, NULL, 0}};

static const char *const input_names[] = {INPUT_TRAIT_NAMES, [INPUT_CELLS | INPUT_MEANS] = "meshes",
                                          [INPUT_LATTICE | INPUT_PLACED] = "grids"};

/* What an input must be like for an option to have an effect. Options not listed work for all. */
static const cli_use uses[] = {{TRUST_KEY_LINKS, INPUT_FILES},
                               {TRUST_KEY_MISSING, INPUT_PARTS},
                               {KEY_TREELET, INPUT_LATTICE},
                               {KEY_HALO, INPUT_LATTICE},
                               {KEY_IN_PLACE, INPUT_LATTICE},
                               {KEY_LEVELS, INPUT_LATTICE},
                               {KEY_DIMS, INPUT_RAW},
                               {KEY_TYPE, INPUT_RAW},
                               {KEY_BIG_ENDIAN, INPUT_RAW},
                               {KEY_SKIP, INPUT_RAW},
                               {KEY_SPACING, INPUT_LATTICE},
                               {KEY_MISSING, INPUT_LATTICE},
                               {KEY_HEIGHTS, INPUT_LATTICE},
                               {KEY_ORIGIN, INPUT_LATTICE},
                               {KEY_EXAGGERATE, INPUT_LATTICE | INPUT_PLACED},
                               {KEY_AXES, INPUT_LATTICE},
                               {KEY_UNIT, INPUT_LATTICE},
                               {KEY_AXIS_X, INPUT_LATTICE},
                               {KEY_AXIS_Y, INPUT_LATTICE},
                               {KEY_AXIS_Z, INPUT_LATTICE},
                               {KEY_FIELD, INPUT_CHOICES},
                               {KEY_COMPONENT, INPUT_CHOICES},
                               {KEY_STEP, INPUT_STEPS},
                               {KEY_STEPS, INPUT_SERIES},
                               {KEY_CELLS_TO_POINTS, INPUT_CELLS | INPUT_MEANS},
                               {KEY_COARSE, INPUT_ONE_LEVEL},
                               {KEY_TREELET_TETS, INPUT_CELLS},
                               {KEY_LEAF_TETS, INPUT_CELLS},
                               {KEY_BUILD, INPUT_CELLS},
                               {KEY_GRADIENTS, INPUT_CELLS},
                               {KEY_WHOLE, INPUT_CELLS | INPUT_MEANS},
                               {KEY_NORMALS, INPUT_CELLS},
                               {KEY_BY_CORNERS, INPUT_CELLS}};

static status set_spacing(convert_request *a, const char *text) {
    status st = num_doubles(text, "--spacing", ", ", 3, a->hints.grid.spacing);
    for (int i = 0; i < 3 && st == ST_OK; i++)
        if (!isfinite(a->hints.grid.spacing[i]) || a->hints.grid.spacing[i] == 0)
            st = status_describe(ST_USAGE, "--spacing: \"%s\": expected three numbers other than 0",
                                 text);
    return st;
}

static status set_compress(convert_request *a, const char *text) {
    a->codec_is_given = true;
    if (strcmp(text, "none") == 0) {
        const leaf_parameters raw = leaf_parameters_default();
        a->file.codec = raw.codec;
        a->file.run_align_log2 = raw.run_align_log2;
        return ST_OK;
    }
    if (strncmp(text, "zstd", 4) != 0 || (text[4] != '\0' && text[4] != ':'))
        return status_describe(ST_USAGE, "--compress: \"%s\" is neither zstd:N nor none", text);
    int level = ZSTD_LEVEL_DEFAULT;
    const status st =
        text[4] ? cli_int(text + 5, "--compress zstd", 1, ZSTD_LEVEL_MAX, &level) : ST_OK;
    leaf_parameters_compress(&a->file, level);
    return st;
}

static status set_treelet(convert_request *a, const char *text) {
    uint32_t cells = 0;
    status st =
        cli_uint(text, "--treelet", 1 << LEAF_CELLS_LOG2_MIN, 1 << LEAF_CELLS_LOG2_MAX, &cells);
    if (st == ST_OK && (cells & (cells - 1)))
        st = status_describe(ST_USAGE, "--treelet: %s is none of 16, 32, 64", text);
    if (st == ST_OK)
        a->file.cells_log2 = (uint32_t)__builtin_ctz(cells);
    return st;
}

static status set_levels(convert_request *a, const char *text) {
    a->file.bare = strcmp(text, "1") == 0;
    if (a->file.bare || strcmp(text, "all") == 0)
        return ST_OK;
    return status_describe(ST_USAGE, "--levels: \"%s\" is neither 1 nor all", text);
}

static status set_build(convert_request *a, const char *name) {
    a->sah = strcmp(name, "sah") == 0;
    if (a->sah || strcmp(name, "bih") == 0)
        return ST_OK;
    return status_describe(ST_USAGE, "--build: \"%s\" is neither bih nor sah", name);
}

static status set_normals(convert_request *a, const char *name) {
    static const char *const names[] = {
        [NORMALS_FILE] = "file", [NORMALS_SMOOTH] = "smooth", [NORMALS_FLAT] = "flat"};
    a->normals_are_given = true;
    for (a->normals = 0; a->normals <= NORMALS_FLAT; a->normals++)
        if (strcmp(name, names[a->normals]) == 0)
            return ST_OK;
    return status_describe(ST_USAGE, "--normals: \"%s\" is neither file, smooth nor flat", name);
}

static status add_field(convert_request *a, const char *name) {
    status st = convert_sets_add(&a->sets, name);
    if (st == ST_OK && a->sets.count == 1) {
        a->hints.mesh.field = a->sets.names[0];
        a->hints.curvilinear.field = a->hints.grid.field = name;
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
    case KEY_HEIGHTS: h->heights = true; return ST_OK;
    case KEY_ORIGIN: h->has_origin = true; return num_doubles(text, "--origin", ", ", 3, h->origin);
    case KEY_AXES: return set_axes(h, text);
    case KEY_UNIT: h->unit = text; return ST_OK;
    case KEY_EXAGGERATE: return cli_positive(text, "--exaggerate", &h->exaggerate);
    case KEY_AXIS_X:
    case KEY_AXIS_Y:
    case KEY_AXIS_Z: h->axis_file[key - KEY_AXIS_X] = text; return ST_OK;
    default: return ST_AGAIN;
    }
}

static status set_component(convert_request *a, const char *text) {
    status st = cli_int(text, "--component", 1, INT_MAX, &a->hints.mesh.component);
    a->hints.grid.component = (uint32_t)a->hints.mesh.component;
    a->hints.curvilinear.component = a->hints.mesh.component;
    return st;
}

static status set_mesh(convert_request *a, int key, const char *text) {
    switch (key) {
    case KEY_FIELD: return add_field(a, text);
    case KEY_FIELDS: return set_fields(text, &a->sets.all_fields);
    case KEY_STEPS: return step_list_parse(text, "--steps", &a->sets.taken);
    case KEY_TIMES: a->sets.times = text; return ST_OK;
    case KEY_COMPONENT: return set_component(a, text);
    case KEY_STEP: return cli_uint(text, "--step", 0, INT_MAX, &a->hints.grid.step);
    case KEY_BY_CORNERS: a->hints.mesh.by_corners = true; return ST_OK;
    case KEY_CELLS_TO_POINTS:
        a->hints.mesh.cells_to_points = a->hints.curvilinear.cells_to_points = true;
        return ST_OK;
    case KEY_TREELET_TETS:
        return cli_uint(text, "--treelet-tets", 1, LEAF_TREELET_TETS_MAX, &a->treelet_tets);
    case KEY_LEAF_TETS: return cli_uint(text, "--leaf-tets", 1, LEAF_LEAF_TETS_MAX, &a->leaf_tets);
    case KEY_BUILD: return set_build(a, text);
    case KEY_COARSE:
        a->coarse = true;
        a->coarse_dims = 0;
        return text ? cli_uint(text, "--coarse", 2, GRID_DIM_MAX, &a->coarse_dims) : ST_OK;
    case KEY_GRADIENTS: a->gradients = true; return ST_OK;
    case KEY_WHOLE: a->whole = true; return ST_OK;
    case KEY_NORMALS: return set_normals(a, text);
    default: return ST_AGAIN;
    }
}

static status set_checkpoint(convert_request *a, const char *text) {
    status st = num_double(text, "--checkpoint", &a->checkpoint);
    if (st == ST_OK && !(a->checkpoint >= 0 && isfinite(a->checkpoint)))
        st = status_describe(ST_USAGE, "--checkpoint: \"%s\": expected seconds, 0 or more", text);
    return st;
}

static status set_settle(convert_request *a, const char *text) {
    status st = num_double(text, "--settle", &a->watch.settle);
    if (st == ST_OK && !(a->watch.settle >= 0 && isfinite(a->watch.settle)))
        st = status_describe(ST_USAGE, "--settle: \"%s\": expected seconds, 0 or more", text);
    return st;
}

/* Note an option that the output depends on. */
static status note_told(convert_request *a, int key, const char *text) {
    if (key == KEY_DRY_RUN || key == KEY_RESUME || key == KEY_CHECKPOINT)
        return ST_OK;
    if (a->told_count == CONVERT_TOLD_MAX)
        return status_describe(ST_USAGE, "more than %d options", CONVERT_TOLD_MAX);
    a->told[a->told_count].key = key;
    a->told[a->told_count++].text = text;
    return ST_OK;
}

static status take_option(convert_request *a, int key, const char *text) {
    switch (key) {
    case KEY_IN_PLACE: a->in_place = true; return ST_OK;
    case KEY_APPEND: a->append = true; return ST_OK;
    case KEY_WATCH: a->watch.on = a->append = true; return ST_OK;
    case KEY_UNTIL: return cli_uint(text, "--until", 1, LEAF_SETS_MAX, &a->watch.until);
    case KEY_SETTLE: return set_settle(a, text);
    case KEY_RESUME: a->resume = true; return ST_OK;
    case KEY_CHECKPOINT: return set_checkpoint(a, text);
    case KEY_COMPRESS: return set_compress(a, text);
    case KEY_TREELET: return set_treelet(a, text);
    case KEY_LEVELS: return set_levels(a, text);
    case KEY_HALO: return cli_uint(text, "--halo", 0, 1, &a->file.halo);
    case KEY_DRY_RUN: a->dry_run = true; return ST_OK;
    case KEY_SPACING: return set_spacing(a, text);
    case KEY_ALLOW_EMPTY: a->allow_empty = true; return ST_OK;
    case KEY_NAME:
        a->hints.grid.name = a->hints.mesh.name = a->hints.curvilinear.name = text;
        return ST_OK;
    default: break;
    }
    status st = trust_option(&a->hints.grid.trust, key);
    if (st == ST_AGAIN)
        st = curvilinear_option(&a->hints.curvilinear, key, text);
    if (st == ST_AGAIN)
        st = set_grid(&a->hints.grid, key, text);
    return st == ST_AGAIN ? set_mesh(a, key, text) : st;
}

static status set_option(void *own, int key, const char *text) {
    status st = take_option(own, key, text);
    return st == ST_OK ? note_told(own, key, text) : st;
}

static status check(void *own) {
    convert_request *a = own;
    if (!a->common.input || (!a->common.output && !a->dry_run))
        return status_describe(ST_USAGE, "an INPUT and -o are needed");
    if (!a->watch.on && (cli_given(&a->common, KEY_UNTIL) || cli_given(&a->common, KEY_SETTLE)))
        return status_describe(ST_USAGE, "--until and --settle go with --watch");
    if (a->watch.on && (a->common.input_count > 1 || a->sets.times))
        return status_describe(ST_USAGE, "--watch takes one pattern, in quotes, and no --times");
    const status st =
        a->watch.on ? ST_OK : path_pattern_expand(&a->common.inputs, &a->common.input_count);
    if (st != ST_OK)
        return st;
    a->common.input = a->common.inputs[0];
    a->common.json_lines = a->watch.on;
    a->treelet_is_given = cli_given(&a->common, KEY_TREELET);
    a->halo_is_given = cli_given(&a->common, KEY_HALO);
    a->levels_are_given = cli_given(&a->common, KEY_LEVELS);
    a->treelet_tets_is_given = cli_given(&a->common, KEY_TREELET_TETS);
    a->leaf_tets_is_given = cli_given(&a->common, KEY_LEAF_TETS);
    if (a->append && (a->resume || a->dry_run || a->in_place || a->coarse || a->common.force))
        return status_describe(ST_USAGE,
                               "--append goes without --resume, --dry-run, --in-place, --coarse "
                               "and --force");
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
        "arrays, MRC, FreeSurfer (.mgh, .mgz), PVM, SLC, elevations (.asc, .hgt), "
        "XDMF, Zarr 2 and OME-Zarr (a folder), raw "
        "samples "
        "(dimensions in the file's name, in a JSON beside it, or given); a mesh of tetrahedra: "
        "TetGen (.node, .ele), VTK (.vtk, .vtu; in files: .pvtu, .vtm), Gmsh (.msh), a mesh "
        "stream; a curvilinear grid: VTK (.vts, .pvts, .vtk), PLOT3D; a surface of triangles: PLY, "
        "STL, OBJ, OFF, "
        "VTK (.vtp, .vtk), glTF (.glb); "
        "VTK's collections of either (.pvd), with all their steps; packed by gzip, "
        "bzip2, xz or zstd; or - for any of these on standard input that takes one file and one "
        "pass. OpenVDB, images (a file of several, a folder), DICOM series (a folder), HDF5 and "
        "NetCDF are read by the verbs import-vdb, import-images and so on, if they are there. "
        "Several inputs are the steps "
        "of a time series: grids of the same sizes and place; meshes of the same tets, whose "
        "points may move; also by a pattern: 'step_*.nrrd', step_%04d.nrrd."
        "\vExample:\n  leafcast convert bonsai_256x256x256_uint8.raw -o bonsai.leaf\v"
        "The input is read once. Memory stays below --memory "
        "(default 2G) whatever its size; "
        "what does not fit (of a volume: two slabs in half of it) goes through temporary files "
        "beside the output. The output's bytes depend on neither --memory nor --threads, "
        "nor on what the input's file is called.",
};

/* ---- the input ---- */

static const convert_kind *const kinds[] = {&convert_grids, &convert_meshes, &convert_curvilinear,
                                            &convert_surfaces};

static const convert_kind *kind_of(const input *in) {
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (kinds[i]->of == in->kind)
            return kinds[i];
    assert(false); /* a kind of input without a row */
    return NULL;
}

static status convert_opened(convert_request *a, mem *m, input *in, double start) {
    const convert_kind *kind = kind_of(in);
    status st = cli_check_uses(&a->common, uses, sizeof uses / sizeof *uses,
                               in->kind->traits(in->own), input_names, in->kind->format(in->own));
    if (st != ST_OK)
        return st;
    if (kind->is_collection(in->own) && a->common.input_count == 1 && !a->step)
        convert_sets_take_all(&a->sets);
    kind->note(a, in->own);
    return kind->run(a, m, in, start);
}

static status guard_input(void *ctx, const char *path) {
    (void)ctx;
    return file_guard_input(path);
}

/* Check all paths before an input is opened, which may take hours. */
static status guard_files(const convert_request *a) {
    const char *output = a->dry_run ? NULL : a->common.output;
    if (output && strcmp(output, "-") == 0)
        return status_describe(ST_USAGE, "-o -: a treelet file cannot go to standard output: its "
                                         "header is written last (./- is a file)");
    file_guard_watch();
    status st = ST_OK;
    for (int i = 0; i < a->common.input_count && st == ST_OK; i++)
        st = file_guard_input(a->common.inputs[i]);
    if (st == ST_OK)
        st = convert_request_beside(a, guard_input, NULL);
    return st == ST_OK ? file_guard_output(output) : st;
}

static status run(convert_request *a) {
    mem m;
    mem_init(&m, a->common.memory ? a->common.memory : CONVERT_MEMORY_DEFAULT);
    const double start = clock_seconds();
    input in = {0};
    a->sets.m = &m;
    a->step = cli_given(&a->common, KEY_STEP);
    convert_sets_first_step(&a->sets, &a->hints.grid.step);
    a->hints.curvilinear.step = a->hints.mesh.step = a->hints.grid.step;
    a->hints.curvilinear.trust = a->hints.mesh.trust = a->hints.grid.trust;
    a->hints.curvilinear.exaggerate = a->hints.grid.exaggerate;
    bool done = false;
    status st = guard_files(a);
    if (st == ST_OK && a->append)
        st = convert_append_open(a, &m);
    else if (st == ST_OK && !a->dry_run)
        st = convert_work_open(a, &m, &done);
    if (st == ST_OK && !done)
        st = input_open(&m, a->common.input, &a->hints, &in);
    if (st == ST_OK && !done)
        st = convert_opened(a, &m, &in, start);
    input_close(&in);
    convert_sets_release(&a->sets);
    convert_append_close(a);
    return convert_work_close(a, st);
}

int main(int argc, char **argv) {
    convert_request a = {.common = {.verb = "convert"},
                         .treelet_tets = MESH_TREELET_TETS,
                         .leaf_tets = MESH_LEAF_TETS,
                         .file = convert_parameters_default(),
                         .checkpoint = 1,
                         .watch = {.settle = 2},
                         .options = options};
    cli_parse(&verb, &a.common, argc, argv);
    const int code = a.watch.on ? convert_watch_run(&a, run) : cli_finish(&a.common, run(&a));
    if (!a.watch.on)
        path_pattern_release(a.common.inputs, a.common.input_count);
    curvilinear_options_release(&a.hints.curvilinear);
    return code;
}
