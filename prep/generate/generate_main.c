/* leafcast generate - writes analytic test volumes as NRRD, or as meshes of tets. */
#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/clock.h"
#include "formats/base/num.h"
#include "formats/base/text.h"
#include "prep/generate/curvilinear_generate.h"
#include "prep/generate/generate.h"
#include "prep/generate/plant_generate.h"
#include "prep/generate/tet_generate.h"

typedef struct arguments {
    cli_common common;
    const field_info *info;
    uint32_t dims[3];
    sample_type type;
    int64_t seed;
    bool seed_given;
    double spacing[3];
    bool tets, typed; /* typed: --type was given */
    bool spaced;      /* --spacing was given */
    bool curved;      /* a curvilinear grid, of this shape */
    curvilinear_shape shape;
    uint32_t copies[3];
    double deform;
    uint32_t steps;
    bool plant, shaped; /* FIELD is "plant"; shaped: --shape was given */
    plant_shape growth;
    uint32_t triangles; /* of a plant */
} arguments;

enum {
    KEY_DIMS = 0x2000,
    KEY_TYPE,
    KEY_SEED,
    KEY_SPACING,
    KEY_TETS,
    KEY_CURVILINEAR,
    KEY_DEFORM,
    KEY_REPLICATE,
    KEY_STEPS,
    KEY_SHAPE
};
enum { STEPS_MAX = 10000 };

static const struct argp_option options[] = {
    {"dims", KEY_DIMS, "N[,N,N]", CLI_BASIC, "samples per axis", 1},
    {"type", KEY_TYPE, "TYPE", CLI_BASIC, "u8 (default), u16 or f32", 1},
    {"seed", KEY_SEED, "S", CLI_BASIC,
     "seed of noise, attractor, drop, jets, vortex and plants (default 1)", 1},
    {"spacing", KEY_SPACING, "S[,S,S]", CLI_BASIC, "distance of samples (default 1)", 1},
    {"steps", KEY_STEPS, "N", CLI_BASIC,
     "a series of N files: F_0000.nrrd, ..., or as %04d in -o says. drop, jets and vortex go from "
     "time 0 to 1 (without: 0); of --tets, --deform swings to and fro",
     1},
    {"curvilinear", KEY_CURVILINEAR, "SHAPE", CLI_BASIC,
     "a curvilinear grid with f32 values as VTK (.vts): warp (a box that sways), annulus (around "
     "an "
     "axis, closed) or twisted (a box)",
     1},
    {"shape", KEY_SHAPE, "SHAPE", CLI_BASIC,
     "of a plant: conifer (default), broadleaf, bush or grass", 1},
    {NULL, 0, NULL, 0, "Meshes:", 2},
    {"tets", KEY_TETS, NULL, CLI_BASIC,
     "a mesh stream of tets, six to a cell of the samples' grid, with f32 values", 2},
    {"deform", KEY_DEFORM, "AMOUNT", 0,
     "swirl the inner points, and surfaces with them: no edge of a cell changes by more than "
     "AMOUNT "
     "(0 .. 0.9) of its length, no tet turns over, the box stays",
     2},
    {"replicate", KEY_REPLICATE, "N[,N,N]", 0,
     "copies along each axis, side by side, each with points of its own", 2},
    {NULL, 0, NULL, 0, NULL, 0}};

static status set_counts(const char *text, const char *what, uint32_t lo, uint32_t hi,
                         uint32_t out[3]) {
    int count = 0;
    status st = cli_dims_or_one(text, what, lo, hi, out, &count);
    if (st == ST_OK && count == 1)
        out[1] = out[2] = out[0];
    return st;
}

static status set_spacing(arguments *a, const char *text) {
    const int count = text[strcspn(text, ", ")] ? 3 : 1;
    status st = num_doubles(text, "--spacing", ", ", count, a->spacing);
    if (st == ST_OK && count == 1)
        a->spacing[1] = a->spacing[2] = a->spacing[0];
    return st;
}

