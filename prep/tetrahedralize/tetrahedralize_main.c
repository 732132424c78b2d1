/* leafcast tetrahedralize - meshes points or a closed surface into tets, by TetGen. */
#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cli.h"
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

/* Parse R or R,ANGLE. */
static status set_quality(tetrahedralize_options *how, const char *text) {
    double numbers[2] = {0, 0};
    status st = num_doubles(text, "--quality", ",", strchr(text, ',') ? 2 : 1, numbers);
    if (st != ST_OK)
        return st;
    if (!(numbers[0] == 0 || (numbers[0] > 1 && numbers[0] <= RATIO_MAX)))
        return status_describe(ST_USAGE, "--quality: \"%s\": expected R above 1, at most %g, or 0",
                               text, RATIO_MAX);
    if (!(numbers[1] >= 0 && numbers[1] <= ANGLE_MAX) || (numbers[0] == 0 && numbers[1] > 0))
        return status_describe(ST_USAGE, "--quality: \"%s\": expected ANGLE in 0 .. %g, with an R",
                               text, ANGLE_MAX);
    how->ratio = numbers[0];
    how->angle = numbers[1];
    how->meshing = true;
    return ST_OK;
}

static status set_volume(tetrahedralize_options *how, const char *text) {
    status st = num_double(text, "--max-volume", &how->max_volume);
    if (st == ST_OK && !(how->max_volume > 0 && how->max_volume < 1e300))
        st = status_describe(ST_USAGE, "--max-volume: \"%s\": expected a number above 0", text);
    how->meshing = true;
    return st;
}

static status set_timeout(tetrahedralize_options *how, const char *text) {
    status st = num_double(text, "--timeout", &how->seconds);
    if (st == ST_OK && !(how->seconds >= 0 && how->seconds <= 1e9))
        st = status_describe(ST_USAGE, "--timeout: \"%s\": expected seconds, or 0", text);
    return st;
}

static status set_option(void *own, int key, const char *text) {
    tetrahedralize_options *how = &((arguments *)own)->how;
    switch (key) {
    case KEY_QUALITY: return set_quality(how, text);
    case KEY_MAX_VOLUME: return set_volume(how, text);
    case KEY_FIELD: how->field = text; return ST_OK;
    case KEY_FORMAT: how->format = text; return ST_OK;
    case KEY_POINTS: how->points = true; return ST_OK;
    case KEY_TIMEOUT: return set_timeout(how, text);
    default: return ST_AGAIN;
    }
}

static status check(void *own) {
    arguments *a = own;
    a->how.input = a->common.input;
    if (!a->how.input || !a->common.output)
        return status_describe(ST_USAGE, "an INPUT and -o are needed");
    return ST_OK;
}

static const output_kind *output(const void *own) {
    static const output_kind mesh = {
        .what = "a mesh stream", .suffixes = ".mesh ", .instead = OUTPUT_BY_EXPORT};
    (void)own;
    return &mesh;
}

static const cli_verb verb = {
    .options = options,
    .set_option = set_option,
    .check = check,
    .output = output,
    .input = "input",
    .args_doc = "INPUT -o F.mesh",
    .doc =
        "Make a mesh of tets of points or a closed surface. Points (.node .csv .txt .xyz .ply) "
        "become their Delaunay mesh, the inside of a surface (.poly .smesh .ply .stl .off) a mesh "
        "of well-shaped tets, by TetGen. The mesh stream goes to F.mesh, or with -o - to standard "
        "output, as for `leafcast convert -'; INPUT may be -, too."
        "\vExample:\n  leafcast tetrahedralize bunny.stl -o bunny.mesh",
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
    const bool pipe = output_name_is_stdout(a->common.output);
    if (pipe && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "-o -: a mesh does not go to a terminal");
    mem m;
    mem_init(&m, a->common.memory);
    a->how.output = a->common.output;
    a->how.force = a->common.force;
    a->how.memory = a->common.memory;
    a->how.threads = a->common.threads;
    tetrahedralize_report report;
    status st = cli_check_files(&a->common, &m, &a->common.output, pipe ? 0 : 1);
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
    cli_parse(&verb, &a.common, argc, argv);
    return cli_finish(&a.common, run(&a));
}
