/* leafcast export - writes samples, isosurfaces and meshes of a treelet file in other formats. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/clock.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "formats/base/out_folder.h"
#include "formats/base/text.h"
#include "formats/grid/grid.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_tell.h"
#include "prep/export/export_cells.h"
#include "prep/export/export_grid.h"
#include "prep/export/piece_export.h"

enum { MEMORY_DEFAULT_MIB = 2048 };

enum { KEY_FORMAT = 0x2000, KEY_BOX, KEY_LEVEL, KEY_ISO, KEY_FLOATS, KEY_FIELD, KEY_STEP };

/* What is exported: an option lists what it has an effect on. */
enum { LATTICE = 1, SURFACE = 2, CELLS = 4, GIVEN = 8 };
static const char *const use_names[] = {[LATTICE] = "grids", [SURFACE] = "isosurfaces"};
static const cli_use uses[] = {
    {KEY_BOX, LATTICE}, {KEY_LEVEL, LATTICE}, {KEY_ISO, SURFACE}, {KEY_FLOATS, SURFACE}};

static const struct argp_option options[] = {
    {"format", KEY_FORMAT,
     "nrrd|raw|nifti|nifti1|nifti2|metaimage|npy|vti|vtr|tiff|vdb|zarr|ply|stl|vtp|vtu", CLI_BASIC,
     "default: as the output's name ends (.nii: nifti); nifti is NIfTI-1 where that holds the grid "
     "exactly, else NIfTI-2",
     1},
    {NULL, 0, NULL, 0, "Grids:", 2},
    {"box", KEY_BOX, "I0,J0,K0,I1,J1,K1", CLI_BASIC,
     "the samples from the first to the last, both included, counted on the level", 2},
    {"level", KEY_LEVEL, "L", CLI_BASIC, "of detail: 0, the default, is full resolution", 2},
    {NULL, 0, NULL, 0, "Isosurfaces:", 3},
    {"iso", KEY_ISO, "V", CLI_BASIC,
     "the isovalue; may be repeated: the file then says which vertex is of which", 3},
    {"floats", KEY_FLOATS, NULL, 0,
     "coordinates of vertices as 32-bit floats instead of doubles: smaller, less exact", 3},
    {NULL, 0, NULL, 0, "Of several fields and steps:", 4},
    {"field", KEY_FIELD, "NAME", CLI_BASIC,
     "this one; may be repeated for .vdb, .vtu and surfaces (default: there all, else the first)",
     4},
    {"step", KEY_STEP, "K|all", CLI_BASIC,
     "of time steps this one, from 0 on (0); all: one .nii or .zarr of four axes", 4},
    {NULL, 0, NULL, 0, NULL, 0}};

/* ---- options ---- */

static status set_box(export_request *a, const char *text) {
    double numbers[6];
    a->boxed = true;
    status st = num_doubles(text, "--box", ", ", 6, numbers);
    for (int i = 0; i < 6 && st == ST_OK; i++) {
        if (!(numbers[i] >= 0 && numbers[i] <= GRID_DIM_MAX && numbers[i] == floor(numbers[i])))
            return status_describe(ST_USAGE, "--box: \"%s\": expected six numbers of samples",
                                   text);
        a->box[i] = (uint32_t)numbers[i];
    }
    return st;
}

static status add_iso(export_request *a, const char *text) {
    if (a->iso_count == EXPORT_ISOS_MAX)
        return status_describe(ST_USAGE, "more than %d isovalues", EXPORT_ISOS_MAX);
    double *iso = &a->isos[a->iso_count++];
    status st = cli_finite(text, "--iso", -HUGE_VAL, HUGE_VAL, iso);
    for (uint32_t i = 0; st == ST_OK && i + 1 < a->iso_count; i++)
        if (a->isos[i] == *iso)
            st = status_describe(ST_USAGE, "--iso %s: given twice", text);
    return st;
}

static status add_field(export_request *a, const char *name) {
    if (a->field_count == EXPORT_FIELDS_MAX)
        return status_describe(ST_USAGE, "more than %d fields by name", EXPORT_FIELDS_MAX);
    a->fields[a->field_count++] = name;
    return ST_OK;
}

static status set_format(export_request *a, const char *name) {
    int index;
    a->format_name = name;
    return cli_word(name, "--format", options[0].arg, &index);
}

static status set_step(export_request *a, const char *text) {
    a->all_steps = strcmp(text, "all") == 0;
    a->step = 0;
    return a->all_steps ? ST_OK : cli_uint(text, "--step", 0, LEAF_SETS_MAX, &a->step);
}

static status set_option(void *own, int key, const char *text) {
    export_request *a = own;
    switch (key) {
    case KEY_FORMAT: return set_format(a, text);
    case KEY_BOX: return set_box(a, text);
    case KEY_LEVEL: return cli_uint(text, "--level", 0, LEAF_LEVELS_MAX, &a->level);
    case KEY_ISO: return add_iso(a, text);
    case KEY_FLOATS: a->floats = true; return ST_OK;
    case KEY_FIELD: return add_field(a, text);
    case KEY_STEP: return set_step(a, text);
    default: return ST_AGAIN;
    }
}

