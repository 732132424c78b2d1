/* probe_main.c - leafcast probe: print what a pixel's ray or a point of space meets. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cli.h"
#include "formats/base/cli_json.h"
#include "formats/base/cli_value.h"
#include "formats/base/mem.h"
#include "formats/base/num.h"
#include "formats/base/printed_file.h"
#include "formats/base/shell_line.h"
#include "formats/base/text.h"
#include "render/app/cell_text.h"
#include "render/app/colour_by.h"
#include "render/app/picture_scene.h"
#include "render/app/ray_profile.h"
#include "render/app/render_job.h"
#include "render/app/view_camera.h"
#include "render/app/world_options.h"

enum { HITS_MAX = 1000 };

typedef struct probe_options {
    cli_common common;
    view_options view;
    const char *cell; /* what a cell of the file is called; known once it is open */
    bool at, point, ray;
    double pixel[2], where[3], line[6];
    int hits;
    bool segments;
    leafcast_axes axes;
    const char *csv, *svg; /* file names; csv "-": standard output */
    colour_by by;
    leafcast_colouring colouring; /* volume NULL: there is none */
    mem m;
} probe_options;

/* ---- flags ---- */

enum { AT = 0x3000, POINT, RAY, HITS, SEGMENTS, CSV, SVG };

static const struct argp_option OPTIONS[] = {
    {NULL, 0, NULL, 0, "Where (one of these):", 1},
    {"at", AT, "X,Y", CLI_BASIC, "the ray of this pixel; 0,0 is at the top left", 0},
    {"ray", RAY, "X,Y,Z,DX,DY,DZ", CLI_BASIC, "a ray from a point in a direction", 0},
    {"point", POINT, "X,Y,Z", CLI_BASIC, "a point", 0},
    {NULL, 0, NULL, 0, "How much:", 2},
    {"hits", HITS, "N", CLI_BASIC, "at most N hits (20)", 0},
    {"segments", SEGMENTS, NULL, CLI_BASIC,
     "the ray's profile: every cell that it passes, and the values there; needs no --iso", 0},
    {"csv", CSV, "FILE", CLI_BASIC, "the profile as a table; - for standard output", 0},
    {"svg", SVG, "FILE", CLI_BASIC, "the profile as a plot: the value along the ray", 0},
    WORLD_OPTION(0),
    {NULL, 0, NULL, 0, NULL, 0}};

static status set_option(void *own, int key, const char *text) {
    probe_options *o = own;
    switch (key) {
    case AT: o->at = true; return cli_vector(text, "--at", 2, o->pixel);
    case POINT: o->point = true; return cli_vector(text, "--point", 3, o->where);
    case RAY: o->ray = true; return cli_vector(text, "--ray", 6, o->line);
    case HITS: return cli_int(text, "--hits", 1, HITS_MAX, &o->hits);
    case SEGMENTS: o->segments = true; return ST_OK;
    case CSV:
        o->segments = true;
        o->csv = text;
        return output_name_check(text, &(output_kind){.what = "a table", .suffixes = ".csv "});
    case WORLD_OPTION_KEY: return world_option_set(text, &o->axes);
    case SVG:
        o->segments = true;
        o->svg = text;
        return output_name_check(text, &(output_kind){.what = "a plot", .suffixes = ".svg "});
    default: return view_options_set(&o->view, key, text);
    }
}

/* Check the view's flags. A ray's profile and a point need no isosurface, a point no camera. What
 * else needs one has that which its picture has: choose_surface(). */
static status check_view(probe_options *o) {
    if (o->view.isos > 0)
        return view_options_check(&o->view);
    return o->point ? time_options_check(&o->view.time) : view_options_check_either(&o->view);
}

static status check_options(void *own) {
    probe_options *o = own;
    if (!o->common.input)
        return status_describe(ST_USAGE, "which treelet file?");
    if (o->at + o->point + o->ray != 1)
        return status_describe(ST_USAGE, "where? one of --at X,Y, --ray and --point X,Y,Z");
    if (o->common.output)
        return status_describe(ST_USAGE, "the answer goes to standard output");
    const double size[2] = {o->view.camera.width, o->view.camera.height};
    for (int i = 0; i < 2 && o->at; i++)
        if (!(o->pixel[i] >= 0.0 && o->pixel[i] < size[i] && o->pixel[i] == floor(o->pixel[i])))
            return status_describe(ST_USAGE, "--at: no such pixel in %g x %g", size[0], size[1]);
    if (o->ray && o->line[3] == 0.0 && o->line[4] == 0.0 && o->line[5] == 0.0)
        return status_describe(ST_USAGE, "--ray: the direction is zero");
    if (o->view.scene.samples > 1)
        return status_describe(ST_USAGE, "--samples: a probe follows one ray");
    if (o->segments && o->point)
        return status_describe(ST_USAGE, "--segments: a point has none; --at or --ray");
    if (output_name_is_stdout(o->csv) && o->common.json)
        return status_describe(ST_USAGE, "--csv - and --json: standard output holds one of them");
    return check_view(o);
}

