/* leafcast resample - resamples a mesh or a curvilinear grid on a regular grid. */
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/clock.h"
#include "formats/base/num.h"
#include "formats/curvilinear_options.h"
#include "formats/grid/nrrd_writer.h"
#include "formats/trust_options.h"
#include "prep/resample/resample.h"
#include "prep/resample/resample_cells.h"
#include "prep/resample/resample_input.h"

enum { MEMORY_DEFAULT_MIB = 2048 };

typedef struct arguments {
    cli_common common;
    resample_source source;
    resample_wish wish;
    int64_t step; /* of a treelet file; -1: not given */
} arguments;

enum {
    KEY_DIMS = 0x2000,
    KEY_SPACING,
    KEY_BOUNDS,
    KEY_FIELD,
    KEY_COMPONENT,
    KEY_CELLS_TO_POINTS,
    KEY_BY_CORNERS,
    KEY_WHOLE_CELLS,
    KEY_STEP,
    KEY_EXAGGERATE
};

static const struct argp_option options[] = {
    {"dims", KEY_DIMS, "N[,N,N]", CLI_BASIC,
     "nodes per axis; one number: along the longest edge, the others so that cells are about "
     "cubes. Default: about as many nodes as the mesh has vertices",
     1},
    {"spacing", KEY_SPACING, "S", CLI_BASIC, "distance of nodes along each axis, instead of --dims",
     1},
    {"bounds", KEY_BOUNDS, "X0,Y0,Z0,X1,Y1,Z1", CLI_BASIC,
     "the box to resample (default: the mesh's)", 1},
    {NULL, 0, NULL, 0, "What of the mesh:", 2},
    {"field", KEY_FIELD, "NAME", CLI_BASIC, "the array to take (default: the first of the points)",
     2},
    {"step", KEY_STEP, "K", CLI_BASIC, "of several time steps this one, from 0 on (0)", 2},
    {"component", KEY_COMPONENT, "N", 0, "of vectors: 1, 2, ..; default: their magnitude", 2},
    {"cells-to-points", KEY_CELLS_TO_POINTS, NULL, 0,
     "take an array of the cells, averaged to the points", 2},
    {"by-corners", KEY_BY_CORNERS, NULL, 0,
     "take cells of higher order as linear ones of their corners (default: refuse them)", 2},
    {"whole-cells", KEY_WHOLE_CELLS, NULL, CLI_BASIC,
     "interpolate in hexahedra, wedges and pyramids of a mesh (default: split them into tets)", 2},
    TRUST_OPTIONS(2),
    CURVILINEAR_OPTIONS(2),
    {"exaggerate", KEY_EXAGGERATE, "Z", 0, "with --to: factor on heights", 2},
    {NULL, 0, NULL, 0, NULL, 0}};

static status set_bounds(resample_wish *w, const char *text) {
    status st = num_doubles(text, "--bounds", ", ", 6, w->box);
    for (int a = 0; a < 3 && st == ST_OK; a++)
        if (!(w->box[a] < w->box[a + 3] && isfinite(w->box[a + 3] - w->box[a])))
            st = status_describe(
                ST_USAGE, "--bounds: \"%s\": expected the lower corner, then the upper one", text);
    w->bounded = true;
    return st;
}

static status set_component(resample_source *s, const char *text) {
    const status st = cli_int(text, "--component", 1, INT_MAX, &s->hints.mesh.component);
    s->hints.curvilinear.component = s->hints.mesh.component;
    return st;
}

static status set_option(void *own, int key, const char *text) {
    arguments *a = own;
    resample_source *s = &a->source;
    int count;
    switch (key) {
    case KEY_DIMS: return cli_dims_or_one(text, "--dims", 2, GRID_DIM_MAX, a->wish.dims, &count);
    case KEY_SPACING: return cli_positive(text, "--spacing", &a->wish.spacing);
    case KEY_BOUNDS: return set_bounds(&a->wish, text);
    case KEY_FIELD: s->hints.mesh.field = s->hints.curvilinear.field = text; return ST_OK;
    case KEY_COMPONENT: return set_component(s, text);
    case KEY_CELLS_TO_POINTS:
        s->hints.mesh.cells_to_points = s->hints.curvilinear.cells_to_points = true;
        return ST_OK;
    case KEY_BY_CORNERS: s->hints.mesh.by_corners = true; return ST_OK;
    case KEY_EXAGGERATE:
        return cli_positive(text, "--exaggerate", &s->hints.curvilinear.exaggerate);
    case KEY_WHOLE_CELLS: a->source.whole_cells = true; return ST_OK;
    case KEY_STEP: return num_int(text, "--step", 0, UINT32_MAX, &a->step);
    default: break;
    }
    const status st = trust_option(&s->hints.grid.trust, key);
    return st == ST_AGAIN ? curvilinear_option(&s->hints.curvilinear, key, text) : st;
}

