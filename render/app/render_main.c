/* render_main.c - leafcast render: draw pictures of isosurfaces and media. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cli.h"
#include "formats/base/cli_value.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/num.h"
#include "formats/base/sequence.h"
#include "formats/base/step_list.h"
#include "render/app/keyframes.h"
#include "render/app/render_job.h"
#include "render/app/world_options.h"

typedef struct render_options {
    cli_common common;
    view_options view;
    leafcast_options open;
    leafcast_experiments experiments; /* experiments of `open` */
    const char *files[FRAME_FILES];   /* all but the picture, which is -o */
    const char *stats, *script, *iso_list, *camera_path, *font, *format, *state;
    status_note state_read;            /* the result of reading it */
    step_list steps;                   /* --steps */
    render_also also[RENDER_ALSO_MAX]; /* --and; later flags are about the last one */
    int also_count;
    int repeat;
    int turns;     /* --turntable; 0: none */
    int frames;    /* --frames; 0: a picture for each entry of the path */
    int traversal; /* --traversal: 1 tree, 2 faces; 0: faces where volumes are filled */
    bool fail_empty, certify;
    int drawn; /* pictures so far */
    int empty; /* of these, pictures without any surface */
} render_options;

/* ---- flags ---- */

/* Most pictures of one run; limited by the digits of a name, and by memory for their statistics. */
enum { PICTURES_MAX = 1000000 };

enum {
    FILES = 0x3000, /* plus a frame_file */
    STATS = FILES + FRAME_FILES,
    REPEAT,
    TURNTABLE,
    FAIL_EMPTY,
    CERTIFY,
    FONT,
    ISO_LIST,
    CAMERA_PATH,
    FRAMES,
    SCRIPT,
    STATE,
    AND,
    STEPS,
    FORMAT,
    BACKEND,
    SCHEMA,
    TREELET_LIMIT,
    ISA,
    PACKETS,
    ISOPOLYGONS,
    TRAVERSAL
};

static const char BACKENDS[] = "auto|mapped|arena", SIDES[] = "tile|2|4|8|16",
                  POLYGONS[] = "onthefly|precompute|cache", TRAVERSALS[] = "tree|faces";