/* ---- the answer: JSON first; the text is printed from it ---- */

/* The answer about a ray. It is printed after the volume is closed. */
static leafcast_hit hits[HITS_MAX];
static ray_profile profile = {.hits = hits};

static json_t *floats(const float *x, int count) {
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        json_array_append_new(list, cli_json_real((double)x[i]));
    return list;
}

static void set_cell(json_t *out, const probe_options *o, const leafcast *volume, uint32_t level,
                     uint64_t cell) {
    const cell_text c = cell_text_of(volume, level, cell);
    json_object_set_new(out, o->cell, cell_text_json(&c));
}

/* Set the keys that say where a hit or point is. The corners of a cell with indices follow from the
 * indices; for other cells the positions of corners are given. at: the position in the cell. */
static status set_place(json_t *out, const probe_options *o, leafcast *volume, uint32_t level,
                        uint64_t cell, const double at[3]) {
    leafcast_cell c = {.size = sizeof c};
    status st = render_status(leafcast_get_cell(volume, level, cell, &c));
    if (st != ST_OK)
        return st;
    set_cell(out, o, volume, level, cell);
    if (c.indices)
        json_object_set_new(out, "position_in_cell", cli_json_reals(at, 3));
    else if (c.corners)
        json_object_set_new(out, "vertices", cli_json_reals(c.position[0], 3 * c.corners));
    if (c.corners)
        json_object_set_new(out, c.indices ? "samples" : "values", floats(c.value, c.corners));
    return ST_OK;
}

/* Tell the value by which --colour-by colours a point. */
static status set_colour_by(json_t *out, const probe_options *o, const double point[3]) {
    leafcast_sample sample;
    if (!o->colouring.volume)
        return ST_OK;
    const status st = render_status(leafcast_probe_point(o->colouring.volume, point, &sample));
    if (st == ST_OK)
        json_object_set_new(out, "colour_by_value", cli_json_real(sample.value));
    return st;
}

static json_t *side_json(const probe_options *o, const leafcast_hit *h) {
    char flat[64];
    snprintf(flat, sizeof flat, "flat %s", o->cell);
    return json_string(h->flat ? flat : h->entering ? "entering" : "leaving");
}

static status set_hit(json_t *out, const probe_options *o, leafcast *volume,
                      const leafcast_hit *h) {
    json_object_set_new(out, "t", cli_json_real(h->t));
    json_object_set_new(out, "error_bound", cli_json_real(h->error_bound));
    json_object_set_new(out, "point", cli_json_reals(h->point, 3));
    json_object_set_new(out, "id", json_integer(h->surface));
    if (!o->view.is_surface)
        json_object_set_new(out, "isovalue", cli_json_real(o->view.surfaces[h->surface].isovalue));
    json_object_set_new(out, "side", side_json(o, h));
    const status st = set_place(out, o, volume, h->level, h->cell, h->at);
    json_object_set_new(out, "gradient", cli_json_reals(h->gradient, 3));
    json_object_set_new(out, "normal", cli_json_reals(h->normal, 3));
    return st == ST_OK ? set_colour_by(out, o, h->point) : st;
}

static json_t *segment_json(const probe_options *o, int i) {
    const leafcast_segment *s = &profile.segments[i];
    json_t *out = json_object();
    json_object_set_new(out, "t0", cli_json_real(s->t0));
    json_object_set_new(out, "t1", cli_json_real(s->t1));
    json_object_set_new(out, o->cell, cell_text_json(&profile.cells[i]));
    json_object_set_new(out, "control", cli_json_reals(s->control, s->degree + 1));
    json_object_set_new(out, "least", cli_json_real(s->least));
    json_object_set_new(out, "least_t", cli_json_real(s->least_t));
    json_object_set_new(out, "most", cli_json_real(s->most));
    json_object_set_new(out, "most_t", cli_json_real(s->most_t));
    return out;
}

