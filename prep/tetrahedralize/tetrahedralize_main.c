/* leafcast tetrahedralize - points or a closed surface to a mesh of tets, by TetGen. */
#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "prep/tetrahedralize/tetrahedralize.h"

#define TIMEOUT_DEFAULT 3600.0
#define RATIO_DEFAULT   2.0
#define RATIO_MAX       1000.0
#define ANGLE_MAX       60.0

typedef struct arguments {
    cli_common common;
    tetrahedralize_options how;
} arguments;

enum { KEY_QUALITY = 0x2000, KEY_MAX_VOLUME, KEY_FIELD, KEY_FORMAT, KEY_POINTS, KEY_TIMEOUT };

static const struct argp_option options[] = {
    {"points", KEY_POINTS, NULL, CLI_BASIC, "take the points alone, also where there are facets",
     1},
    {"field", KEY_FIELD, "NAME", CLI_BASIC,
     "the values: a field of the points by name (default: the first there is), or, of surfaces, "
     "distance (the default there): to the nearest facet, 0 on the surface",
     1},
    {"format", KEY_FORMAT, "NAME", 0,
     "node csv ply stl off poly or smesh; else as the file's name ends", 1},
    {NULL, 0, NULL, 0, "Surfaces:", 2},
    {"quality", KEY_QUALITY, "R[,ANGLE]", CLI_BASIC,
     "tets of a circumsphere's radius up to R (default 2) shortest edges, and of dihedral angles "
     "from ANGLE degrees (default 0) on; R of 0: no tets for quality's sake",
     2},
    {"max-volume", KEY_MAX_VOLUME, "V", CLI_BASIC, "of a tet", 2},
    {"timeout", KEY_TIMEOUT, "SECONDS", 0,
     "TetGen is stopped after so many (default 3600; 0: never)", 2},
    {NULL, 0, NULL, 0, NULL, 0}};

static double parse_number(struct argp_state *state, const char *text, const char *what) {
    double value = 0;
    cli_usage_unless(state, num_double(text, what, &value));
    return value;
}

/* R or R,ANGLE. */
static void parse_quality(struct argp_state *state, tetrahedralize_options *how, const char *text) {
    double numbers[2] = {0, 0};
    cli_usage_unless(state,
                     num_doubles(text, "--quality", ",", strchr(text, ',') ? 2 : 1, numbers));
    if (!(numbers[0] == 0 || (numbers[0] > 1 && numbers[0] <= RATIO_MAX)))
        argp_error(state, "--quality: \"%s\": expected R above 1, at most %g, or 0", text,
                   RATIO_MAX);
    if (!(numbers[1] >= 0 && numbers[1] <= ANGLE_MAX) || (numbers[0] == 0 && numbers[1] > 0))
        argp_error(state, "--quality: \"%s\": expected ANGLE in 0 .. %g, with an R", text,
                   ANGLE_MAX);
    how->ratio = numbers[0];
    how->angle = numbers[1];
    how->meshing = true;
}

static void parse_volume(struct argp_state *state, tetrahedralize_options *how, const char *text) {
    how->max_volume = parse_number(state, text, "--max-volume");
    if (!(how->max_volume > 0 && how->max_volume < 1e300))
        argp_error(state, "--max-volume: \"%s\": expected a number above 0", text);
    how->meshing = true;
}

static void parse_timeout(struct argp_state *state, tetrahedralize_options *how, const char *text) {
    how->seconds = parse_number(state, text, "--timeout");
    if (!(how->seconds >= 0 && how->seconds <= 1e9))
        argp_error(state, "--timeout: \"%s\": expected seconds, or 0", text);
}

static void parse_input(struct argp_state *state, arguments *a, const char *path) {
    if (a->how.input)
        argp_error(state, "one input at a time, not also \"%s\"", path);
    a->how.input = path;
}