static const struct argp_option OPTIONS[] = {
    {NULL, 0, NULL, 0, "Outputs (-o takes .png, .ppm, .pfm, .exr; -: standard output):", 1},
    {"format", FORMAT, "NAME", 0,
     "png, ppm, pfm or exr, where the name does not say it (-o -: png)", 0},
    {"depth-f64", FILES + FRAME_RAW + IMAGE_DEPTH, "FILE", 0,
     "distances from the eye as raw doubles", 0},
    {"rgba-f64", FILES + FRAME_RAW + IMAGE_RGBA, "FILE", 0,
     "red, green, blue, alpha as raw doubles: linear, premultiplied, unrounded", 0},
    {"error-f64", FILES + FRAME_RAW + IMAGE_ERROR, "FILE", 0,
     "of media: how far a pixel is at most from the exact integral, as raw doubles", 0},
    {"value-f64", FILES + FRAME_RAW + IMAGE_VALUE, "FILE", 0,
     "of --project: the values as raw doubles; NaN where there is none", 0},
    {"write-tf", FILES + FRAME_TF, "FILE", 0,
     "the transfer function that is used, as text for --tf", 0},
    {"stats", STATS, "FILE", 0, "times, rays, treelets and bytes as JSON", 0},
    {"fail-empty", FAIL_EMPTY, NULL, 0, "exit 1 where a picture shows no surface", 0},
    {"certify", CERTIFY, NULL, 0,
     "of media: draw again with half of the bound, and see that no channel differs by more than "
     "both bounds; else exit 1, without a picture",
     0},
    {"repeat", REPEAT, "N", CLI_EXPERIMENT, "draw N times; the statistics are the median picture's",
     0},
    {"state", STATE, "FILE", 0,
     "a view as leafcast view has saved it: a JSON object whose keys are these flags; flags behind "
     "it "
     "add to it",
     10},
    {"and", AND, "FILE", 0,
     "a volume more, in the same picture; --iso, --colour, --opacity, --tf, --colour-map, "
     "--window, --opacity-length, --field and --step behind it are about that one. Repeatable; "
     "each can have a medium",
     10},
    WORLD_OPTION(10),
    {NULL, 0, NULL, 0, "Many pictures (-o out.png becomes out_0000.png ...):", 50},
    {"iso-list", ISO_LIST, "V1,V2,...", 0, "a picture for each isovalue; V:V is a picture with two",
     0},
    {"steps", STEPS, STEP_LIST_FORM, 0, "a picture for each of these time steps", 0},
    {"camera-path", CAMERA_PATH, "FILE", 0,
     "a picture for each entry of a JSON array: [{\"eye\": [1,2,3]}, ...]", 0},
    {"frames", FRAMES, "N", 0,
     "a movie: N pictures from the first entry of --camera-path to the last, with what is between "
     "them",
     0},
    {"turntable", TURNTABLE, "N", 0,
     "N pictures around what the camera looks at, about what is up, at equal angles", 0},
    {"script", SCRIPT, "FILE", 0,
     "a picture for each line, as it comes (-: standard input): a JSON object whose keys are these "
     "flags, with \"output\"; each is answered by a line of JSON",
     0},
    {"font", FONT, "FILE", 0, "letters of --annotate and --title (DejaVu Sans, or another)", 35},
    {NULL, 0, NULL, 0, "Machine:", 60},
    {"backend", BACKEND, BACKENDS, CLI_EXPERIMENT, "how treelets come in: auto, mapped or arena",
     0},
    {"schema", SCHEMA, "N", CLI_EXPERIMENT,
     "how another time step of a mesh comes in, 1: each step's trees are read, and stay beside "
     "those "
     "of other steps; 2: one tree, refit to vertices that are read (1 where all steps fit)",
     0},
    {"treelet-limit", TREELET_LIMIT, "N", CLI_EXPERIMENT,
     "never hold more than N treelets (0: what memory allows); for experiments", 0},
    {"isa", ISA, "auto|scalar|sse42|avx2|avx512", CLI_EXPERIMENT,
     "instructions to use: auto, scalar, sse42, avx2, avx512", 0},
    {"packets", PACKETS, SIDES, CLI_EXPERIMENT,
     "of a mesh: how rays walk together: by tile, or in packets of 2, 4, 8 or 16 on a side as "
     "those of Wald and others, 2007",
     0},
    {"isopolygons", ISOPOLYGONS, POLYGONS, CLI_EXPERIMENT,
     "of a mesh: onthefly, or kept: precompute, or cache (when rays first meet them) (onthefly)",
     0},
    {"traversal", TRAVERSAL, TRAVERSALS, CLI_EXPERIMENT,
     "of a mesh: how media and projections find tets: tree, or faces, from neighbour to neighbour",
     0},
    {NULL, 0, NULL, 0, NULL, 0}};

static status set_machine(render_options *o, int key, const char *text) {
    static const int sides[] = {0, 2, 4, 8, 16};
    int which = 0;
    status st = ST_OK;
    switch (key) {
    case BACKEND:
        st = cli_word(text, "--backend", BACKENDS, &which);
        o->open.backend = (leafcast_backend)which;
        return st;
    case SCHEMA:
        st = cli_int(text, "--schema", 1, 2, &which);
        o->experiments.schema = (leafcast_schema)which;
        return st;
    case ISOPOLYGONS:
        st = cli_word(text, "--isopolygons", POLYGONS, &which);
        o->experiments.isopolygons = (leafcast_isopolygons)which;
        return st;
    case TRAVERSAL:
        st = cli_word(text, "--traversal", TRAVERSALS, &which);
        o->traversal = st == ST_OK ? which + 1 : 0;
        return st;
    case PACKETS:
        st = cli_word(text, "--packets", SIDES, &which);
        o->experiments.packets = sides[which];
        return st;
    case ISA: o->open.isa = text; return ST_OK;
    case WORLD_OPTION_KEY: return world_option_set(text, &o->open.axes);
    case TREELET_LIMIT:
        return cli_uint(text, "--treelet-limit", 0, UINT32_MAX, &o->experiments.treelet_limit);
    default: return ST_AGAIN;
    }
}