static status set_point(json_t *out, const probe_options *o, leafcast *volume,
                        const leafcast_sample *s) {
    json_object_set_new(out, "point", cli_json_reals(o->where, 3));
    json_object_set_new(out, "inside", json_boolean(s->inside));
    status st = set_colour_by(out, o, o->where);
    if (st != ST_OK || !s->inside)
        return st;
    json_object_set_new(out, "value", cli_json_real(s->value));
    st = set_place(out, o, volume, 0, s->cell, s->at);
    json_object_set_new(out, "gradient", cli_json_reals(s->gradient, 3));
    json_object_set_new(out, "treelet", json_integer(s->treelet));
    return st;
}

static void print_value(const json_t *value) {
    char number[NUM_TEXT_MAX];
    if (json_is_array(value)) {
        for (size_t i = 0; i < json_array_size(value); i++) {
            fputs(i ? " " : "", stdout);
            print_value(json_array_get(value, i));
        }
    } else if (json_is_string(value)) {
        fputs(json_string_value(value), stdout);
    } else if (json_is_null(value)) {
        putchar('-'); /* not finite */
    } else if (json_is_boolean(value)) {
        fputs(json_is_true(value) ? "yes" : "no", stdout);
    } else {
        fputs(num_print(json_number_value(value), number), stdout);
    }
}

/* Print one "  key: value" a line; number the objects of a list. */
static void print_text(json_t *object, int indent) {
    const char *key;
    json_t *value;
    json_object_foreach(object, key, value) {
        const bool list = json_is_array(value) && json_is_object(json_array_get(value, 0));
        for (size_t i = 0; list && i < json_array_size(value); i++) {
            printf("%*shit %zu\n", indent, "", i + 1);
            print_text(json_array_get(value, i), indent + 2);
        }
        if (list || (json_is_array(value) && json_array_size(value) == 0))
            continue;
        printf("%*s", indent, "");
        for (const char *c = key; *c; c++)
            putchar(*c == '_' ? ' ' : *c);
        fputs(": ", stdout);
        print_value(value);
        putchar('\n');
    }
}

/* ---- the question ---- */

static void ray_of(const probe_options *o, const leafcast *volume, json_t *answer, double origin[3],
                   double direction[3]) {
    const leafcast_camera camera = view_camera_of(&o->view, volume);
    if (o->at) {
        leafcast_pixel_ray(&camera, o->pixel[0] + 0.5, o->pixel[1] + 0.5, origin, direction);
        json_object_set_new(answer, "pixel", cli_json_reals(o->pixel, 2));
    } else {
        memcpy(origin, o->line, 3 * sizeof *origin);
        memcpy(direction, o->line + 3, 3 * sizeof *direction);
    }
    json_object_set_new(answer, "origin", cli_json_reals(origin, 3));
    json_object_set_new(answer, "direction", cli_json_reals(direction, 3));
}

static status probe_hits(const probe_options *o, leafcast *volume, const double origin[3],
                         const double direction[3], json_t *answer) {
    int count = 0;
    leafcast_scene_experiments e;
    const leafcast_scene scene = view_options_scene(&o->view, &e);
    status st = render_status(leafcast_select(volume, o->view.surfaces, o->view.isos));
    if (st == ST_OK)
        st = render_status(
            leafcast_probe_ray(volume, &scene, origin, direction, hits, o->hits, &count));
    if (st)
        return st;
    json_object_set_new(answer, "count", json_integer(count));
    json_t *list = json_array();
    for (int i = 0; i < count && st == ST_OK; i++) {
        json_t *one = json_object();
        st = set_hit(one, o, volume, &hits[i]);
        json_array_append_new(list, one);
    }
    json_object_set_new(answer, "hits", list);
    profile.hit_count = count;
    return st;
}

enum { SEGMENTS_AT_FIRST = 4096 };

/* Find the cells of all segments. */
static status find_cells(probe_options *o, const leafcast *volume) {
    cell_text *cells = mem_array(&o->m, (size_t)profile.count, sizeof *cells);
    profile.cells = cells;
    if (!cells)
        return ST_NOMEM;
    for (int i = 0; i < profile.count; i++)
        cells[i] = cell_text_of(volume, profile.segments[i].level, profile.segments[i].cell);
    return ST_OK;
}

/* Find all segments: double the room until they fit. */
static status find_segments(probe_options *o, leafcast *volume, const double origin[3],
                            const double direction[3]) {
    leafcast_scene_experiments e;
    const leafcast_scene scene = view_options_scene(&o->view, &e);
    status st = ST_OK;
    int room = SEGMENTS_AT_FIRST / 2;
    do {
        room *= 2;
        mem_free(&o->m, (void *)profile.segments);
        leafcast_segment *more = mem_alloc(&o->m, (size_t)room * sizeof *more);
        profile.segments = more;
        if (!more)
            return ST_NOMEM;
        st = render_status(
            leafcast_probe_segments(volume, &scene, origin, direction, more, room, &profile.count));
    } while (st == ST_OK && profile.count == room);
    return st == ST_OK ? find_cells(o, volume) : st;
}