static error_t parse(int key, char *arg, struct argp_state *state) {
    arguments *a = state->input;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = &a->common; break;
    case KEY_QUALITY: parse_quality(state, &a->how, arg); break;
    case KEY_MAX_VOLUME: parse_volume(state, &a->how, arg); break;
    case KEY_FIELD: a->how.field = arg; break;
    case KEY_FORMAT: a->how.format = arg; break;
    case KEY_POINTS: a->how.points = true; break;
    case KEY_TIMEOUT: parse_timeout(state, &a->how, arg); break;
    case ARGP_KEY_ARG: parse_input(state, a, arg); break;
    case ARGP_KEY_END:
        if (!a->how.input || !a->common.output)
            argp_error(state, "an INPUT and -o are needed");
        break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static const struct argp_child children[] = {{&cli_common_argp, 0, NULL, 0}, {NULL, 0, NULL, 0}};
static const struct argp table = {
    .options = options,
    .parser = parse,
    .args_doc = "INPUT -o F.mesh",
    .doc =
        "Make a mesh of tets of points or a closed surface. Points (.node .csv .txt .xyz .ply) "
        "become their Delaunay mesh, the inside of a surface (.poly .smesh .ply .stl .off) a mesh "
        "of well-shaped tets, by TetGen. The mesh stream goes to F.mesh, or with -o - to standard "
        "output, as for `leafcast convert -'; INPUT may be -, too."
        "\vExample:\n  leafcast tetrahedralize bunny.stl -o bunny.mesh",
    .children = children,
};

/* ---- the report ---- */

static void print_report(const arguments *a, const tetrahedralize_report *r) {
    const plc_report *c = &r->cleaned;
    char volume[NUM_TEXT_MAX];
    cli_note(&a->common, 1, "%s: %llu points (%llu of the input's), %llu tets, volume %s%s%s",
             a->common.output, (unsigned long long)r->points, (unsigned long long)r->points_in,
             (unsigned long long)r->tets, num_print(r->volume, volume),
             r->field[0] ? ", field " : "", r->field);
    if (c->welded)
        cli_note(&a->common, 1, "%llu points at the place of another are one with it",
                 (unsigned long long)c->welded);
    if (c->flat + c->repeated)
        cli_note(&a->common, 1, "facets left out: %llu without area, %llu repeated",
                 (unsigned long long)c->flat, (unsigned long long)c->repeated);
    if (r->unused)
        cli_note(&a->common, 1, "%llu points are in no tet", (unsigned long long)r->unused);
    if (r->flat)
        cli_note(&a->common, 1, "%llu tets have no volume left, now that points are floats",
                 (unsigned long long)r->flat);
}

static json_t *report_json(const tetrahedralize_report *r) {
    return json_pack("{s:b, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:s}", "surface",
                     (int)r->surface, "points_in", (json_int_t)r->points_in, "facets_in",
                     (json_int_t)r->facets_in, "welded", (json_int_t)r->cleaned.welded,
                     "flat_facets", (json_int_t)r->cleaned.flat, "repeated_facets",
                     (json_int_t)r->cleaned.repeated, "points", (json_int_t)r->points, "tets",
                     (json_int_t)r->tets, "unused_points", (json_int_t)r->unused, "flat_tets",
                     (json_int_t)r->flat, "volume", r->volume, "field", r->field);
}

static status run(arguments *a) {
    const bool pipe = strcmp(a->common.output, "-") == 0;
    if (pipe && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "-o -: a mesh does not go to a terminal");
    mem m;
    mem_init(&m, a->common.memory);
    a->how.output = a->common.output;
    a->how.force = a->common.force;
    a->how.memory = a->common.memory;
    a->how.threads = a->common.threads;
    tetrahedralize_report report;
    file_guard_watch();
    status st = file_guard_input(a->how.input);
    if (st == ST_OK)
        st = file_guard_output(a->common.output);
    if (st == ST_OK && !pipe)
        st = out_file_check(&m, a->common.output, a->common.force);
    if (st == ST_OK)
        st = tetrahedralize(&m, &a->how, cli_progress(&a->common), &report);
    if (st != ST_OK)
        return st;
    print_report(a, &report);
    return a->common.json ? cli_print_json(&a->common, report_json(&report)) : ST_OK;
}

int main(int argc, char **argv) {
    arguments a = {.common = {.verb = "tetrahedralize"},
                   .how = {.ratio = RATIO_DEFAULT, .seconds = TIMEOUT_DEFAULT}};
    cli_parse(&table, &a.common, argc, argv, &a);
    return cli_finish(&a.common, run(&a));
}
