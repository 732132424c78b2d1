#include "render/app/medium_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "formats/base/cli_value.h"
#include "formats/base/num.h"
#include "render/app/colour_map.h"
#include "render/app/opacity_curve.h"
#include "render/app/transfer_file.h"
#include "render/app/transfer_preset.h"
#include "render/experiments/preintegrated_table.h"

const struct argp_option medium_options_table[] = {
    {NULL, 0, NULL, 0, "Media (the volume itself is seen; with --iso, too, both):", 15},
    {"tf", MEDIUM_TF, "FILE", 0,
     "the transfer function: auto, ct, mr (by percentiles of the values), a text file of lines "
     "\"value r g b extinction\" (linear; per world length), or a colour map of ParaView's with "
     "opacities",
     0},
    {"colour-map", MEDIUM_COLOUR_MAP, "NAME", 0,
     "its colours: grey, viridis, plasma, inferno, magma, cool-warm, rainbow or a file of --tf's "
     "(of several maps in it FILE#NAME)",
     0},
    {"window", MEDIUM_WINDOW, "LO,HI", 0,
     "values over which the colour map, or a file of --tf's, is spread (the field's range)", 0},
    {"opacity-length", MEDIUM_OPACITY_LENGTH, "L", 0,
     "world length over which --opacity V:A, or a file of ParaView's, lets through 1 - A (a tenth "
     "of the volume's diagonal)",
     0},
    {"error", MEDIUM_ERROR, "E", 0,
     "how far a channel of a pixel may be from the exact integral, such as 1e-3 or 1/510 (1/510)",
     0},
    {"homogeneous", MEDIUM_HOMOGENEOUS, "V", CLI_EXPERIMENT,
     "take nodes and treelets of a grid whose values differ by at most V for one value, whatever "
     "the error (0: where --error allows it)",
     0},
    {"project", MEDIUM_PROJECT, "max|min|mean|first=V", 0,
     "instead, one value a pixel in the colours of --colour-map or --tf: the largest, the "
     "smallest, the mean, or the first that reaches V",
     0},
    {"caps", MEDIUM_CAPS, "NAME", OPTION_ARG_OPTIONAL,
     "close isosurfaces that clips have cut open: in the surface's colour, or by the values there "
     "in the colours NAME, as of --colour-map",
     40},
    {"shade-medium", MEDIUM_SHADE, "FADE", OPTION_ARG_OPTIONAL,
     "light the medium, with the gradient of the value as the normal; not certified. Fades away "
     "where the value changes by less than FADE of its range in a cell (1/32)",
     0},
    {"medium", MEDIUM_SUMMING, "certified|steps=F[,A]|preintegrated=F[,N]", CLI_EXPERIMENT,
     "to compare with: in steps of F cells, such as 1/2, whose error nobody knows; rays end at an "
     "opacity of A (0.9999); each looked up in a table of N by N entries (256)",
     15},
    {NULL, 0, NULL, 0, "Marks in the picture:", 35},
    {"legend", MEDIUM_LEGEND, NULL, 0, "draw a bar of the colours with their values", 0},
    {"annotate", MEDIUM_ANNOTATE, "PARTS", OPTION_ARG_OPTIONAL,
     "draw the volume's box, values along its axes, a scale bar: all, or those of box,axes,scale",
     0},
    {"title", MEDIUM_TITLE, "TEXT", 0, "write a line at the top", 0},
    {"unit", MEDIUM_UNIT, "NAME", 0, "the unit of length, for --annotate", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

/* ---- Values ---- */

static status take_name(const char *text, const char *what, char name[MEDIUM_NAME_MAX]) {
    if (!*text || strlen(text) >= MEDIUM_NAME_MAX)
        return status_describe(ST_USAGE, "%s: \"%s\" is no name of a file", what, text);
    memcpy(name, text, strlen(text) + 1);
    return ST_OK;
}

static status take_window(medium_options *o, const char *text) {
    double w[2];
    status st = cli_vector(text, "--window", 2, w);
    if (st == ST_OK && !(w[0] < w[1] && fmax(fabs(w[0]), fabs(w[1])) <= 1e300))
        st = status_describe(ST_USAGE, "--window: \"%s\" is not LO,HI with LO below HI", text);
    if (st != ST_OK)
        return st;
    memcpy(o->window, w, sizeof w);
    o->windowed = true;
    return ST_OK;
}

status medium_options_set(medium_options *o, int key, const char *text) {
    switch (key) {
    case MEDIUM_TF: return take_name(text, "--tf", o->tf);
    case MEDIUM_COLOUR_MAP: return take_name(text, "--colour-map", o->colour_map);
    case MEDIUM_WINDOW: return take_window(o, text);
    case MEDIUM_OPACITY_LENGTH:
        return cli_finite(text, "--opacity-length", 1e-90, 1e90, &o->opacity_length);
    default: return ST_AGAIN;
    }
}

/* Read one "V:A". */
static status take_opacity(medium_options *o, const char *text) {
    double *p = o->opacity[o->opacities], before = -1e300;
    status st = num_doubles(text, "--opacity", ":", 2, p);
    if (o->opacities > 0)
        before = p[-2];
    if (st == ST_OK && !(p[0] >= before && p[0] <= 1e300))
        st = status_describe(ST_USAGE,
                             "--opacity: the values of \"%s\" and what is before it do "
                             "not rise",
                             text);
    if (st == ST_OK && !(p[1] >= 0.0 && p[1] < 1.0))
        st = status_describe(ST_USAGE,
                             "--opacity: \"%s\": an opacity of 0 to below 1 is possible; 1 "
                             "would be an endless extinction, 0.999 nearly is",
                             text);
    o->opacities += st == ST_OK;
    return st;
}

status medium_options_add_opacities(medium_options *o, const char *text) {
    status st = ST_OK;
    for (const char *at = text; st == ST_OK;) {
        char one[80];
        const size_t n = strcspn(at, ",");
        snprintf(one, sizeof one, "%.*s", (int)(n < 79 ? n : 79), at);
        if (o->opacities == MEDIUM_OPACITIES_MAX)
            return status_describe(ST_USAGE, "--opacity: more than %d points: --tf FILE has room",
                                   MEDIUM_OPACITIES_MAX);
        st = take_opacity(o, one);
        at += n;
        if (!*at++)
            break;
    }
    return st;
}

void medium_options_clear(medium_options *o, int key) {
    switch (key) {
    case MEDIUM_TF: o->tf[0] = 0; break;
    case MEDIUM_COLOUR_MAP: o->colour_map[0] = 0; break;
    case MEDIUM_WINDOW: o->windowed = false; break;
    case MEDIUM_OPACITY_LENGTH: o->opacity_length = 0.0; break;
    default: break;
    }
}

status medium_options_caps(const char *text, medium_options *o) {
    *o = (medium_options){.windowed = false};
    return text ? take_name(text, "--caps", o->colour_map) : ST_OK;
}

/* Read "V" or "V/W". */
static status take_ratio(const char *text, const char *what, double *out) {
    double part[2] = {0.0, 1.0};
    status st =
        strchr(text, '/') ? num_doubles(text, what, "/", 2, part) : num_double(text, what, part);
    *out = part[0] / part[1];
    return st;
}

status medium_options_error(const char *text, double *error) {
    status st = take_ratio(text, "--error", error);
    if (st == ST_OK && !(*error >= 1e-9 && *error <= 1.0))
        st = status_describe(ST_USAGE, "--error: %s is not in 1e-9 .. 1", text);
    return st;
}

status medium_options_shade(const char *text, double *fade) {
    *fade = 0.0;
    status st = text ? take_ratio(text, "--shade-medium", fade) : ST_OK;
    if (st == ST_OK && text && !(*fade >= 1e-9 && *fade <= 1.0))
        st = status_describe(ST_USAGE, "--shade-medium: %s is not in 1e-9 .. 1", text);
    return st;
}

/* Read F of "F" or "F,REST", the text behind the '='. *rest: the REST, or NULL. */
static status take_step(const char *text, double *step, const char **rest) {
    char first[80];
    const size_t n = strcspn(text, ",");
    snprintf(first, sizeof first, "%.*s", (int)(n < 79 ? n : 79), text);
    *rest = text[n] ? text + n + 1 : NULL;
    status st = take_ratio(first, "--medium", step);
    if (st == ST_OK && !(*step >= LEAFCAST_STEP_LEAST && *step <= LEAFCAST_STEP_MOST))
        st = status_describe(ST_USAGE, "--medium: steps of %g to %g cells are possible, not of %s",
                             LEAFCAST_STEP_LEAST, LEAFCAST_STEP_MOST, first);
    return st;
}

status medium_options_summing(const char *text, leafcast_scene_experiments *e) {
    const size_t name = strcspn(text, "=");
    const char *rest = NULL;
    int which = 0;
    char word[20];
    snprintf(word, sizeof word, "%.*s", (int)(name < 19 ? name : 19), text);
    if (cli_word(word, "--medium", "certified|steps|preintegrated", &which) != ST_OK ||
        (which > 0) != (text[name] == '='))
        return status_describe(
            ST_USAGE, "--medium: \"%s\" is none of certified, steps=F, preintegrated=F", text);
    e->summing = (leafcast_summing)which;
    e->step = e->opaque = 0.0;
    e->table = 0;
    status st = which > 0 ? take_step(text + name + 1, &e->step, &rest) : ST_OK;
    if (st != ST_OK || !rest)
        return st;
    return e->summing == LEAFCAST_STEPS ? cli_finite(rest, "--medium", 0.0, 1.0, &e->opaque)
                                        : cli_int(rest, "--medium", PREINTEGRATED_SIDE_MIN,
                                                  PREINTEGRATED_SIDE_MAX, &e->table);
}

status medium_options_project(const char *text, leafcast_project *project, double *value) {
    int which = 0;
    if (strncmp(text, "first=", 6) == 0) {
        *project = LEAFCAST_PROJECT_FIRST;
        return cli_finite(text + 6, "--project first", -1e300, 1e300, value);
    }
    status st = cli_word(text, "--project", "max|min|mean", &which);
    if (st != ST_OK)
        return status_describe(ST_USAGE, "--project: \"%s\" is none of max, min, mean, first=V",
                               text);
    *project = (leafcast_project)(LEAFCAST_PROJECT_MAX + which);
    return ST_OK;
}

/* ---- All together ---- */

bool medium_options_given(const medium_options *o) {
    return o->tf[0] || o->colour_map[0] || o->windowed || o->opacities > 0 ||
           o->opacity_length > 0.0;
}

static bool from_file(const medium_options *o) {
    return o->tf[0] && !transfer_preset_is(o->tf);
}

status medium_options_check(const medium_options *o, bool projected) {
    const bool spread =
        o->colour_map[0] || from_file(o) || (!o->tf[0] && (o->opacities > 0 || projected));
    if (projected && (o->opacities > 0 || o->opacity_length > 0.0))
        return status_describe(ST_USAGE, "--project shows one value a pixel: without opacities");
    if (o->tf[0] && o->colour_map[0] && (o->opacities > 0 || projected))
        return status_describe(ST_USAGE, "--tf would change nothing: colours are --colour-map's%s",
                               projected ? "" : ", opacities those of --opacity");
    if (o->windowed && !spread)
        return status_describe(ST_USAGE, "--window is for --colour-map, --tf FILE, --opacity V:A "
                                         "and --project");
    if (o->opacity_length > 0.0 && o->opacities == 0 && !from_file(o))
        return status_describe(ST_USAGE, "--opacity-length is for --opacity V:A and for --tf FILE "
                                         "of ParaView's");
    return ST_OK;
}

/* ---- Made for a volume ---- */

/* A transfer function that is being made. */
typedef struct making {
    const medium_options *o;
    const leafcast *volume;
    uint32_t field, step;
    transfer_list colours, extinctions;
    double factor; /* for the extinctions */
} making;

static double diagonal(const leafcast *volume) {
    const leafcast_info info = leafcast_describe(volume);
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const double edge = info.bounds[1][a] - info.bounds[0][a];
        sum += edge * edge;
    }
    return sqrt(sum);
}

/* Extinctions are made for opacities over a length of 1. Returns the factor that converts them to
 * opacities over --opacity-length, by default a tenth of the volume's diagonal. */
static double of_length(const making *k) {
    enum { TENTH = 10 };
    const double across = diagonal(k->volume);
    if (k->o->opacity_length > 0.0)
        return 1.0 / k->o->opacity_length;
    return across > 0.0 ? TENTH / across : 0.0;
}

static status use_preset(making *k, const char *name) {
    leafcast_histogram h;
    status st = (status)leafcast_get_histogram(k->volume, k->field, k->step, &h);
    return st == ST_OK
               ? transfer_preset_make(name, &h, diagonal(k->volume), &k->colours, &k->extinctions)
               : st;
}

static void take_list(transfer_list *to, transfer_list *from) {
    *to = *from;
    *from = (transfer_list){.m = to->m};
}

/* Get the value range that a map is spread over. */
static status window_of(const making *k, double window[2]) {
    memcpy(window, k->o->window, 2 * sizeof *window);
    if (k->o->windowed)
        return ST_OK;
    status st = (status)leafcast_data_range(k->volume, k->field, k->step, window);
    if (st == ST_OK && !(window[0] <= window[1]))
        window[0] = window[1] = 0.0; /* no value is finite */
    return st;
}

static void ends_of(const transfer_list *t, double ends[2]) {
    if (t->count == 0)
        return;
    ends[0] = fmin(ends[0], t->points[0].value);
    ends[1] = fmax(ends[1], t->points[t->count - 1].value);
}

/* Read the file of a name that is not one of `names`. A missing file is reported as an unknown
 * name, unless the name looks like a file's. */
static status read_named(const making *k, const char *name, const char *flag, const char *names,
                         transfer_file *f) {
    const status st = transfer_file_read(k->colours.m, name, f);
    if (st != ST_IO || strpbrk(name, "./#"))
        return st;
    return status_describe(ST_USAGE, "%s: \"%s\" is neither a file nor one of %s", flag, name,
                           names);
}

static status use_file(making *k) {
    transfer_file f = {0};
    double ends[2] = {INFINITY, -INFINITY};
    status st = read_named(k, k->o->tf, "--tf", transfer_preset_names(), &f);
    if (st == ST_OK && f.per_length && k->o->opacity_length > 0.0)
        st = status_describe(ST_USAGE, "--opacity-length: %s has extinctions, which need none",
                             k->o->tf);
    if (st == ST_OK) {
        take_list(&k->colours, &f.colours);
        take_list(&k->extinctions, &f.extinctions);
        k->factor = f.per_length ? 1.0 : of_length(k);
        ends_of(&k->colours, ends);
        ends_of(&k->extinctions, ends);
    }
    if (st == ST_OK && k->o->windowed && !k->o->colour_map[0]) {
        transfer_list_stretch(&k->colours, ends, k->o->window);
        transfer_list_stretch(&k->extinctions, ends, k->o->window);
    }
    transfer_file_release(&f);
    return st;
}

/* Take the colours of a map, by name or from a file, and spread them over the window. */
static status use_map(making *k, const char *name) {
    transfer_file f = {0};
    double window[2], ends[2] = {INFINITY, -INFINITY};
    transfer_list_release(&k->colours);
    status st = colour_map_named(name, &k->colours);
    if (st == ST_AGAIN) {
        st = read_named(k, name, "--colour-map", colour_map_names(), &f);
        if (st == ST_OK)
            take_list(&k->colours, &f.colours);
        transfer_file_release(&f);
    }
    if (st == ST_OK)
        st = window_of(k, window);
    if (st != ST_OK)
        return st;
    ends_of(&k->colours, ends);
    transfer_list_stretch(&k->colours, ends, window);
    return ST_OK;
}

static status use_opacities(making *k) {
    status st = ST_OK;
    transfer_list_release(&k->extinctions);
    k->factor = of_length(k);
    for (int i = 0; i < k->o->opacities && st == ST_OK; i++)
        st = transfer_list_add(
            &k->extinctions,
            (leafcast_transfer_point){.value = k->o->opacity[i][0],
                                      .extinction = opacity_curve_extinction(k->o->opacity[i][1])});
    return st;
}

static status put_together(making *k, bool projected) {
    const medium_options *o = k->o;
    status st = ST_OK;
    if (from_file(o))
        st = use_file(k);
    else if (o->tf[0] || (o->opacities == 0 && !projected))
        st = use_preset(k, o->tf[0] ? o->tf : "auto");
    if (st == ST_OK && (o->colour_map[0] || k->colours.count == 0))
        st = use_map(k, o->colour_map[0] ? o->colour_map : "grey");
    if (st == ST_OK && o->opacities > 0)
        st = use_opacities(k);
    if (st == ST_OK && k->extinctions.count == 0 && !projected)
        st = status_describe(ST_USAGE,
                             "%s has colours alone: --colour-map %s with --opacity "
                             "V:A,... or --tf auto",
                             o->tf, o->tf);
    return st;
}

status medium_options_make(const medium_options *o, const leafcast *volume, uint32_t field,
                           uint32_t step, bool projected, transfer_list *out) {
    making k = {.o = o,
                .volume = volume,
                .field = field,
                .step = step,
                .colours = {.m = out->m},
                .extinctions = {.m = out->m},
                .factor = 1.0};
    status st = put_together(&k, projected);
    if (st == ST_OK && projected)
        st = transfer_list_join(out, &k.colours, &k.colours, 0.0);
    else if (st == ST_OK)
        st = transfer_list_join(out, &k.colours, &k.extinctions, k.factor);
    transfer_list_release(&k.colours);
    transfer_list_release(&k.extinctions);
    return st;
}

void medium_options_window(const medium_options *o, const transfer_list *made, double window[2]) {
    window[0] = o->windowed ? o->window[0] : made->points[0].value;
    window[1] = o->windowed ? o->window[1] : made->points[made->count - 1].value;
}