static status set_deform(arguments *a, const char *text) {
    status st = num_double(text, "--deform", &a->deform);
    if (st == ST_OK && !(a->deform > 0 && a->deform <= TET_LATTICE_DEFORM_MAX))
        st = status_describe(ST_USAGE, "--deform: \"%s\": expected a number above 0, at most %g",
                             text, TET_LATTICE_DEFORM_MAX);
    return st;
}

static status set_type(arguments *a, const char *name) {
    a->typed = true;
    if (sample_parse(name, &a->type) &&
        (a->type == SAMPLE_U8 || a->type == SAMPLE_U16 || a->type == SAMPLE_F32))
        return ST_OK;
    return status_describe(ST_USAGE, "--type: \"%s\" is not one of u8, u16, f32", name);
}

static status set_shape(arguments *a, const char *text) {
    a->curved = curvilinear_shape_find(text, &a->shape);
    return a->curved
               ? ST_OK
               : status_describe(ST_USAGE,
                                 "--curvilinear: \"%s\" is none of warp, annulus, twisted", text);
}

static status set_growth(arguments *a, const char *text) {
    a->shaped = true;
    if (plant_shape_find(text, &a->growth))
        return ST_OK;
    return status_describe(ST_USAGE, "--shape: \"%s\" is none of %s", text, plant_shape_names());
}

static status set_option(void *own, int key, const char *text) {
    arguments *a = own;
    switch (key) {
    case KEY_DIMS: return set_counts(text, "--dims", 2, GRID_DIM_MAX, a->dims);
    case KEY_TYPE: return set_type(a, text);
    case KEY_SEED: a->seed_given = true; return num_int(text, "--seed", 0, INT64_MAX, &a->seed);
    case KEY_SPACING: a->spaced = true; return set_spacing(a, text);
    case KEY_TETS: a->tets = true; return ST_OK;
    case KEY_CURVILINEAR: return set_shape(a, text);
    case KEY_SHAPE: return set_growth(a, text);
    case KEY_DEFORM: return set_deform(a, text);
    case KEY_REPLICATE: return set_counts(text, "--replicate", 1, TET_LATTICE_CELLS_MAX, a->copies);
    case KEY_STEPS: return cli_uint(text, "--steps", 1, STEPS_MAX, &a->steps);
    default: return ST_AGAIN;
    }
}

static status find_field(arguments *a) {
    if (!a->common.input)
        return ST_OK;
    a->plant = strcmp(a->common.input, "plant") == 0;
    a->info = field_find(a->common.input);
    if (a->info || a->plant)
        return ST_OK;
    return status_describe(ST_USAGE, "no field \"%s\"; --help lists them", a->common.input);
}

/* A series has something that differs from step to step. */
static status check_steps(const arguments *a) {
    char names[256] = "";
    const field_info *info;
    if (a->steps == 0 || a->info->timed || a->deform > 0)
        return ST_OK;
    for (size_t i = 0; (info = field_at(i)) != NULL; i++)
        if (info->timed)
            text_add(names, sizeof names, "%s%s", names[0] ? ", " : "", info->name);
    return status_describe(ST_USAGE, "--steps: %s is the same at any time; these change: %s%s",
                           a->info->name, names,
                           a->tets ? "; or --deform says how much the mesh moves" : "");
}

/* A plant has a shape and a seed. */
static status check_plant(const arguments *a) {
    if (!a->common.output)
        return status_describe(ST_USAGE, "plant: -o is needed");
    if (a->dims[0] || a->typed || a->spaced || a->tets || a->curved || a->copies[0] ||
        a->deform > 0 || a->steps > 0)
        return status_describe(ST_USAGE, "plant: it takes --shape and --seed, and nothing of "
                                         "samples and meshes");
    return ST_OK;
}