static status add_volume(render_options *o, const char *path) {
    if (o->also_count == RENDER_ALSO_MAX)
        return status_describe(ST_USAGE, "--and: at most %d volumes in one picture",
                               LEAFCAST_VOLUMES_MAX);
    render_also *also = &o->also[o->also_count++];
    also->path = path;
    view_options_init(&also->view);
    also->view.takes_media = true;
    return ST_OK;
}

/* Returns the options that a flag belongs to: of the last volume of --and, or of the picture. */
static view_options *view_of(render_options *o, int key) {
    return o->also_count > 0 && view_options_of_one(key) ? &o->also[o->also_count - 1].view
                                                         : &o->view;
}

/* Read --state at its place among the flags: later flags add to it. Errors are kept for later. */
static status read_state(render_options *o, const char *path) {
    if (o->state)
        return status_describe(ST_USAGE, "--state: one is enough");
    o->state = path;
    status_note_take(&o->state_read, script_load_state(path, &o->view));
    return ST_OK;
}

static status set_option(void *own, int key, const char *text) {
    render_options *o = own;
    status st = ST_OK;
    switch (key) {
    case STATE: return read_state(o, text);
    case AND: return add_volume(o, text);
    case FORMAT: o->format = text; return ST_OK;
    case STATS: o->stats = text; return ST_OK;
    case SCRIPT: o->script = text; return ST_OK;
    case ISO_LIST: o->iso_list = text; return ST_OK;
    case CAMERA_PATH: o->camera_path = text; return ST_OK;
    case FRAMES: return cli_int(text, "--frames", 1, PICTURES_MAX, &o->frames);
    case STEPS: return step_list_parse(text, "--steps", &o->steps);
    case TURNTABLE: return cli_int(text, "--turntable", 1, PICTURES_MAX, &o->turns);
    case FAIL_EMPTY: o->fail_empty = true; return ST_OK;
    case CERTIFY: o->certify = true; return ST_OK;
    case FONT: o->font = text; return ST_OK;
    case REPEAT: return cli_int(text, "--repeat", 1, 10000, &o->repeat);
    default:
        if (key >= FILES && key < STATS) {
            o->files[key - FILES] = text;
            return ST_OK;
        }
        st = set_machine(o, key, text);
        return st == ST_AGAIN ? view_options_set(view_of(o, key), key, text) : st;
    }
}

static bool is_sequence(const render_options *o) {
    return o->iso_list || step_list_given(&o->steps) || o->camera_path || o->turns;
}

static bool to_stdout(const char *path) {
    return path && strcmp(path, "-") == 0;
}

/* Returns the number of files beside the picture; streams: of those that are standard output. */
static int count_files(const render_options *o, bool streams) {
    int n = 0;
    for (int i = 0; i < FRAME_FILES; i++)
        n += streams ? to_stdout(o->files[i]) : o->files[i] != NULL;
    return n;
}

/* Check all flags together. */
static status check_options(void *own) {
    const render_options *o = own;
    const bool sequence = is_sequence(o);
    const int files = count_files(o, false), streams = count_files(o, true);
    const bool output = o->common.output || files > 0 || o->stats || o->common.json;
    if (!o->common.input)
        return status_describe(ST_USAGE, "which treelet file?");
    if (o->script && (sequence || o->common.output || files > 0 || o->stats))
        return status_describe(ST_USAGE,
                               "--script takes its outputs from its lines and answers them on "
                               "standard output");
    if (to_stdout(o->common.output) + streams + o->common.json > 1)
        return status_describe(ST_USAGE, "standard output takes one of -o -, --depth-f64 - (or "
                                         "another plane) and --json");
    if (!o->script && !output)
        return status_describe(ST_USAGE, "nothing to write: -o FILE.png");
    if (o->frames && !o->camera_path)
        return status_describe(ST_USAGE, "--frames: of which --camera-path?");
    if (o->iso_list && o->view.isos > 0)
        return status_describe(ST_USAGE, "either --iso or --iso-list");
    if (step_list_given(&o->steps) && o->view.step > 0)
        return status_describe(ST_USAGE, "either --step or --steps");
    /* With a path or a script, too: their entries may give --view or --eye. */
    return view_options_check_camera(&o->view);
}

