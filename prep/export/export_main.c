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
#include "prep/export/grid_slices.h"
#include "prep/export/grid_surface.h"
#include "prep/export/piece_export.h"
#include "prep/export/sample_format.h"
#include "prep/export/sample_stream.h"
#include "prep/export/slice_files.h"
#include "prep/export/tet_pieces.h"
#include "prep/export/tet_surface.h"

enum {
    MEMORY_DEFAULT_MIB = 2048,
    ISOS_MAX = 64,
    FIELDS_MAX = 64,
    ALL_MAX = 1024,
    PIECE_BYTES = 1 << 20
};

typedef struct arguments {
    cli_common common;
    const char *format_name;
    const sample_format *samples; /* exactly one of the two is set */
    const piece_format *pieces;
    bool gzip;
    uint32_t level, box[6];
    double isos[ISOS_MAX];
    uint32_t iso_count;
    bool floats;
    const char *fields[FIELDS_MAX];
    uint32_t field_count, step;
    bool all_steps;
} arguments;

enum { KEY_FORMAT = 0x2000, KEY_BOX, KEY_LEVEL, KEY_ISO, KEY_FLOATS, KEY_FIELD, KEY_STEP };

/* What can be exported. */
enum { SAMPLES = 1, GRID_SURFACE = 2, MESH_SURFACE = 4, MESH = 8 };
static const char *const use_names[] = {[SAMPLES | GRID_SURFACE] = "grids",
                                        [GRID_SURFACE | MESH_SURFACE] = "isosurfaces"};
static const cli_use uses[] = {{KEY_BOX, SAMPLES | GRID_SURFACE},
                               {KEY_LEVEL, SAMPLES | GRID_SURFACE},
                               {KEY_ISO, GRID_SURFACE | MESH_SURFACE},
                               {KEY_FLOATS, GRID_SURFACE | MESH_SURFACE}};

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
     "this one; may be repeated for .vdb and .vtu (default: there all, else the first)", 4},
    {"step", KEY_STEP, "K|all", CLI_BASIC,
     "of time steps this one, from 0 on (0); all: one .nii or .zarr of four axes", 4},
    {NULL, 0, NULL, 0, NULL, 0}};

/* ---- options ---- */

static status set_box(arguments *a, const char *text) {
    double numbers[6];
    status st = num_doubles(text, "--box", ", ", 6, numbers);
    for (int i = 0; i < 6 && st == ST_OK; i++) {
        if (!(numbers[i] >= 0 && numbers[i] <= GRID_DIM_MAX && numbers[i] == floor(numbers[i])))
            return status_describe(ST_USAGE, "--box: \"%s\": expected six numbers of samples",
                                   text);
        a->box[i] = (uint32_t)numbers[i];
    }
    return st;
}

static status add_iso(arguments *a, const char *text) {
    if (a->iso_count == ISOS_MAX)
        return status_describe(ST_USAGE, "more than %d isovalues", ISOS_MAX);
    double *iso = &a->isos[a->iso_count++];
    status st = cli_finite(text, "--iso", -HUGE_VAL, HUGE_VAL, iso);
    for (uint32_t i = 0; st == ST_OK && i + 1 < a->iso_count; i++)
        if (a->isos[i] == *iso)
            st = status_describe(ST_USAGE, "--iso %s: given twice", text);
    return st;
}

static status add_field(arguments *a, const char *name) {
    if (a->field_count == FIELDS_MAX)
        return status_describe(ST_USAGE, "more than %d fields by name", FIELDS_MAX);
    a->fields[a->field_count++] = name;
    return ST_OK;
}

static status set_format(arguments *a, const char *name) {
    int index;
    a->format_name = name;
    return cli_word(name, "--format", options[0].arg, &index);
}

static status set_step(arguments *a, const char *text) {
    a->all_steps = strcmp(text, "all") == 0;
    a->step = 0;
    return a->all_steps ? ST_OK : cli_uint(text, "--step", 0, LEAF_SETS_MAX, &a->step);
}