static void set_segments(const probe_options *o, json_t *answer) {
    const ray_profile_total total = ray_profile_sum(&profile);
    json_object_set_new(answer, "cells", json_integer(profile.count));
    json_object_set_new(answer, "length", cli_json_real(total.length));
    json_object_set_new(answer, "least", cli_json_real(total.least));
    json_object_set_new(answer, "least_t", cli_json_real(total.least_t));
    json_object_set_new(answer, "most", cli_json_real(total.most));
    json_object_set_new(answer, "most_t", cli_json_real(total.most_t));
    json_object_set_new(answer, "mean", cli_json_real(total.mean));
    json_t *list = json_array();
    for (int i = 0; i < profile.count && o->common.json; i++)
        json_array_append_new(list, segment_json(o, i));
    json_object_set_new(answer, "segments", list);
}

static void set_title(const probe_options *o) {
    static char title[600];
    char name[300];
    text_file_name(name, sizeof name, o->common.input);
    const int n = snprintf(title, sizeof title, "%s, ", name);
    char *rest = title + n;
    if (o->at)
        snprintf(rest, sizeof title - (size_t)n, "pixel %g,%g", o->pixel[0], o->pixel[1]);
    else
        snprintf(rest, sizeof title - (size_t)n, "ray %g,%g,%g,%g,%g,%g", o->line[0], o->line[1],
                 o->line[2], o->line[3], o->line[4], o->line[5]);
    profile.title = title;
}

static status write_profile(probe_options *o) {
    static double isovalues[LEAFCAST_SURFACES_MAX];
    for (int i = 0; i < o->view.isos; i++)
        isovalues[i] = o->view.surfaces[i].isovalue;
    profile.isovalues = isovalues;
    profile.isos = o->view.isos;
    set_title(o);
    status st = ST_OK;
    if (o->csv && !output_name_is_stdout(o->csv))
        st = printed_file_write(&o->m, o->csv, o->common.force, ray_profile_csv, &profile);
    if (st == ST_OK && o->svg)
        st = printed_file_write(&o->m, o->svg, o->common.force, ray_profile_svg, &profile);
    return st;
}

static status probe_ray(probe_options *o, leafcast *volume, json_t *answer) {
    double origin[3], direction[3];
    ray_of(o, volume, answer, origin, direction);
    status st = o->view.isos > 0 ? probe_hits(o, volume, origin, direction, answer) : ST_OK;
    if (st != ST_OK || !o->segments)
        return st;
    st = find_segments(o, volume, origin, direction);
    if (st != ST_OK)
        return st;
    set_segments(o, answer);
    return write_profile(o);
}

static status probe_point(const probe_options *o, leafcast *volume, json_t *answer) {
    leafcast_sample sample;
    status st = render_status(leafcast_probe_point(volume, o->where, &sample));
    if (st)
        return st;
    st = set_point(answer, o, volume, &sample);
    for (int i = 0; i < o->view.isos && sample.inside; i++) {
        const double iso = o->view.surfaces[i].isovalue;
        char key[64], number[NUM_TEXT_MAX];
        snprintf(key, sizeof key, "inside_%s", num_print(iso, number));
        json_object_set_new(answer, key, json_boolean(sample.value >= iso));
    }
    return st;
}

enum { QUOTED_MOST = 4 }; /* growth of one byte by quoting or text_printable() */

/* Add the command line, quoted so that it can be typed again. */
static status set_rerun(json_t *answer, int argc, char **argv) {
    mem m;
    size_t room = 1;
    for (int i = 0; i < argc; i++)
        room += QUOTED_MOST * strlen(argv[i]) + 3; /* quotes and a space */
    mem_init(&m, 0);
    char *line = mem_alloc(&m, room + QUOTED_MOST * room);
    if (!line)
        return ST_NOMEM;
    shell_line l = shell_line_begin(line, room);
    shell_line_put(&l, argv[0]); /* "leafcast probe" */
    for (int i = 1; i < argc; i++) {
        shell_line_put(&l, " ");
        shell_line_word(&l, argv[i]);
    }
    const char *printable = text_printable(line + room, QUOTED_MOST * room, line);
    json_object_set_new(answer, "rerun", json_string(printable));
    mem_free(&m, line);
    return ST_OK;
}