static status check(void *own) {
    arguments *a = own;
    a->source.path = a->common.input;
    if (!a->source.path || !a->common.output)
        return status_describe(ST_USAGE, "an INPUT and -o are needed");
    if (a->wish.dims[0] > 0 && a->wish.spacing > 0)
        return status_describe(ST_USAGE, "either --dims or --spacing");
    return ST_OK;
}

static const output_kind *output(const void *own) {
    static const output_kind samples = {
        .what = "NRRD", .suffixes = ".nrrd ", .instead = OUTPUT_BY_EXPORT};
    (void)own;
    return &samples;
}

static const cli_verb verb = {
    .options = options,
    .set_option = set_option,
    .check = check,
    .output = output,
    .input = "input",
    .args_doc = "INPUT -o F.nrrd",
    .doc =
        "Resample a mesh or a curvilinear grid to a regular grid of f32 samples, as NRRD (-o -: "
        "to standard output). INPUT: a treelet file, or whatever mesh or curvilinear grid convert "
        "takes; or - for one on standard input. A node's value is that of the cell that holds it, "
        "linear in a "
        "tet, else by its own interpolant; NaN outside."
        "\vExample:\n  leafcast resample fin.vtk --dims 256 -o fin.nrrd\v"
        "Memory stays below --memory (default 2G) whatever the sizes of mesh and grid. What "
        "is no treelet file becomes one first, beside the output (-o -: in $TMPDIR), "
        "which takes about 14 bytes a tet and vanishes in the end. The output's bytes depend "
        "on neither --memory nor --threads.",
};

/* ---- all of it ---- */

static json_t *report_json(const resample_grid *g, const resample_result *r, double seconds) {
    return json_pack("{s:[i,i,i], s:[f,f,f], s:I, s:I, s:I, s:I, s:f}", "dims", (int)g->dims[0],
                     (int)g->dims[1], (int)g->dims[2], "spacing", g->spacing[0], g->spacing[1],
                     g->spacing[2], "nodes", (json_int_t)r->nodes, "held", (json_int_t)r->held,
                     "slabs", (json_int_t)r->slabs, "bytes_read", (json_int_t)r->bytes_read,
                     "seconds", seconds);
}

static status report(const arguments *a, const resample_grid *g, const resample_result *r,
                     double seconds) {
    char number[3][NUM_TEXT_MAX];
    if (a->common.json)
        return cli_print_json(&a->common, report_json(g, r, seconds));
    if (output_name_is_stdout(a->common.output) || !cli_results(&a->common, true))
        return ST_OK;
    printf("grid        %u x %u x %u, %s x %s x %s apart\n", g->dims[0], g->dims[1], g->dims[2],
           num_print(g->spacing[0], number[0]), num_print(g->spacing[1], number[1]),
           num_print(g->spacing[2], number[2]));
    printf("in the mesh %llu of %llu nodes\n", (unsigned long long)r->held,
           (unsigned long long)r->nodes);
    printf("time        %.2f s, %llu passes, %.1f MiB read\n", seconds,
           (unsigned long long)r->slabs, (double)r->bytes_read / 0x1p20);
    return ST_OK;
}

static status append(void *ctx, const float *samples, size_t count) {
    return nrrd_writer_append(ctx, samples, count);
}

/* Find the set of values asked for. */
static status find_set(const arguments *a, const leaf_file *f, uint32_t *set) {
    /* An input converted for this job has only the field and the step asked for. */
    const bool is_leaf = resample_input_is_leaf(a->source.path);
    const char *name = is_leaf ? a->source.hints.mesh.field : NULL;
    const uint32_t step = is_leaf && a->step > 0 ? (uint32_t)a->step : 0;
    uint32_t i = 0;
    if (step >= f->header.steps)
        return status_describe(ST_USAGE, "--step %u: there are %u steps, from 0 on", step,
                               f->header.steps);
    while (name && i < f->header.fields && strcmp(f->names[i], name) != 0)
        i++;
    if (i == f->header.fields)
        return status_describe(ST_USAGE, "--field %s: there is none; the first is %s", name,
                               f->names[0]);
    *set = leaf_layout_set(&f->layout, i, step);
    return ST_OK;
}