/* ---- one picture ---- */

/* Note isovalues that have no surface in the field and step drawn. Returns whether any has one. */
static bool say_absent(const render_options *o, const render_job *job, const view_options *view) {
    char value[NUM_TEXT_MAX], lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX];
    double range[2];
    bool any = false;
    if (leafcast_range(job->volume, job->field, job->step, range) != LEAFCAST_OK)
        return true;
    for (int i = 0; i < view->isos; i++) {
        const double iso = view->surfaces[i].isovalue;
        /* A surface bounds f >= iso. At the smallest value f >= iso is true everywhere. */
        const bool there = iso > range[0] && iso <= range[1];
        any |= there;
        if (!there && range[0] > range[1])
            cli_note(&o->common, 1, "no surface at isovalue %s: there are no finite values",
                     num_print(iso, value));
        else if (!there)
            cli_note(&o->common, 1, "no surface at isovalue %s: the values are %s to %s",
                     num_print(iso, value), num_print(range[0], lo), num_print(range[1], hi));
    }
    return any;
}

static void say_empty(render_options *o, const render_job *job, const view_options *view,
                      const leafcast_stats *t) {
    const bool any = say_absent(o, job, view);
    if (t->covered_pixels > 0 || view_options_any_filled(view))
        return;
    o->empty++;
    if (any)
        cli_note(&o->common, 1,
                 "no surface in the picture: there is one, but outside of the camera's view, or "
                 "clipped away");
}

static void say_suggested(const render_options *o, const script_frame *frame) {
    char value[NUM_TEXT_MAX], others[LEAFCAST_SUGGESTIONS_MAX * NUM_TEXT_MAX + 16] = "";
    if (frame->suggestions == 0)
        return;
    for (int i = 1; i < frame->suggestions; i++) {
        strcat(others, i == 1 ? "; also " : ", ");
        strcat(others, num_print(frame->suggested[i], value));
    }
    cli_note(&o->common, 1, "isovalue %s, as its values suggest%s; --iso V draws another",
             num_print(frame->suggested[0], value), others);
}

/* Note a value at an end of the range that suggestions and transfer functions leave out. */
static void say_aside(const render_options *o, const render_job *job, const script_frame *frame) {
    char value[NUM_TEXT_MAX];
    double range[2], data[2];
    if ((frame->suggestions == 0 && !view_options_any_filled(&frame->view)) ||
        leafcast_range(job->volume, job->field, job->step, range) != LEAFCAST_OK ||
        leafcast_data_range(job->volume, job->field, job->step, data) != LEAFCAST_OK)
        return;
    for (int side = 0; side < 2 && data[0] <= data[1]; side++)
        if (data[side] != range[side])
            cli_note(&o->common, 1,
                     "%s may stand for no data and is left aside; convert --missing=%s says so",
                     num_print_float((float)range[side], value), value);
}

static void say_done(const render_options *o, const script_frame *frame, const render_stats *s) {
    const leafcast_stats *t = &s->trace;
    const char *name = "drawn";
    for (int i = FRAME_FILES - 1; i >= 0; i--)
        name = frame->file[i][0] ? frame->file[i] : name;
    cli_note(&o->common, 1,
             "%s: %u x %u in %.3g s: trace %.3g (load %.3g), write %.3g; %.3g Mray/s; %llu of %llu "
             "active treelets, %.1f MB read",
             name, frame->view.camera.width, frame->view.camera.height, s->total_s, t->render_s,
             t->load_s, s->write_s, (double)t->rays / t->render_s * 1e-6,
             (unsigned long long)t->treelets_loaded, (unsigned long long)t->treelets_active,
             (double)t->bytes_read * 1e-6);
    if (t->provisional_pixels && t->provisional_error_most > 0.0)
        cli_note(&o->common, 1,
                 "%llu pixels are provisional: no channel is further off than %.3g, in the mean "
                 "%.3g",
                 (unsigned long long)t->provisional_pixels, t->provisional_error_most,
                 t->provisional_error_mean);
    else if (t->provisional_pixels)
        cli_note(&o->common, 1, "%llu pixels are provisional",
                 (unsigned long long)t->provisional_pixels);
    if (s->certified.made)
        cli_note(
            &o->common, 0,
            "%s: with half of the bound no channel differs by more than %.3g, %.3g of both bounds",
            t->uncertified_pixels ? "not certified, but within bounds" : "certified",
            s->certified.difference, s->certified.of_bounds);
    if (t->uncertified_pixels)
        cli_note(&o->common, 1, "%llu pixels may be further off than --error: %s",
                 (unsigned long long)t->uncertified_pixels, certificate_lacks(&frame->view));
    if (t->ill_conditioned)
        cli_note(&o->common, 2, "%llu shadow rays are ill-conditioned",
                 (unsigned long long)t->ill_conditioned);
}