static bool is_meant(const export_request *a, const char *name, const char *suffix,
                     const char *path) {
    return a->format_name ? strcmp(a->format_name, name) == 0
                          : suffix && text_ends_in(path, suffix);
}

/* Find the format by --format, or by the output's suffix. A .gz behind that packs a streamed
 * format. */
static status find_format(export_request *a) {
    char path[4096];
    snprintf(path, sizeof path, "%s", a->common.output);
    for (size_t n = strlen(path); n > 1 && path[n - 1] == '/'; n--)
        path[n - 1] = 0; /* shells append a slash when they complete a folder */
    a->gzip = text_ends_in(path, ".gz");
    if (a->gzip)
        path[strlen(path) - 3] = 0;
    for (int i = 0; i < sample_format_count; i++)
        if (is_meant(a, sample_formats[i].name, sample_formats[i].suffix, path))
            a->samples = &sample_formats[i];
    for (int i = 0; i < piece_format_count; i++)
        if (is_meant(a, piece_formats[i].name, piece_formats[i].suffix, path))
            a->pieces = &piece_formats[i];
    if (!a->samples && !a->pieces)
        return status_describe(ST_USAGE, "%s: which format? --format says it, or the name's end",
                               a->common.output);
    if (a->gzip && (a->pieces || a->samples->unpacked))
        return status_describe(ST_USAGE, "%s: %s is not packed by gzip", a->common.output,
                               a->pieces ? a->pieces->name : a->samples->name);
    if (a->all_steps && !(a->samples && a->samples->steps))
        return status_describe(ST_USAGE,
                               "--step all: a file of %s is of one step; .nii and .zarr have all",
                               a->pieces ? a->pieces->name : a->samples->name);
    return ST_OK;
}

static status check_surface(const export_request *a) {
    if (a->pieces->loose && a->floats)
        return status_describe(ST_USAGE, "--floats: .%s has no other", a->pieces->name);
    if (a->pieces->loose && a->iso_count > 1)
        return status_describe(ST_USAGE, "--iso: .%s cannot tell several isosurfaces apart",
                               a->pieces->name);
    return ST_OK;
}

/* What is wrong of isosurfaces of a file's kind. */
static status check_isosurface(const export_request *a) {
    if (a->iso_count == 0)
        return status_describe(ST_USAGE, "which isosurface? --iso says it; leafcast info suggests "
                                         "isovalues");
    if (a->field_count > 1)
        return status_describe(ST_USAGE, "--field: an isosurface is of one field");
    return ST_OK;
}

static status check(void *own) {
    export_request *a = own;
    if (!a->common.input || !a->common.output)
        return status_describe(ST_USAGE, "a treelet file and -o are needed");
    status st = find_format(a);
    return st == ST_OK && a->pieces && !a->pieces->solid ? check_surface(a) : st;
}

/* All suffixes of the format, packed ones too. A format known by name alone has those of its
 * relatives (nifti2: .nii).
 */
static const output_kind *output(const void *own) {
    static char suffixes[64];
    static output_kind kind = {.suffixes = suffixes};
    const export_request *a = own;
    *suffixes = 0;
    if (a->pieces) {
        kind.what = a->pieces->name;
        text_add(suffixes, sizeof suffixes, "%s ", a->pieces->suffix);
        return &kind;
    }
    kind.what = a->samples->name;
    kind.sequence = a->samples->slices;
    for (int i = 0; i < sample_format_count; i++) {
        const sample_format *f = &sample_formats[i];
        if (f->suffix && strncmp(kind.what, f->name, strlen(f->name)) == 0)
            text_add(suffixes, sizeof suffixes, f->unpacked ? "%s " : "%1$s %1$s.gz ", f->suffix);
    }
    return &kind;
}

static const cli_verb verb = {
    .options = options,
    .set_option = set_option,
    .check = check,
    .output = output,
    .input = "treelet file",
    .args_doc = "F.leaf -o FILE.nrrd|.raw|.nii|.mha|.npy|.vti|.vtr|.tif|.vdb|.zarr\n"
                "F.leaf --iso V -o FILE.ply|.stl|.vtp\nF.leaf -o FILE.vtu\n"
                "SURFACE|TERRAIN.leaf -o FILE.ply|.stl|.vtp",
    .doc =
        "Write what is in a treelet file to another format: the samples of a grid, isosurfaces, "
        "the cells of a mesh or a curvilinear grid, or the triangles of a surface, two a cell of "
        "terrain (-o -: to "
        "standard output, --format says what)."
        "\vExample:\n"
        "  leafcast export head.leaf --iso 1150 -o skull.ply\v"
        "Samples come out as they went in, to the bit, unless their type was not kept (u32, i32, "
        "f64). What a format cannot hold is refused. Names that end in .gz are packed; "
        "slice_%04d.tif is a file a slice. Surfaces are welded; their vertices lie on the "
        "interpolant's surface. Memory stays below "
        "--memory (default 2G); what does not fit goes to temporary files beside the output (-o "
        "-: in $TMPDIR). The output's bytes depend on neither --memory nor --threads.",
};