/* Refuse options that do not go together. */
static status check(void *own) {
    arguments *a = own;
    status st = find_field(a);
    if (st != ST_OK)
        return st;
    if (a->plant)
        return check_plant(a);
    if (a->shaped)
        return status_describe(ST_USAGE, "--shape is of a plant");
    if (!a->info || !a->dims[0] || !a->common.output)
        return status_describe(ST_USAGE, "a FIELD, --dims and -o are needed");
    if (!a->tets && (a->deform > 0 || a->copies[0] > 0))
        return status_describe(ST_USAGE, "--deform and --replicate are for meshes: --tets");
    if (a->tets && a->curved)
        return status_describe(ST_USAGE, "either --tets or --curvilinear");
    if (a->curved && a->spaced)
        return status_describe(ST_USAGE, "--spacing: a shape of --curvilinear has its own size");
    if ((a->tets || a->curved) && a->typed && a->type != SAMPLE_F32)
        return status_describe(ST_USAGE, "--type: the values of --%s are f32",
                               a->tets ? "tets" : "curvilinear");
    if (a->seed_given && !a->info->seeded)
        return status_describe(ST_USAGE, "--seed: %s is the same for any", a->info->name);
    st = check_steps(a);
    if (st != ST_OK)
        return st;
    if (a->steps > 0 && strcmp(a->common.output, "-") == 0)
        return status_describe(ST_USAGE, "-o -: --steps makes a file of each step");
    return ST_OK;
}

/* The help's text, with the table of fields. */
static const char *describe(void) {
    static char text[4096] =
        "Write an analytic test volume as NRRD, with --tets as a mesh, or with --curvilinear as a "
        "curvilinear grid (-o -: to standard output). It is streamed, never held whole; the same "
        "arguments give the same bytes on "
        "any machine.\vExample:\n  leafcast generate gyroid --dims 256 -o gyroid.nrrd\n\n"
        "Fields (their values; u8 and u16 map the given range to all of theirs):\n";
    const field_info *info;
    for (size_t i = 0; (info = field_at(i)) != NULL; i++)
        text_add(text, sizeof text, "  %-15s %s\n", info->name, info->about);
    text_add(text, sizeof text, "  %-15s %s\n", "plant",
             "no field: a plant of triangles, to be placed in scenes");
    return text;
}

static const output_kind *output(const void *own) {
    static const output_kind samples = {
        .what = "NRRD", .suffixes = ".nrrd ", .instead = OUTPUT_BY_EXPORT};
    static const output_kind series = {
        .what = "NRRDs", .suffixes = ".nrrd ", .instead = OUTPUT_BY_EXPORT, .sequence = true};
    static const output_kind mesh = {
        .what = "a mesh stream", .suffixes = ".mesh ", .instead = OUTPUT_BY_EXPORT};
    static const output_kind meshes = {.what = "mesh streams",
                                       .suffixes = ".mesh ",
                                       .instead = OUTPUT_BY_EXPORT,
                                       .sequence = true};
    static const output_kind curved = {.what = "a curvilinear grid of VTK", .suffixes = ".vts "};
    static const output_kind curved_series = {
        .what = "curvilinear grids of VTK", .suffixes = ".vts ", .sequence = true};
    static const output_kind surface = {.what = "a surface as PLY", .suffixes = ".ply "};
    const arguments *a = own;
    if (a->plant)
        return &surface;
    if (a->curved)
        return a->steps > 0 ? &curved_series : &curved;
    if (a->steps > 0)
        return a->tets ? &meshes : &series;
    return a->tets ? &mesh : &samples;
}

static cli_verb verb = {
    .options = options,
    .set_option = set_option,
    .check = check,
    .output = output,
    .input = "FIELD",
    .args_doc = "FIELD --dims N[,N,N] -o F.nrrd\nFIELD --tets --dims N[,N,N] -o F.mesh\n"
                "FIELD --curvilinear SHAPE --dims N[,N,N] -o F.vts\nplant -o F.ply",
};

