/* render_main.c - leafcast render: draw pictures of isosurfaces and media. */
#include <stdio.h>

#include "formats/base/file_guard.h"
#include "render/app/render_ahead.h"
#include "render/app/render_picture.h"
#include "render/app/render_sequence.h"
#include "render/app/scene_file.h"

/* Register the input files; outputs are compared with them. */
static status guard_inputs(const render_options *o, const char *scene) {
    const char *const inputs[] = {scene,    o->common.input, o->camera_path,
                                  o->state, o->font,         o->script};
    status st = ST_OK;
    file_guard_watch();
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs && st == ST_OK; i++)
        st = file_guard_input(inputs[i]);
    return st;
}

static status check_line(const script_frame *frame) {
    for (int i = 0; i < FRAME_FILES; i++)
        if (output_name_is_stdout(frame->file[i]))
            return status_describe(ST_USAGE, "standard output is for a script's answers");
    return ST_OK;
}

/* Say before a line's picture is drawn what the lines show that have come behind it. */
static void expect_lines(const render_options *o, const render_job *job, const script_frame *frame,
                         const script_reader *script) {
    enum { LOOK_AHEAD = 64 };
    static view_options next;
    render_ahead ahead = {.volume = job->volume, .now = &frame->view};
    const char *line;
    size_t size, at = 0;
    bool more = job->info.steps > 1;
    for (int i = 0; i < LOOK_AHEAD && more && script_peek(script, &at, &line, &size); i++) {
        next = o->view;
        if (script_foresee_line(&next, line, size) &&
            time_options_find(&next.time, job->volume, &next.step) == ST_OK)
            more = render_ahead_note(&ahead, &next);
    }
}

static status answer_line(const render_options *o, render_job *job, const script_reader *script,
                          const char *text, size_t size, long number, bool *failed) {
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
        st = render_picture_guard(o, &frame);
    if (st == ST_OK)
        st = render_job_check(job, &frame);
    if (st == ST_OK)
        expect_lines(o, job, &frame, script);
    if (st == ST_OK)
        st = render_picture_draw(o, job, &frame, &answer);
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

static status run_script(const render_options *o, render_job *job) {
    mem m;
    script_reader *script = NULL;
    bool failed = false;
    mem_init(&m, 0);
    status st = render_job_open(job, o->common.input, &o->open);
    if (st == ST_OK)
        st = render_options_check_file(o, &job->info);
    if (st == ST_OK)
        st = script_open(&m, o->script, &script);
    while (st == ST_OK) {
        const char *line = NULL;
        size_t size = 0;
        long number = 0;
        st = script_line(script, job->watch->stop, job->watch->ctx, &line, &size, &number);
        if (st || !line)
            break;
        st = answer_line(o, job, script, line, size, number, &failed);
    }
    script_close(script);
    if (st == ST_OK && failed)
        st = status_describe(ST_FAILED, "not every line could be drawn");
    return st;
}

static status check_empty(const render_options *o, const render_job *job) {
    if (!o->fail_empty || job->empty == 0)
        return ST_OK;
    if (job->drawn == 1)
        return status_describe(ST_FAILED, "the picture shows no surface");
    return status_describe(ST_FAILED, "%d of %d pictures show no surface", job->empty, job->drawn);
}

static status check_lacking(const render_job *job) {
    if (job->lacking == 0)
        return ST_OK;
    return status_describe(ST_FAILED,
                           "%d of %d pictures lack treelets that are damaged: `leafcast verify' "
                           "tells where; with --repair COPY it mends a treelet file, not an input "
                           "in which samples were left",
                           job->lacking, job->drawn);
}

static const output_kind *output(const void *own) {
    static output_kind pictures = {.what = "a picture"};
    const render_options *o = own;
    pictures.suffixes = image_out_suffixes(o->format);
    pictures.sequence = render_options_many(o);
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
        options, render_options_table, true,
        "iso colour opacity tf colour-map project size eye look-at light shadows clip-box");
    const cli_verb verb = {
        .options = options,
        .set_option = render_options_set,
        .check = render_options_check,
        .output = output,
        .input = "treelet file",
        .args_doc = "F.leaf -o FILE.png",
        .doc = "Draw isosurfaces of a treelet file, or see through it, into a picture.\v"
               "Example:\n  leafcast render bonsai.leaf --iso 37 -o bonsai.png\v"
               "In place of F.leaf, a scene file in JSON lists many objects, and where they are: "
               "leafcast-scene(5). "
               "Without --iso, media and --project it draws the isosurface that the histogram in "
               "the file suggests, and says which. Without --eye the view fits what the isovalues "
               "make active: up is +z, "
               "the longer of the other sides lies across. --view standard and close look at the "
               "middle of the volume from the direction "
               "(1, 0.6, 0.8), 2.2 or 1.1 times its longest edge away. Vectors "
               "are in world space. The picture is exact unless --lod, --preview or --intersector "
               "say otherwise. Meshes and curvilinear grids have levels of detail in previews "
               "alone (convert --coarse), and no intersector but the exact one."};
    view_options_init(&o.view);
    o.view.takes_media = true;
    cli_parse(&verb, &o.common, argc, argv);

    const char *const scene = o.common.input;
    const status loaded =
        o.common.input && scene_file_is(o.common.input) ? scene_file_load(&o) : ST_OK;
    status_note_take(&o.scene_read,
                     o.follow_links && !o.scene && loaded == ST_OK
                         ? status_describe(ST_USAGE, "--follow-links is of scene files")
                         : loaded);
    o.open.memory = o.common.memory;
    o.open.threads = o.common.threads;
    o.open.neighbours = render_options_neighbours(&o);
    render_job job = {.repeat = o.repeat,
                      .certify = o.certify,
                      .progressive = o.progressive,
                      .font = o.font,
                      .also = o.also,
                      .also_count = o.also_count,
                      .places = o.places,
                      .group = o.group,
                      .groups = o.groups,
                      .group_count = o.group_count,
                      .fits_all = o.scene,
                      .watch = cli_progress(&o.common)};
    job.out = (image_out_options){.force = o.common.force,
                                  .threads = o.common.threads,
                                  .format = o.format,
                                  .stop = job.watch->stop,
                                  .ctx = job.watch->ctx};
    o.common.json_lines = o.script || render_options_many(&o);
    status st = status_note_raise(&o.state_read);
    if (st == ST_OK)
        st = status_note_raise(&o.scene_read);
    if (st == ST_OK)
        st = guard_inputs(&o, scene);
    if (st == ST_OK)
        st = o.script ? run_script(&o, &job) : render_sequence_run(&o, &job);
    if (st == ST_OK)
        st = check_empty(&o, &job);
    if (st == ST_OK)
        st = check_lacking(&job);
    render_job_close(&job);
    render_options_release(&o);
    return cli_finish(&o.common, st);
}
