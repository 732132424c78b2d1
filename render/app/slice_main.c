/* slice_main.c - leafcast slice: draw or write the values in a plane, or in a curved sheet, through
 * a volume. */
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cli.h"
#include "formats/base/clock.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "formats/base/printed_file.h"
#include "render/app/image_out.h"
#include "render/app/render_job.h"
#include "render/app/slice_request.h"
#include "render/app/world_options.h"

enum { OPTIONS_ROOM = 40 };

typedef struct slice_run {
    cli_common common;
    slice_request slice;
    const char *format, *values, *stats_path;
    leafcast_axes axes;
    mem m;
    leafcast *volume;
    double *value;
    leafcast_image image;
    image_out_options out_options;
    image_out *out;
    leafcast_stats stats;
    double write_s, total_s;
} slice_run;

/* ---- Flags ---- */

enum { FORMAT = 0x3040, VALUES, STATS };

static const struct argp_option OPTIONS[] = {
    {NULL, 0, NULL, 0, "Outputs (-o takes .png, .ppm, .pfm, .exr; -: standard output):", 4},
    {"format", FORMAT, "NAME", 0,
     "png, ppm, pfm or exr, where the name does not say it (-o -: png)", 0},
    {"value-f64", VALUES, "FILE", CLI_BASIC,
     "the values as raw doubles, row by row from the top; NaN where there is no data", 0},
    {"stats", STATS, "FILE", 0, "times, treelets and bytes as JSON", 0},
    WORLD_OPTION(0),
    {NULL, 0, NULL, 0, NULL, 0}};

static status set_option(void *own, int key, const char *text) {
    slice_run *o = own;
    switch (key) {
    case FORMAT: o->format = text; return ST_OK;
    case VALUES: o->values = text; return ST_OK;
    case STATS: o->stats_path = text; return ST_OK;
    case WORLD_OPTION_KEY: return world_option_set(text, &o->axes);
    default: return slice_request_set(&o->slice, key, text);
    }
}

/* Refuse flags that only affect the picture if there is none. */
static status check_picture(const slice_run *o) {
    static const struct {
        int key;
        const char *name;
    } of_pictures[] = {
        {MEDIUM_COLOUR_MAP, "--colour-map"},
        {MEDIUM_TF, "--tf"},
        {MEDIUM_WINDOW, "--window"},
        {MEDIUM_LEGEND, "--legend"},
        {SLICE_ISO, "--iso"},
        {SLICE_COLOUR, "--colour"},
        {FORMAT, "--format"},
    };
    for (size_t i = 0; i < sizeof of_pictures / sizeof *of_pictures && !o->common.output; i++)
        if (cli_given(&o->common, of_pictures[i].key))
            return status_describe(ST_USAGE, "%s is for a picture: -o", of_pictures[i].name);
    return ST_OK;
}

static status check_options(void *own) {
    slice_run *o = own;
    const int streams =
        output_name_is_stdout(o->common.output) + output_name_is_stdout(o->values) + o->common.json;
    if (!o->common.input)
        return status_describe(ST_USAGE, "which treelet file?");
    if (!o->common.output && !o->values && !o->stats_path && !o->common.json)
        return status_describe(ST_USAGE, "where to? -o FILE.png, --value-f64 FILE or --json");
    if (streams > 1)
        return status_describe(ST_USAGE, "standard output holds one of picture, values and --json");
    const status st = check_picture(o);
    return st == ST_OK ? slice_request_check(&o->slice) : st;
}

/* ---- The result as JSON ---- */

static void set_place(const slice_run *o, json_t *root) {
    const leafcast_slice_pixels *s = &o->slice.place.slice;
    json_object_set_new(root, "size", json_pack("[i,i]", (int)s->width, (int)s->height));
    if (s->line_count > 0) {
        json_t *line = json_array();
        for (uint32_t i = 0; i < s->line_count; i++)
            json_array_append_new(line, cli_json_reals(s->line[i], 3));
        json_object_set_new(root, "line", line);
    } else {
        json_object_set_new(root, "origin", cli_json_reals(s->origin, 3));
        json_object_set_new(root, "u", cli_json_reals(s->u, 3));
    }
    json_object_set_new(root, "v", cli_json_reals(s->v, 3));
}

static size_t pixels_of(const slice_run *o) {
    return (size_t)o->slice.place.slice.width * o->slice.place.slice.height;
}

static void set_values(const slice_run *o, json_t *root) {
    const size_t pixels = pixels_of(o);
    double least = INFINITY, most = -INFINITY;
    json_int_t seen = 0;
    for (size_t i = 0; i < pixels; i++) {
        seen += !isnan(o->value[i]);
        least = fmin(least, o->value[i]);
        most = fmax(most, o->value[i]);
    }
    json_object_set_new(root, "pixels", json_integer(seen));
    json_object_set_new(root, "least", cli_json_real(least));
    json_object_set_new(root, "most", cli_json_real(most));
    double window[2];
    if (!o->common.output)
        return;
    medium_options_window(&o->slice.medium, &o->slice.look.colours, window);
    json_object_set_new(root, "window", cli_json_reals(window, 2));
}