static status set_option(void *own, int key, const char *text) {
    arguments *a = own;
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

static bool is_meant(const arguments *a, const char *name, const char *suffix, const char *path) {
    return a->format_name ? strcmp(a->format_name, name) == 0
                          : suffix && text_ends_in(path, suffix);
}

/* Find the format by --format, or by the output's suffix. A .gz behind that packs a streamed
 * format. */
static status find_format(arguments *a) {
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

static status check_surface(const arguments *a) {
    if (a->iso_count == 0)
        return status_describe(ST_USAGE, "which isosurface? --iso says it; leafcast info suggests "
                                         "isovalues");
    if (a->pieces->loose && a->floats)
        return status_describe(ST_USAGE, "--floats: .%s has no other", a->pieces->name);
    if (a->pieces->loose && a->iso_count > 1)
        return status_describe(ST_USAGE, "--iso: .%s cannot tell several isosurfaces apart",
                               a->pieces->name);
    if (a->field_count > 1)
        return status_describe(ST_USAGE, "--field: an isosurface is of one field");
    return ST_OK;
}

static status check(void *own) {
    arguments *a = own;
    if (!a->common.input || !a->common.output)
        return status_describe(ST_USAGE, "a treelet file and -o are needed");
    status st = find_format(a);
    return st == ST_OK && a->pieces && a->pieces->corners == 3 ? check_surface(a) : st;
}

/* All suffixes of the format, packed ones too. A format known by name alone has those of its
 * relatives (nifti2: .nii).
 */
static const output_kind *output(const void *own) {
    static char suffixes[64];
    static output_kind kind = {.suffixes = suffixes};
    const arguments *a = own;
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
                "F.leaf --iso V -o FILE.ply|.stl|.vtp\nF.leaf -o FILE.vtu",
    .doc =
        "Write what is in a treelet file to another format: the samples of a grid, isosurfaces of "
        "a grid or a mesh, or a mesh (-o -: to standard output, --format says what)."
        "\vExample:\n"
        "  leafcast export head.leaf --iso 1150 -o skull.ply\v"
        "Samples come out as they went in, to the bit, unless their type was not kept (u32, i32, "
        "f64). What a format cannot hold is refused. Names that end in .gz are packed; "
        "slice_%04d.tif is a file a slice. Surfaces are welded; their vertices lie on the "
        "interpolant's surface. Memory stays below "
        "--memory (default 2G); what does not fit goes to temporary files beside the output (-o "
        "-: in $TMPDIR). The output's bytes depend on neither --memory nor --threads.",
};

static bool to_stdout(const arguments *a) {
    return strcmp(a->common.output, "-") == 0;
}

/* ---- fields and steps ---- */

static status find_field(const leaf_file *f, const char *name, uint32_t *index) {
    for (*index = 0; *index < f->header.fields; ++*index)
        if (strcmp(f->names[*index], name) == 0)
            return ST_OK;
    return status_describe(ST_USAGE, "--field %s: there is none; the first is %s", name,
                           f->names[0]);
}

static status check_step(const arguments *a, const leaf_file *f) {
    if (a->step < f->header.steps)
        return ST_OK;
    return status_describe(ST_USAGE, "--step %u: there are %u steps, from 0 on", a->step,
                           f->header.steps);
}

/* Returns whether one file of the format holds several fields. */
static bool takes_all(const arguments *a) {
    return a->samples ? a->samples->fields : a->pieces->corners == 4;
}

/* The fields that are named, or all, or the first. fields: room for all of them. */
static status choose_fields(const arguments *a, const leaf_file *f, uint32_t *fields,
                            uint32_t *count) {
    status st = ST_OK;
    *count = a->field_count ? a->field_count : takes_all(a) ? f->header.fields : 1;
    if (*count > 1 && !takes_all(a))
        return status_describe(ST_USAGE, "--field: %s are of one field",
                               a->samples ? "samples" : "surfaces");
    if (*count > ALL_MAX)
        return status_describe(ST_UNSUPPORTED,
                               "%s: %u fields: more than %d are not exported at once, "
                               "--field says which",
                               a->common.input, *count, ALL_MAX);
    for (uint32_t i = 0; i < *count && st == ST_OK; i++) {
        fields[i] = i;
        if (a->field_count)
            st = find_field(f, a->fields[i], &fields[i]);
    }
    return st;
}

/* Make names that VTK files can have: unique and not empty. */
static void name_fields(const leaf_file *f, const uint32_t *fields, uint32_t count,
                        char (*names)[80], const char **list) {
    for (uint32_t i = 0; i < count; i++) {
        char own[64];
        text_name(own, sizeof own, f->names[fields[i]]);
        snprintf(names[i], sizeof names[i], "%s", own[0] ? own : "value");
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(names[k], names[i]) == 0)
                snprintf(names[i], sizeof names[i], "%s (field %u)", own[0] ? own : "value",
                         fields[i]);
        list[i] = names[i];
    }
}

/* The chosen fields with their names. */
typedef struct field_list {
    uint32_t *fields, *sets; /* sets: of each field at the step, or of the first field at all
                                steps */
    char (*texts)[80];
    const char **names;
    uint32_t count;
} field_list;

/* The sets of one field at all steps. */
static status list_steps(mem *m, const leaf_file *f, field_list *l) {
    mem_free(m, l->sets);
    l->sets = mem_array(m, f->header.steps, sizeof *l->sets);
    if (!l->sets)
        return ST_NOMEM;
    l->count = f->header.steps;
    for (uint32_t i = 0; i < l->count; i++)
        l->sets[i] = leaf_layout_set(&f->layout, l->fields[0], i);
    return ST_OK;
}

static status list_fields(const arguments *a, mem *m, const leaf_file *f, field_list *l) {
    const uint32_t most = f->header.fields + a->field_count;
    *l = (field_list){.fields = mem_array(m, most, sizeof *l->fields),
                      .sets = mem_array(m, most, sizeof *l->sets),
                      .texts = mem_array(m, most, sizeof *l->texts),
                      .names = mem_array(m, most, sizeof *l->names)};
    status st = l->fields && l->sets && l->texts && l->names ? ST_OK : ST_NOMEM;
    if (st == ST_OK)
        st = check_step(a, f);
    if (st == ST_OK)
        st = choose_fields(a, f, l->fields, &l->count);
    if (st == ST_OK)
        name_fields(f, l->fields, l->count, l->texts, l->names);
    for (uint32_t i = 0; i < l->count && st == ST_OK; i++)
        l->sets[i] = leaf_layout_set(&f->layout, l->fields[i], a->step);
    return st == ST_OK && a->all_steps ? list_steps(m, f, l) : st;
}

static void release_fields(mem *m, field_list *l) {
    mem_free(m, l->fields);
    mem_free(m, l->sets);
    mem_free(m, l->texts);
    mem_free(m, l->names);
}

/* The part of a grid to export, of its first chosen field. */
static status choose_part(const arguments *a, const leaf_file *f, uint32_t field, grid_part *part) {
    status st = grid_part_of(f, a->level, cli_given(&a->common, KEY_BOX) ? a->box : NULL, part);
    part->set = leaf_layout_set(&f->layout, field, a->step < f->header.steps ? a->step : 0);
    return st == ST_OK ? check_step(a, f) : st;
}

/* ---- samples ---- */

static bool is_sequence(const arguments *a) {
    return a->samples && a->samples->slices && strchr(a->common.output, '%');
}

static bool is_folder(const arguments *a) {
    return a->samples && a->samples->folder;
}

static status write_slices(const arguments *a, mem *m, const sample_export *e, const grid *g) {
    slice_files *files = NULL;
    status st = slice_files_create(m, e->path, e->force, a->samples, g, &files);
    if (st == ST_OK)
        st = grid_slices_run(m, e->f, e->part, e->threads, e->p, slice_files_take, files);
    return slice_files_end(files, st);
}

static status write_samples(const arguments *a, mem *m, const sample_export *e, const grid *g) {
    if (a->samples->write)
        return a->samples->write(m, e);
    return is_sequence(a) ? write_slices(a, m, e, g)
                          : sample_stream_write(m, a->samples, e, g, a->gzip);
}

static status report_samples(const arguments *a, const grid *g, uint32_t steps, double seconds) {
    if (a->common.json)
        return cli_print_json(
            &a->common,
            json_pack("{s:s, s:s, s:[i,i,i], s:s, s:i, s:f}", "output", a->common.output, "format",
                      a->samples->name, "dims", (int)g->dims[0], (int)g->dims[1], (int)g->dims[2],
                      "type", sample_name(g->type), "steps", (int)steps, "seconds", seconds));
    if (to_stdout(a) || !cli_results(&a->common, true))
        return ST_OK;
    printf("samples     %u x %u x %u %s, little endian, as %s\n", g->dims[0], g->dims[1],
           g->dims[2], sample_name(g->type), a->samples->name);
    if (steps > 1)
        printf("steps       %u\n", steps);
    printf("time        %.2f s\n", seconds);
    return ST_OK;
}

/* Tell what the file will not keep, and set the name of its array. */
static void settle_head(const arguments *a, const char *field, const sample_times *times, grid *g) {
    const char *lost[] = {a->samples->loses ? a->samples->loses(g) : NULL,
                          a->all_steps ? a->samples->loses_times(times) : NULL};
    for (int i = 0; i < 2; i++)
        if (lost[i])
            cli_note(&a->common, 1, "%s: %s", a->common.output, lost[i]);
    if (a->samples->named && field[0])
        text_name(g->name, sizeof g->name, field);
}

static status export_samples(arguments *a, mem *m, leaf_file *f, double start) {
    grid_part part;
    grid g = {.dims = {0}};
    field_list fields;
    const sample_times times = sample_times_of(f, a->all_steps);
    status st = list_fields(a, m, f, &fields);
    if (st == ST_OK)
        st = choose_part(a, f, fields.fields[0], &part);
    if (st == ST_OK)
        st = grid_part_describe(m, f, &part, &g);
    if (st == ST_OK && a->samples->check)
        st = a->samples->check(&g);
    if (st == ST_OK)
        settle_head(a, f->names[fields.fields[0]], &times, &g);
    if (st == ST_OK)
        st = write_samples(a, m,
                           &(sample_export){.f = f,
                                            .part = &part,
                                            .sets = fields.sets,
                                            .names = fields.names,
                                            .count = fields.count,
                                            .times = &times,
                                            .path = a->common.output,
                                            .force = a->common.force,
                                            .threads = a->common.threads,
                                            .p = cli_progress(&a->common)},
                           &g);
    if (st == ST_OK)
        st = report_samples(a, &g, times.steps, clock_seconds() - start);
    grid_release(&g, m);
    release_fields(m, &fields);
    return st;
}

/* ---- surfaces and meshes ---- */

static status report_pieces(const arguments *a, const piece_info *info, double seconds) {
    const bool mesh = a->pieces->corners == 4, loose = a->pieces->loose;
    const char *cells = mesh ? "tets" : "triangles";
    const unsigned long long vertices = info->vertices, count = info->cells;
    if (a->common.json)
        return cli_print_json(&a->common,
                              json_pack("{s:s, s:s, s:I, s:I, s:f}", "output", a->common.output,
                                        "format", a->pieces->name, "vertices", (json_int_t)vertices,
                                        cells, (json_int_t)count, "seconds", seconds));
    if (!mesh && info->cells == 0)
        cli_note(&a->common, 1, "there is no such surface: the file has no triangles");
    if (to_stdout(a) || !cli_results(&a->common, true))
        return ST_OK;
    if (!loose)
        printf("vertices    %llu\n", vertices);
    printf("%-11s %llu\n", cells, count);
    printf("time        %.2f s\n", seconds);
    return ST_OK;
}

/* Reduce the threads until their needs take at most half of the free budget. */
static int threads_for(const arguments *a, const mem *m, uint64_t each) {
    int threads = a->common.threads;
    while (m->limit && threads > 1 &&
           2 * (uint64_t)threads * (each + PIECE_BYTES) > m->limit - mem_used(m))
        threads--;
    return threads;
}

static status write_pieces(arguments *a, mem *m, const piece_source *source, int threads,
                           piece_info *info) {
    char *beside = NULL;
    status st = out_file_scratch_path(m, a->common.output, "leafcast-export", &beside);
    const piece_export e = {.source = source,
                            .format = a->pieces,
                            .path = a->common.output,
                            .beside = beside,
                            .force = a->common.force,
                            .threads = threads,
                            .p = cli_progress(&a->common)};
    info->floats |= a->floats || a->pieces->loose;
    if (st == ST_OK)
        st = piece_export_run(m, &e, info);
    mem_free(m, beside);
    return st;
}

static status export_grid_surface(arguments *a, mem *m, leaf_file *f, piece_info *info) {
    grid_part part;
    grid_surface *s = NULL;
    uint32_t field = 0;
    status st = a->field_count ? find_field(f, a->fields[0], &field) : ST_OK;
    const int threads = threads_for(a, m, grid_surface_worker(f));
    if (st == ST_OK)
        st = choose_part(a, f, field, &part);
    if (st == ST_OK)
        st = grid_surface_create(m, f, &part, a->isos, a->iso_count, threads, &s);
    if (st == ST_OK) {
        const piece_source source = grid_surface_source(s);
        st = write_pieces(a, m, &source, threads, info);
    }
    grid_surface_destroy(s);
    return st;
}

static status export_mesh_surface(arguments *a, mem *m, const tet_choice *choice,
                                  piece_info *info) {
    tet_surface *s = NULL;
    const int threads = threads_for(a, m, tet_surface_worker(choice));
    status st = tet_surface_create(m, choice, a->isos, a->iso_count, threads, &s);
    if (st == ST_OK) {
        const piece_source source = tet_surface_source(s);
        st = write_pieces(a, m, &source, threads, info);
    }
    tet_surface_destroy(s);
    return st;
}

static status export_tets(arguments *a, mem *m, const tet_choice *choice, piece_info *info) {
    tet_pieces *s = NULL;
    const leaf_header *h = &choice->f->header;
    const int threads = threads_for(a, m, tet_bench_bytes(choice));
    info->floats = true;
    status st = tet_pieces_create(m, choice, threads, &s);
    if (st == ST_OK) {
        const piece_source source = tet_pieces_source(s);
        st = write_pieces(a, m, &source, threads, info);
    }
    tet_pieces_destroy(s);
    if (st == ST_OK && info->vertices < h->vertices)
        cli_note(&a->common, 1,
                 "%llu vertices lay on others, with the same values, and are one now",
                 (unsigned long long)(h->vertices - info->vertices));
    return st;
}

static status export_mesh(arguments *a, mem *m, leaf_file *f, piece_info *info) {
    const bool surface = a->pieces->corners == 3;
    double time = leaf_file_step_time(f, a->step < f->header.steps ? a->step : 0);
    field_list fields;
    status st = list_fields(a, m, f, &fields);
    if (st == ST_OK) {
        const tet_choice choice = {.f = f,
                                   .fields = fields.fields,
                                   .count = fields.count,
                                   .step = a->step,
                                   .gradients = surface};
        info->fields = fields.names;
        info->field_count = fields.count;
        info->time = f->header.steps > 1 && !surface ? &time : NULL;
        st = surface ? export_mesh_surface(a, m, &choice, info) : export_tets(a, m, &choice, info);
    }
    release_fields(m, &fields);
    return st;
}

/* ---- all of it ---- */

static unsigned use_of(const arguments *a, const leaf_file *f) {
    if (a->samples)
        return SAMPLES;
    if (a->pieces->corners == 4)
        return MESH;
    return f->mesh ? MESH_SURFACE : GRID_SURFACE;
}

static status check_kind(const arguments *a, const leaf_file *f) {
    const char *path = a->common.input;
    if (a->samples && f->mesh)
        return status_describe(
            ST_UNSUPPORTED,
            "%s: a mesh, which has no samples of a grid: leafcast resample makes "
            "some, or export it as .vtu",
            path);
    if (a->pieces && a->pieces->corners == 4 && !f->mesh)
        return status_describe(ST_UNSUPPORTED, "%s: a grid, which .%s is not for: try .vti", path,
                               a->pieces->name);
    char becomes[32];
    snprintf(becomes, sizeof becomes, "to become .%s",
             a->samples ? a->samples->name : a->pieces->name);
    return cli_check_uses(&a->common, uses, sizeof uses / sizeof *uses, use_of(a, f), use_names,
                          becomes);
}

static status export_pieces(arguments *a, mem *m, leaf_file *f, double start) {
    char name[64];
    text_name(name, sizeof name, f->header.name);
    piece_info info = {.name = name, .isovalues = a->iso_count};
    status st = f->mesh ? export_mesh(a, m, f, &info) : export_grid_surface(a, m, f, &info);
    return st == ST_OK ? report_pieces(a, &info, clock_seconds() - start) : st;
}

static status run(arguments *a) {
    if (to_stdout(a) && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "-o -: %s does not go to a terminal",
                               a->samples ? a->samples->name : a->pieces->name);
    if (to_stdout(a) && a->common.json)
        return status_describe(ST_USAGE, "-o -: --json would be in the output");
    mem m;
    mem_init(&m, a->common.memory ? a->common.memory : (uint64_t)MEMORY_DEFAULT_MIB << 20);
    const double start = clock_seconds();
    leaf_file *f = NULL;
    file_guard_watch();
    status st = file_guard_input(a->common.input);
    if (st == ST_OK)
        st = file_guard_output(a->common.output);
    if (st == ST_OK && is_folder(a))
        st = out_folder_check(a->common.output);
    else if (st == ST_OK && !to_stdout(a) && !is_sequence(a))
        st = out_file_check(&m, a->common.output, a->common.force);
    if (st == ST_OK)
        st = leaf_file_open(&m, a->common.input, &f);
    if (st == ST_OK)
        st = check_kind(a, f);
    if (st == ST_OK)
        st = a->samples ? export_samples(a, &m, f, start) : export_pieces(a, &m, f, start);
    leaf_file_close(f);
    return st;
}

int main(int argc, char **argv) {
    arguments a = {.common = {.verb = "export"}};
    cli_parse(&verb, &a.common, argc, argv);
    return cli_finish(&a.common, run(&a));
}