static grid make_grid(const arguments *a) {
    grid g;
    grid_init(&g, a->dims, a->type);
    for (int c = 0; c < 3; c++)
        g.to_world[c][c] = a->spacing[c];
    snprintf(g.name, sizeof g.name, "%s", a->info->name);
    return g;
}

static status run_tets(arguments *a, mem *m) {
    tet_generate_options how = {.info = a->info,
                                .seed = (uint64_t)a->seed,
                                .shape = {.copies = {1, 1, 1}, .deform = a->deform},
                                .threads = a->common.threads,
                                .steps = a->steps};
    memcpy(how.shape.dims, a->dims, sizeof a->dims);
    memcpy(how.shape.spacing, a->spacing, sizeof a->spacing);
    if (a->copies[0] > 0)
        memcpy(how.shape.copies, a->copies, sizeof a->copies);
    return tet_generate_files(m, &how, a->common.output, a->common.force, cli_progress(&a->common));
}

static status run_curved(arguments *a, mem *m) {
    curvilinear_generate_options how = {.info = a->info,
                                        .seed = (uint64_t)a->seed,
                                        .shape = a->shape,
                                        .threads = a->common.threads,
                                        .output = a->common.output,
                                        .force = a->common.force,
                                        .steps = a->steps};
    memcpy(how.dims, a->dims, sizeof a->dims);
    return curvilinear_generate(m, &how, cli_progress(&a->common));
}

static status run_grid(arguments *a, mem *m) {
    grid g = make_grid(a);
    const generate_options how = {.info = a->info,
                                  .seed = (uint64_t)a->seed,
                                  .threads = a->common.threads,
                                  .output = a->common.output,
                                  .force = a->common.force,
                                  .steps = a->steps};
    return generate_volume(m, &g, &how, cli_progress(&a->common));
}

static status run_plant(arguments *a, mem *m) {
    return plant_generate(m, a->growth, (uint64_t)a->seed, a->common.output, a->common.force,
                          &a->triangles);
}

static json_t *report_json(const arguments *a, double seconds) {
    if (a->plant)
        return json_pack("{s:s, s:s, s:s, s:I, s:I, s:f}", "output", a->common.output, "field",
                         "plant", "kind", "triangles", "triangles", (json_int_t)a->triangles,
                         "seed", (json_int_t)a->seed, "seconds", seconds);
    return json_pack("{s:s, s:s, s:s, s:[i,i,i], s:[f,f,f], s:s, s:I, s:f, s:I}", "output",
                     a->common.output, "field", a->info->name, "kind",
                     a->tets     ? "tets"
                     : a->curved ? "curvilinear"
                                 : "grid",
                     "dims", (int)a->dims[0], (int)a->dims[1], (int)a->dims[2], "spacing",
                     a->spacing[0], a->spacing[1], a->spacing[2], "type",
                     sample_name(a->tets || a->curved ? SAMPLE_F32 : a->type), "seed",
                     (json_int_t)a->seed, "seconds", seconds, "steps",
                     (json_int_t)(a->steps ? a->steps : 1));
}

static status run(arguments *a) {
    if (strcmp(a->common.output, "-") == 0 && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "-o -: samples do not go to a terminal");
    mem m;
    mem_init(&m, a->common.memory);
    const double start = clock_seconds();
    status st = a->plant    ? run_plant(a, &m)
                : a->tets   ? run_tets(a, &m)
                : a->curved ? run_curved(a, &m)
                            : run_grid(a, &m);
    if (st == ST_OK && a->common.json)
        st = cli_print_json(&a->common, report_json(a, clock_seconds() - start));
    return st;
}

int main(int argc, char **argv) {
    arguments a = {
        .common = {.verb = "generate"}, .type = SAMPLE_U8, .seed = 1, .spacing = {1, 1, 1}};
    verb.doc = describe();
    cli_parse(&verb, &a.common, argc, argv);
    return cli_finish(&a.common, run(&a));
}