/* ---- all of it ---- */

static status report_pieces(const export_request *a, const export_kind *kind,
                            const piece_info *info, double seconds) {
    const bool mesh = a->pieces->solid, loose = a->pieces->loose;
    const char *cells = mesh ? kind->cells : "triangles";
    const unsigned long long vertices = info->vertices, count = info->cells;
    if (a->common.json)
        return cli_print_json(&a->common,
                              json_pack("{s:s, s:s, s:I, s:I, s:f}", "output", a->common.output,
                                        "format", a->pieces->name, "vertices", (json_int_t)vertices,
                                        cells, (json_int_t)count, "seconds", seconds));
    if (!mesh && !kind->given && info->cells == 0)
        cli_note(&a->common, 1, "there is no such surface: the file has no triangles");
    if (export_request_to_stdout(a) || !cli_results(&a->common, true))
        return ST_OK;
    if (!loose)
        printf("vertices    %llu\n", vertices);
    printf("%-11s %llu\n", cells, count);
    printf("time        %.2f s\n", seconds);
    return ST_OK;
}

static const export_kind *const kinds[] = {&export_heights, &export_grid, &export_tets,
                                           &export_hexes, &export_triangles};

static bool is_of(const leaf_file *f, const export_kind *kind) {
    if (kind->told)
        return kind->told == leaf_teller_of(f);
    return kind->of ? kind->of == f->geometry : f->geometry->noded && f->geometry->noded->hexahedra;
}

/* Returns NULL for a kind that is not exported. */
static const export_kind *kind_of(const leaf_file *f) {
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (is_of(f, kinds[i]))
            return kinds[i];
    return NULL;
}

static unsigned use_of(const export_request *a, const export_kind *kind) {
    if (a->pieces && a->pieces->solid)
        return CELLS;
    return (a->pieces ? kind->given ? GIVEN : SURFACE : 0U) | (kind->samples ? LATTICE : 0U);
}

static status check_kind(const export_request *a, const leaf_file *f) {
    const export_kind *kind = kind_of(f);
    const char *path = a->common.input,
               *name = kind && kind->given ? "surface" : leaf_teller_of(f)->name;
    if (!kind)
        return status_describe(ST_UNSUPPORTED, "%s: its kind of geometry is not exported", path);
    if (a->samples && !kind->samples)
        return status_describe(ST_UNSUPPORTED, "%s: a %s, which has no samples of a grid: %s", path,
                               name, kind->instead);
    if (a->pieces && a->pieces->solid && !kind->cells)
        return status_describe(ST_UNSUPPORTED, "%s: a %s, which .%s is not for: %s", path, name,
                               a->pieces->name, kind->instead);
    char becomes[64];
    snprintf(becomes, sizeof becomes, "%sto become .%s",
             kind->given ? "a surface of triangles, " : "",
             a->samples ? a->samples->name : a->pieces->name);
    const status st = cli_check_uses(&a->common, uses, sizeof uses / sizeof *uses, use_of(a, kind),
                                     use_names, becomes);
    return st == ST_OK && use_of(a, kind) & SURFACE ? check_isosurface(a) : st;
}

static status export_pieces(export_request *a, mem *m, leaf_file *f, double start) {
    char name[64];
    text_name(name, sizeof name, f->header.name);
    piece_info info = {.name = name, .isovalues = a->iso_count};
    status st = kind_of(f)->pieces(a, m, f, &info);
    return st == ST_OK ? report_pieces(a, kind_of(f), &info, clock_seconds() - start) : st;
}

static status run(export_request *a) {
    if (export_request_to_stdout(a) && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "-o -: %s does not go to a terminal",
                               a->samples ? a->samples->name : a->pieces->name);
    if (export_request_to_stdout(a) && a->common.json)
        return status_describe(ST_USAGE, "-o -: --json would be in the output");
    mem m;
    mem_init(&m, a->common.memory ? a->common.memory : (uint64_t)MEMORY_DEFAULT_MIB << 20);
    const double start = clock_seconds();
    leaf_file *f = NULL;
    file_guard_watch();
    status st = file_guard_input(a->common.input);
    if (st == ST_OK)
        st = file_guard_output(a->common.output);
    if (st == ST_OK && export_request_is_folder(a))
        st = out_folder_check(a->common.output);
    else if (st == ST_OK && !export_request_to_stdout(a) && !export_request_is_sequence(a))
        st = out_file_check(&m, a->common.output, a->common.force);
    if (st == ST_OK)
        st = leaf_file_open(&m, a->common.input, &f);
    if (st == ST_OK)
        st = check_kind(a, f);
    a->given = st == ST_OK && kind_of(f)->given;
    if (st == ST_OK)
        st = a->samples ? kind_of(f)->samples(a, &m, f, start) : export_pieces(a, &m, f, start);
    leaf_file_close(f);
    return st;
}

int main(int argc, char **argv) {
    export_request a = {.common = {.verb = "export"}};
    cli_parse(&verb, &a.common, argc, argv);
    return cli_finish(&a.common, run(&a));
}