static void set_stats(const slice_run *o, json_t *root) {
    const leafcast_stats *t = &o->stats;
    json_object_set_new(root, "time_s",
                        json_pack("{s:f, s:f, s:f, s:f, s:f}", "open", t->open_s, "load", t->load_s,
                                  "sample", t->render_s, "write", o->write_s, "total", o->total_s));
    render_stats_data(root, t, render_stats_peak_rss(), false);
    json_object_set_new(root, "threads", json_integer(t->threads));
    json_object_set_new(root, "isa", json_string(t->isa));
}

static json_t *result_of(const slice_run *o) {
    json_t *root = json_object();
    if (o->common.output)
        json_object_set_new(root, "output", json_string(o->common.output));
    set_place(o, root);
    set_values(o, root);
    render_stats_set(root, o->volume, o->slice.field_number, o->slice.step, o->slice.time.between);
    set_stats(o, root);
    return root;
}

static void print_result(const void *ctx, FILE *out) {
    json_dumpf(ctx, out, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    fputc('\n', out);
}

static status tell(slice_run *o) {
    json_t *result = result_of(o);
    status st = ST_OK;
    cli_note(&o->common, 1, "%u x %u pixels, %llu of %llu treelets, %.3g s",
             o->slice.place.slice.width, o->slice.place.slice.height,
             (unsigned long long)o->stats.treelets_active,
             (unsigned long long)o->stats.treelets_total, o->total_s);
    if (o->stats_path)
        st = printed_file_write(&o->m, o->stats_path, o->common.force, print_result, result);
    if (st == ST_OK && o->common.json)
        st = cli_print_json(&o->common, json_incref(result));
    json_decref(result);
    return st;
}

/* ---- Before work begins ---- */

/* Check the outputs before any work. */
static status check_outputs(slice_run *o) {
    const char *const outputs[] = {o->common.output, o->values, o->stats_path};
    file_guard_watch();
    status st = file_guard_input(o->common.input);
    for (int i = 0; i < 3 && st == ST_OK; i++)
        st = file_guard_output(outputs[i]);
    if (st == ST_OK && o->common.output)
        st = image_out_check(&o->out_options, o->common.output);
    if (st == ST_OK && o->values)
        st = image_out_check_raw(&o->out_options, o->values);
    if (st == ST_OK && o->stats_path)
        st = out_file_check(&o->m, o->stats_path, o->common.force);
    return st;
}

static status open_volume(slice_run *o) {
    const leafcast_options options = {.size = sizeof options,
                                      .memory = o->common.memory,
                                      .threads = o->common.threads,
                                      .axes = o->axes};
    status st = render_status(leafcast_open(o->common.input, &options, &o->volume));
    if (st == ST_OK)
        st = slice_request_select(&o->slice, o->volume);
    return st == ST_OK ? slice_request_place(&o->slice, o->volume, o->common.output) : st;
}

/* ---- The slice ---- */

static status make_planes(slice_run *o) {
    float **const planes[] = {&o->image.r, &o->image.g, &o->image.b, &o->image.a};
    const size_t pixels = pixels_of(o);
    o->value = mem_alloc(&o->m, pixels * sizeof *o->value);
    bool failed = !o->value;
    o->image.value = o->value;
    o->image.size = sizeof o->image;
    for (int i = 0; i < 4 && o->common.output; i++) {
        *planes[i] = mem_alloc(&o->m, pixels * sizeof **planes[i]);
        failed |= !*planes[i];
        o->slice.place.slice.beside += pixels * sizeof **planes[i];
    }
    if (o->common.output)
        o->slice.place.slice.beside +=
            image_out_bytes(&o->out_options, o->common.output, o->slice.place.slice.width);
    return failed ? ST_NOMEM : ST_OK;
}

static bool report(void *ctx, double done) {
    return progress_step(ctx, "slicing", done) == ST_OK;
}

static status write_values(slice_run *o, image_target *to) {
    const picture p = {.width = o->slice.place.slice.width,
                       .height = o->slice.place.slice.height,
                       .image = &o->image};
    return image_out_finish(to, &p);
}

/* Write the picture, with the metadata that one needs to make a plane slice again. */
static status write_picture(slice_run *o, image_target *to) {
    const leafcast_slice_pixels *s = &o->slice.place.slice;
    const char *slash = strrchr(o->common.input, '/');
    char origin[256], u[256], v[256], range[256];
    double window[2];
    medium_options_window(&o->slice.medium, &o->slice.look.colours, window);
    num_print_list(origin, sizeof origin, s->origin, 3);
    num_print_list(u, sizeof u, s->u, 3);
    num_print_list(v, sizeof v, s->v, 3);
    num_print_list(range, sizeof range, window, 2);
    const image_meta meta[] = {{"volume", slash ? slash + 1 : o->common.input},
                               {"window", range},
                               {"v", v},
                               {"origin", origin},
                               {"u", u}};
    const picture p = {.width = s->width,
                       .height = s->height,
                       .image = &o->image,
                       .meta = meta,
                       .meta_count = s->line_count > 0 ? 3 : 5};
    slice_request_draw(&o->slice, o->value, s->width, s->height, &o->image);
    return image_out_finish(to, &p);
}

/* Open output files; NULL: not written. */
typedef struct targets {
    image_target *picture, *values;
} targets;

static status open_targets(slice_run *o, targets *to) {
    status st = image_out_open(&o->m, &o->out_options, &o->out);
    if (st == ST_OK && o->common.output)
        st = image_out_begin(o->out, o->common.output, &to->picture);
    if (st == ST_OK && o->values)
        st = image_out_begin_raw(o->out, o->values, IMAGE_VALUE, &to->values);
    return st;
}

static status write_targets(slice_run *o, targets *to) {
    const targets now = *to;
    status st = ST_OK;
    if (now.values) {
        to->values = NULL;
        st = write_values(o, now.values);
    }
    if (st == ST_OK && now.picture) {
        to->picture = NULL;
        st = write_picture(o, now.picture);
    }
    return st;
}

static status make_slice(slice_run *o, const progress *watch, targets *to) {
    o->stats.size = sizeof o->stats;
    status st = open_targets(o, to);
    if (st == ST_OK)
        st = make_planes(o);
    if (st == ST_OK)
        st = render_status(leafcast_sample_slice(o->volume, &o->slice.place.slice, o->value,
                                                 &o->stats, report, (void *)watch));
    const double sampled = clock_seconds();
    if (st == ST_OK)
        st = write_targets(o, to);
    o->write_s = clock_seconds() - sampled;
    return st;
}

static status run(slice_run *o, const progress *watch) {
    const double begun = clock_seconds();
    targets to = {NULL, NULL};
    status st = check_outputs(o);
    if (st == ST_OK)
        st = open_volume(o);
    if (st == ST_OK)
        st = make_slice(o, watch, &to);
    image_out_discard(to.picture);
    image_out_discard(to.values);
    o->total_s = clock_seconds() - begun;
    return st == ST_OK ? tell(o) : st;
}

static void release(slice_run *o) {
    image_out_close(o->out);
    mem_free(&o->m, o->value);
    mem_free(&o->m, o->image.r);
    mem_free(&o->m, o->image.g);
    mem_free(&o->m, o->image.b);
    mem_free(&o->m, o->image.a);
    leafcast_close(o->volume);
    slice_request_release(&o->slice);
}

/* Join the options of slices with the verb's own. */
static void join_options(struct argp_option out[OPTIONS_ROOM]) {
    enum { PLACE = SLICE_OPTIONS_COUNT - 1, LOOK = SLICE_REQUEST_COUNT - 1 };
    memcpy(out, slice_options_table, PLACE * sizeof *out);
    memcpy(out + PLACE, slice_request_table, LOOK * sizeof *out);
    memcpy(out + PLACE + LOOK, OPTIONS, sizeof OPTIONS);
}

_Static_assert(SLICE_OPTIONS_COUNT + SLICE_REQUEST_COUNT + sizeof OPTIONS / sizeof *OPTIONS <=
                   OPTIONS_ROOM,
               "room");

static const output_kind *output(const void *own) {
    static output_kind kind = {.what = "a picture"};
    kind.suffixes = image_out_suffixes(((const slice_run *)own)->format);
    return &kind;
}

int main(int argc, char **argv) {
    static slice_run o = {.common = {.verb = "slice"}};
    struct argp_option options[OPTIONS_ROOM];
    join_options(options);
    const cli_verb verb = {
        .options = options,
        .set_option = set_option,
        .check = check_options,
        .output = output,
        .input = "treelet file",
        .args_doc = "F.leaf -o FILE.png",
        .doc = "Slice through a volume: a picture of its values in a plane, or the values.\v"
               "Example:\n  leafcast slice bonsai.leaf --axis y --at 128 -o slice.png\v"
               "Coordinates are in world space. Only treelets with pixels in them are read. Where "
               "there is no data, the picture is transparent. Across x and y, z goes up; across "
               "z, y does."};
    mem_init(&o.m, 0);
    slice_request_init(&o.slice, &o.m);
    cli_parse(&verb, &o.common, argc, argv);
    const progress *watch = cli_progress(&o.common);
    o.out_options = (image_out_options){.force = o.common.force,
                                        .threads = o.common.threads,
                                        .format = o.format,
                                        .stop = watch->stop,
                                        .ctx = watch->ctx};
    const status st = run(&o, watch);
    release(&o);
    return cli_finish(&o.common, st);
}