/* Choose what a picture without --iso shows, if a surface is sought. */
static status choose_surface(probe_options *o, const leafcast *volume) {
    double suggested[LEAFCAST_SUGGESTIONS_MAX];
    int count;
    if (o->view.isos == 0 && (o->point || o->segments))
        return ST_OK;
    status st = picture_scene_choose(volume, &o->view, suggested, &count);
    if (st == ST_OK)
        st = picture_scene_check_used(volume, &o->view);
    return st == ST_OK ? view_options_check(&o->view) : st;
}

/* Select the field and step. Name them in the answer if the file has more than one. */
static status select_set(probe_options *o, leafcast *volume, json_t *answer) {
    uint32_t field;
    view_options *v = &o->view;
    status st = view_options_field(v, volume, &field);
    if (st == ST_OK)
        st = time_options_find(&v->time, volume, &v->step);
    if (st == ST_OK && v->colour_by[0]) {
        leafcast_shown shown = {
            .volume = volume, .field = field, .step = v->step, .between = v->time.between};
        st = colour_by_find(&o->by, v, colour_by_world(volume), &shown, &o->colouring);
        field = shown.field;
    }
    if (st == ST_OK && o->colouring.volume)
        st = render_status(leafcast_select_between(o->colouring.volume, o->colouring.field,
                                                   o->colouring.step, o->colouring.between));
    if (st == ST_OK)
        st = render_status(leafcast_select_between(volume, field, v->step, v->time.between));
    if (st == ST_OK)
        render_stats_set(answer, volume, field, v->step, v->time.between);
    return st;
}

/* Note the name of cells, and whether they have indices: both are printed after the volume is
 * closed. */
static void take_words(probe_options *o, const leafcast *volume) {
    const leafcast_info info = leafcast_describe(volume);
    o->cell = profile.cell = info.cell;
    profile.indexed = info.dims[0] > 0;
}

static status run(probe_options *o, json_t *answer) {
    const leafcast_options open = {.size = sizeof(leafcast_options),
                                   .memory = o->common.memory,
                                   .threads = 1,
                                   .axes = o->axes};
    const char *const outputs[] = {output_name_is_stdout(o->csv) ? NULL : o->csv, o->svg};
    leafcast *volume = NULL;
    status st = cli_check_files(&o->common, &o->m, outputs, 2);
    if (st == ST_OK)
        st = render_status(leafcast_open(o->common.input, &open, &volume));
    if (st == ST_OK)
        take_words(o, volume);
    if (st == ST_OK)
        st = view_options_check_volume(&o->view, volume);
    if (st == ST_OK)
        st = choose_surface(o, volume);
    if (st == ST_OK)
        st = select_set(o, volume, answer);
    if (st == ST_OK)
        st = o->point ? probe_point(o, volume, answer) : probe_ray(o, volume, answer);
    colour_by_close(&o->by);
    leafcast_close(volume);
    return st;
}

static void print_answer(const probe_options *o, json_t *answer) {
    cli_results(&o->common, false);
    if (output_name_is_stdout(o->csv)) {
        ray_profile_csv(&profile, stdout);
        return;
    }
    print_text(answer, 0);
    if (o->segments && !o->csv) {
        putchar('\n');
        ray_profile_text(&profile, stdout);
    }
}

int main(int argc, char **argv) {
    static probe_options o = {.common = {.verb = "probe", .without = "output threads"}, .hits = 20};
    struct argp_option options[VIEW_OPTIONS_ROOM];
    view_options_join(options, OPTIONS, false, "iso size eye look-at");
    const cli_verb verb = {
        .options = options,
        .set_option = set_option,
        .check = check_options,
        .input = "treelet file",
        .args_doc = "F.leaf",
        .doc = "Tell what a pixel's ray or a point sees: hits, cells, values, gradients, the error "
               "bound; with --segments the value all along the ray.\v"
               "Example:\n  leafcast probe bonsai.leaf --iso 37 --at 512,400\v"
               "The flags are those of render, so that a picture's pixel is found again. "
               "With --json the answer is a JSON object."};
    view_options_init(&o.view);
    mem_init(&o.m, 0);
    cli_parse(&verb, &o.common, argc, argv);

    json_t *answer = json_object();
    status st = run(&o, answer);
    if (st == ST_OK)
        st = set_rerun(answer, argc, argv);
    if (st == ST_OK && o.common.json) {
        st = cli_print_json(&o.common, json_incref(answer));
    } else if (st == ST_OK) {
        print_answer(&o, answer);
    }
    json_decref(answer);
    mem_free(&o.m, (void *)profile.segments);
    mem_free(&o.m, (void *)profile.cells);
    return cli_finish(&o.common, st);
}