static status draw(render_options *o, render_job *job, const script_frame *frame, json_t **stats) {
    render_stats s;
    say_suggested(o, frame);
    say_aside(o, job, frame);
    status st = render_job_draw(job, frame, &s);
    if (st)
        return st;
    o->drawn++;
    say_empty(o, job, &frame->view, &s.trace);
    say_done(o, frame, &s);
    *stats = render_stats_json(&s, &frame->view, frame->file[FRAME_PICTURE]);
    return ST_OK;
}

/* Write the statistics. Consumes f in any case. */
static status write_stats(out_file *f, const json_t *stats) {
    char *text = json_dumps(stats, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    status st = text ? out_file_append(f, text, strlen(text))
                     : status_describe(ST_NOMEM, "no memory for the statistics");
    free(text);
    if (st == ST_OK)
        st = out_file_append(f, "\n", 1);
    if (st == ST_OK)
        return out_file_commit(f);
    out_file_discard(f);
    return st;
}

/* ---- sequences; a single picture is a sequence of one ---- */

typedef struct sequence {
    mem m;
    out_file *stats; /* NULL: not wanted */
    json_t *path;    /* NULL: no camera path */
    int count;
    const char *isos; /* the rest of --iso-list */
} sequence;

/* Read the isovalues of the next entry of --iso-list: V or V:V:... */
static status next_isos(const char **list, view_options *view) {
    bool repeats;
    view_value takes;
    const int key = view_options_key("iso", &repeats, &takes);
    view_options_clear(view, key);
    for (;;) {
        char text[64];
        const size_t n = strcspn(*list, ",:");
        snprintf(text, sizeof text, "%.*s", (int)(n < 63 ? n : 63), *list);
        status st = view_options_set(view, key, text);
        if (st)
            return st;
        const char end = (*list)[n];
        *list += n + (end != 0);
        if (end != ':')
            return ST_OK;
    }
}

static status name_outputs(const render_options *o, bool many, int index, script_frame *frame) {
    status st = ST_OK;
    for (int i = 0; i < FRAME_FILES && st == ST_OK; i++) {
        const char *name = i == FRAME_PICTURE ? o->common.output : o->files[i];
        frame->file[i][0] = 0;
        if (name && many && strcmp(name, "-") != 0) /* "-" takes all pictures in turn */
            st = sequence_name(name, index, frame->file[i], SCRIPT_PATH_MAX);
        else if (name &&
                 (size_t)snprintf(frame->file[i], SCRIPT_PATH_MAX, "%s", name) >= SCRIPT_PATH_MAX)
            st = status_describe(ST_USAGE, "the name of a file is too long");
    }
    return st;
}

static int64_t steps_of(const render_options *o) {
    return step_list_given(&o->steps) ? (int64_t)step_list_count(&o->steps) : 1;
}

static int turns_of(const render_options *o) {
    return o->turns ? o->turns : 1;
}

/* Describe picture `number` of the command line. Isovalues are the outermost loop, then steps,
 * views, turns. Call it in order of `number`, since it consumes the list of isovalues. */
static status describe_frame(const render_options *o, sequence *s, int number,
                             script_frame *frame) {
    const int views = s->path ? (int)json_array_size(s->path) : 1;
    const int index = number / turns_of(o);
    const bool next = number % (turns_of(o) * views * steps_of(o)) == 0;
    status st = ST_OK;
    if (number == 0)
        s->isos = o->iso_list;
    view_options isos = next ? o->view : frame->view;
    if (o->iso_list && next)
        st = next_isos(&s->isos, &isos);
    /* Every entry of the path starts from the command line. */
    frame->view = o->view;
    memcpy(frame->view.surfaces, isos.surfaces, sizeof isos.surfaces);
    frame->view.isos = isos.isos;
    if (step_list_given(&o->steps))
        frame->view.step = step_list_at(&o->steps, (uint64_t)(index / views % steps_of(o)));
    if (st == ST_OK && s->path) {
        char what[64];
        snprintf(what, sizeof what, "--camera-path: entry %d", index % views + 1);
        st = script_apply(frame, json_array_get(s->path, (size_t)(index % views)), what);
    }
    if (st == ST_OK)
        st = name_outputs(o, is_sequence(o), number, frame);
    return st;
}

/* Load the entries of the camera path and, with --frames, interpolate between them. */
static status load_path(const render_options *o, json_t **path) {
    json_t *keys = NULL;
    status st = script_load_path(o->camera_path, &keys);
    if (st != ST_OK || !o->frames) {
        *path = keys;
        return st;
    }
    st = keyframes_spread(keys, o->frames, path);
    json_decref(keys);
    return st;
}

static status count_frames(const render_options *o, sequence *s) {
    int64_t count = 1;
    for (const char *at = o->iso_list ? o->iso_list : ""; *at; at++)
        count += *at == ',';
    status st = o->camera_path ? load_path(o, &s->path) : ST_OK;
    if (st != ST_OK)
        return st;
    /* No overflow: each factor is below 2^31, and the loop ends at a product that is too large. */
    const int64_t factors[] = {steps_of(o), turns_of(o),
                               s->path ? (int64_t)json_array_size(s->path) : 1};
    for (size_t i = 0; i < sizeof factors / sizeof *factors && count <= PICTURES_MAX; i++)
        count *= factors[i];
    if (count > PICTURES_MAX)
        return status_describe(ST_USAGE,
                               "%lld pictures or more are more than %d, the most of one run",
                               (long long)count, PICTURES_MAX);
    s->count = (int)count;
    return ST_OK;
}

/* Register the input files; outputs are compared with them. */
static status guard_inputs(const render_options *o) {
    file_guard_watch();
    status st = file_guard_input(o->common.input);
    if (st == ST_OK)
        st = file_guard_input(o->camera_path);
    if (st == ST_OK)
        st = file_guard_input(o->state);
    if (st == ST_OK)
        st = file_guard_input(o->font);
    return st == ST_OK ? file_guard_input(o->script) : st;
}

/* Check that the outputs of one picture and the statistics are different files. Pictures of a
 * sequence differ by number. A line of a script may replace another's picture, with --force. */
static status guard_frame(const render_options *o, const script_frame *frame) {
    file_guard_next();
    status st = file_guard_output(o->stats);
    for (int i = 0; i < FRAME_FILES && st == ST_OK; i++)
        if (frame->file[i][0])
            st = file_guard_output(frame->file[i]);
    return st;
}

static status check_sequence(const render_options *o, const render_job *job, sequence *s,
                             script_frame *frame) {
    status st = ST_OK;
    for (int i = 0; i < s->count && st == ST_OK; i++) {
        st = describe_frame(o, s, i, frame);
        if (st == ST_OK)
            st = guard_frame(o, frame);
        if (st == ST_OK)
            st = render_job_check(job, frame);
    }
    return st;
}

static status draw_sequence(render_options *o, render_job *job, sequence *s, script_frame *frame,
                            json_t *all) {
    status st = ST_OK;
    for (int i = 0; i < s->count && st == ST_OK; i++) {
        json_t *stats = NULL;
        job->share = 1.0 / s->count;
        job->done = i * job->share;
        st = describe_frame(o, s, i, frame);
        if (st == ST_OK)
            st = render_job_check(job, frame);
        if (st == ST_OK && o->turns)
            render_job_turn(job, &frame->view, (double)(i % o->turns) / o->turns);
        if (st == ST_OK)
            st = draw(o, job, frame, &stats);
        if (st == ST_OK && o->common.json && is_sequence(o))
            st = cli_print_json(&o->common, json_incref(stats));
        if (stats)
            json_array_append_new(all, stats);
    }
    if (st == ST_OK && o->common.json && !is_sequence(o))
        st = cli_print_json(&o->common, json_incref(json_array_get(all, 0)));
    if (st || !s->stats)
        return st;
    json_t *frames =
        is_sequence(o) ? json_pack("{s:O}", "frames", all) : json_incref(json_array_get(all, 0));
    st = write_stats(s->stats, frames);
    s->stats = NULL;
    json_decref(frames);
    return st;
}

/* Refuse, before the first picture is drawn, flags that have no effect on this file. */
static status check_file(const render_options *o, const render_job *job) {
    const bool mesh = strcmp(job->info.kind, "mesh") == 0;
    const struct {
        bool given;
        const char *name;
    } of_meshes[] = {{o->experiments.packets != 0, "--packets"},
                     {o->experiments.isopolygons != 0, "--isopolygons"},
                     {o->traversal != 0, "--traversal"},
                     {o->experiments.schema != 0, "--schema"}};
    for (size_t i = 0; i < sizeof of_meshes / sizeof *of_meshes; i++)
        if (of_meshes[i].given && !mesh)
            return status_describe(ST_USAGE, "%s is for meshes, and %s is a %s", of_meshes[i].name,
                                   o->common.input, job->info.kind);
    if (o->experiments.schema != 0 && job->info.steps == 1)
        return status_describe(ST_USAGE, "--schema: %s has one step", o->common.input);
    return ST_OK;
}

/* Open the file, if it is not open, and settle --steps: "all" depends on the file's steps. */
static status settle_steps(render_options *o, render_job *job) {
    status st = job->volume ? ST_OK : render_job_open(job, o->common.input, &o->open);
    return st == ST_OK ? step_list_settle(&o->steps, "--steps", o->common.input, job->info.steps)
                       : st;
}

static status run_sequence(render_options *o, render_job *job) {
    static script_frame frame;
    sequence s = {0};
    json_t *all = json_array();
    mem_init(&s.m, 0);
    status st = o->steps.all ? settle_steps(o, job) : ST_OK;
    if (st == ST_OK)
        st = count_frames(o, &s);
    if (st == ST_OK)
        st = check_sequence(o, job, &s, &frame);
    if (st == ST_OK)
        st = settle_steps(o, job);
    if (st == ST_OK)
        st = check_file(o, job);
    if (st == ST_OK && o->stats)
        st = out_file_create(&s.m, o->stats, o->common.force, &s.stats);
    if (st == ST_OK)
        st = draw_sequence(o, job, &s, &frame, all);
    out_file_discard(s.stats);
    json_decref(all);
    json_decref(s.path);
    return st;
}

/* ---- scripts ---- */

static status check_line(const script_frame *frame) {
    for (int i = 0; i < FRAME_FILES; i++)
        if (to_stdout(frame->file[i]))
            return status_describe(ST_USAGE, "standard output is for a script's answers");
    return ST_OK;
}

static status answer_line(render_options *o, render_job *job, const char *text, size_t size,
                          long number, bool *failed) {
    static script_frame frame;
    char what[32];
    json_t *answer = NULL;
    snprintf(what, sizeof what, "line %ld", number);
    frame.view = o->view;
    for (int i = 0; i < FRAME_FILES; i++)
        frame.file[i][0] = 0;
    status st = script_parse(&frame, text, size, what);
    if (st == ST_OK)
        st = check_line(&frame);
    if (st == ST_OK)
        st = guard_frame(o, &frame);
    if (st == ST_OK)
        st = render_job_check(job, &frame);
    if (st == ST_OK)
        st = draw(o, job, &frame, &answer);
    if (st == ST_STOPPED)
        return st;
    if (st) {
        /* One bad line does not end the run. */
        *failed = true;
        cli_note(&o->common, 0, "%s", status_text());
        answer = cli_error_json(st);
    }
    json_object_set_new(answer, "line", json_integer(number));
    return cli_print_json(&o->common, answer);
}

static status run_script(render_options *o, render_job *job) {
    mem m;
    script_reader *script = NULL;
    bool failed = false;
    mem_init(&m, 0);
    status st = render_job_open(job, o->common.input, &o->open);
    if (st == ST_OK)
        st = check_file(o, job);
    if (st == ST_OK)
        st = script_open(&m, o->script, &script);
    while (st == ST_OK) {
        const char *line = NULL;
        size_t size = 0;
        long number = 0;
        st = script_line(script, job->watch->stop, job->watch->ctx, &line, &size, &number);
        if (st || !line)
            break;
        st = answer_line(o, job, line, size, number, &failed);
    }
    script_close(script);
    if (st == ST_OK && failed)
        st = status_describe(ST_FAILED, "not every line could be drawn");
    return st;
}

static status check_empty(const render_options *o) {
    if (!o->fail_empty || o->empty == 0)
        return ST_OK;
    if (o->drawn == 1)
        return status_describe(ST_FAILED, "the picture shows no surface");
    return status_describe(ST_FAILED, "%d of %d pictures show no surface", o->empty, o->drawn);
}

/* Returns whether meshes need to know which tets are neighbours. */
static bool by_faces(const render_options *o) {
    bool filled = view_options_filled(&o->view);
    for (int i = 0; i < o->also_count; i++)
        filled |= view_options_filled(&o->also[i].view);
    return o->traversal ? o->traversal == 2 : filled && !o->experiments.isopolygons;
}

static const output_kind *output(const void *own) {
    static output_kind pictures = {.what = "a picture"};
    const render_options *o = own;
    pictures.suffixes = image_out_suffixes(o->format);
    pictures.sequence = is_sequence(o);
    return &pictures;
}

int main(int argc, char **argv) {
    static render_options o = {
        .common = {.verb = "render"},
        .open = {.size = sizeof(leafcast_options), .experiments = &o.experiments},
        .experiments = {.size = sizeof(leafcast_experiments)},
        .repeat = 1};
    struct argp_option options[VIEW_OPTIONS_ROOM];
    view_options_join(
        options, OPTIONS, true,
        "iso colour opacity tf colour-map project size eye look-at light shadows clip-box");
    const cli_verb verb = {
        .options = options,
        .set_option = set_option,
        .check = check_options,
        .output = output,
        .input = "treelet file",
        .args_doc = "F.leaf -o FILE.png",
        .doc = "Draw isosurfaces of a treelet file, or see through it, into a picture.\v"
               "Example:\n  leafcast render bonsai.leaf --iso 37 -o bonsai.png\v"
               "Without --iso, media and --project it draws the isosurface that the histogram in "
               "the file suggests, and says which. Without --eye the view fits what the isovalues "
               "make active: up is +z, "
               "the longer of the other sides lies across. --view standard and close look at the "
               "middle of the volume from the direction "
               "(1, 0.6, 0.8), 2.2 or 1.1 times its longest edge away. Vectors "
               "are in world space. The picture is exact unless --lod, --preview or --intersector "
               "say otherwise. A mesh of tetrahedra has no levels of detail and no intersector but "
               "the exact one."};
    view_options_init(&o.view);
    o.view.takes_media = true;
    cli_parse(&verb, &o.common, argc, argv);

    o.open.memory = o.common.memory;
    o.open.threads = o.common.threads;
    o.open.neighbours = by_faces(&o);
    render_job job = {.repeat = o.repeat,
                      .certify = o.certify,
                      .font = o.font,
                      .also = o.also,
                      .also_count = o.also_count,
                      .watch = cli_progress(&o.common)};
    job.out = (image_out_options){.force = o.common.force,
                                  .threads = o.common.threads,
                                  .format = o.format,
                                  .stop = job.watch->stop,
                                  .ctx = job.watch->ctx};
    o.common.json_lines = o.script || is_sequence(&o);
    status st = status_note_raise(&o.state_read);
    if (st == ST_OK)
        st = guard_inputs(&o);
    if (st == ST_OK)
        st = o.script ? run_script(&o, &job) : run_sequence(&o, &job);
    if (st == ST_OK)
        st = check_empty(&o);
    render_job_close(&job);
    return cli_finish(&o.common, st);
}