static status resample(arguments *a, mem *m, leaf_file *f, double start) {
    resample_grid g;
    grid described;
    nrrd_writer *writer = NULL;
    resample_result result;
    resample_options o = {.memory = m->limit, .threads = a->common.threads};
    a->wish.nodes = resample_cells_of(f)->nodes(f);
    status st = find_set(a, f, &o.set);
    if (st == ST_OK)
        st = resample_grid_choose(&a->wish, f->header.bounds, f->header.name, &g, &described);
    if (st == ST_OK)
        st = nrrd_writer_create(m, a->common.output, a->common.force, &described, &writer);
    if (st == ST_OK)
        st = resample_run(m, f, &g, &o, cli_progress(&a->common), append, writer, &result);
    if (st != ST_OK) {
        nrrd_writer_discard(writer);
        return st;
    }
    st = nrrd_writer_commit(writer);
    if (st == ST_OK)
        st = report(a, &g, &result, clock_seconds() - start);
    return st;
}

/* Beside what inputs are like: what only treelet files, or only others can use. */
enum { LEAF = INPUT_TRAIT_END, INPUT = 2 * LEAF };
static const char *const input_names[] = {
    INPUT_TRAIT_NAMES, [INPUT] = "inputs of convert",
    [INPUT_STEPS | LEAF] = "treelet files, and formats of several steps",
    [INPUT_CHOICES | LEAF] = "treelet files, and formats that have several",
    [INPUT_CELLS | INPUT_MEANS] = "meshes"};
static const cli_use uses[] = {{KEY_FIELD, INPUT_CHOICES | LEAF},
                               {KEY_STEP, INPUT_STEPS | LEAF},
                               {KEY_COMPONENT, INPUT_CHOICES},
                               {KEY_CELLS_TO_POINTS, INPUT_CELLS | INPUT_MEANS},
                               {KEY_WHOLE_CELLS, INPUT_CELLS | INPUT_MEANS},
                               {KEY_BY_CORNERS, INPUT_CELLS},
                               {KEY_EXAGGERATE, INPUT_PLACED},
                               {CURVILINEAR_KEY_TO, INPUT},
                               {CURVILINEAR_KEY_SOLUTION, INPUT},
                               {CURVILINEAR_KEY_FUNCTIONS, INPUT},
                               {CURVILINEAR_KEY_LAYOUT, INPUT},
                               {TRUST_KEY_LINKS, INPUT_FILES},
                               {TRUST_KEY_MISSING, INPUT_PARTS}};

static status check_uses(const arguments *a, unsigned traits, const char *format) {
    return cli_check_uses(&a->common, uses, sizeof uses / sizeof *uses, traits, input_names,
                          format);
}

static status check_input(void *own, unsigned traits, const char *format) {
    return check_uses(own, traits | INPUT, format);
}

/* What is said of an input for one kind holds for all. */
static void spread_hints(arguments *a) {
    resample_source *s = &a->source;
    s->hints.mesh.step = s->hints.curvilinear.step = a->step > 0 ? (uint32_t)a->step : 0;
    s->hints.mesh.trust = s->hints.curvilinear.trust = s->hints.grid.trust;
    s->opened = check_input;
    s->ctx = a;
}

static status run(arguments *a) {
    const bool pipe = output_name_is_stdout(a->common.output);
    if (pipe && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "-o -: samples do not go to a terminal");
    mem m;
    mem_init(&m, a->common.memory ? a->common.memory : (uint64_t)MEMORY_DEFAULT_MIB << 20);
    const double start = clock_seconds();
    leaf_file *f = NULL;
    a->source.beside = pipe ? NULL : a->common.output;
    a->source.threads = a->common.threads;
    spread_hints(a);
    const bool is_leaf = resample_input_is_leaf(a->source.path);
    status st = is_leaf ? check_uses(a, LEAF, "a treelet file") : ST_OK;
    if (st == ST_OK)
        st = cli_check_files(&a->common, &m, &a->common.output, pipe ? 0 : 1);
    if (st == ST_OK)
        st = resample_input_open(&m, &a->source, cli_progress(&a->common), &f);
    if (st == ST_OK)
        st = resample(a, &m, f, start);
    leaf_file_close(f);
    curvilinear_options_release(&a->source.hints.curvilinear);
    return st;
}

int main(int argc, char **argv) {
    arguments a = {.common = {.verb = "resample"}, .step = -1};
    cli_parse(&verb, &a.common, argc, argv);
    return cli_finish(&a.common, run(&a));
}
