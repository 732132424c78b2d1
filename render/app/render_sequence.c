#include "render/app/render_sequence.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/sequence.h"
#include "render/app/key_times.h"
#include "render/app/keyframes.h"
#include "render/app/render_ahead.h"
#include "render/app/render_picture.h"

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
    frame->view.is_surface = isos.is_surface;
    if (step_list_given(&o->steps))
        frame->view.step = step_list_at(&o->steps, (uint64_t)(index / views % steps_of(o)));
    if (st == ST_OK && s->path) {
        char what[SCRIPT_PATH_MAX];
        snprintf(what, sizeof what, "%s: entry %d", o->camera_path, index % views + 1);
        st = script_apply(frame, json_array_get(s->path, (size_t)(index % views)), what);
    }
    if (st == ST_OK)
        st = name_outputs(o, render_options_many(o), number, frame);
    return st;
}

/* Find the field and step that picture `number` shows, or the time between steps, in *view. Returns
 * false if it is refused when it is drawn. */
static bool find_moment(const render_options *o, const sequence *s, const render_job *job,
                        int number, view_options *view) {
    const size_t views = s->path ? json_array_size(s->path) : 1;
    const size_t index = (size_t)(number / turns_of(o));
    *view = o->view;
    if (s->path && !script_foresee(view, json_array_get(s->path, index % views)))
        return false;
    if (step_list_given(&o->steps))
        view->step = step_list_at(&o->steps, index / views % (uint64_t)steps_of(o));
    return time_options_find(&view->time, job->volume, &view->step) == ST_OK;
}

/* Say before a picture is drawn what comes next. */
static void expect_next(const render_options *o, const sequence *s, const render_job *job,
                        int number, const script_frame *frame) {
    enum { LOOK_AHEAD = 256 };
    static view_options next;
    render_ahead ahead = {.volume = job->volume, .now = &frame->view};
    for (int i = number + 1; i < s->count && i <= number + LOOK_AHEAD; i++)
        if (!find_moment(o, s, job, i, &next) || !render_ahead_note(&ahead, &next))
            return;
}

/* Open the file, if it is not open. */
static status open_file(const render_options *o, render_job *job) {
    return job->volume ? ST_OK : render_job_open(job, o->common.input, &o->open);
}

/* Settle --steps: "all" depends on the file's steps. */
static status settle_steps(render_options *o, render_job *job) {
    const status st = open_file(o, job);
    return st == ST_OK ? step_list_settle(&o->steps, "--steps", o->common.input, job->info.steps)
                       : st;
}

/* Interpolate between the entries of the camera path, with --frames. */
static status spread_path(const render_options *o, json_t **path) {
    json_t *keys = *path;
    if (!o->frames)
        return ST_OK;
    *path = NULL;
    const status st = keyframes_spread(keys, o->camera_path, o->frames, path);
    json_decref(keys);
    return st;
}

/* The time of --step or --time, which entries have before the first one that says its own. */
static status first_time(const render_options *o, const leafcast *volume, double *time) {
    const uint32_t steps = leafcast_describe(volume).steps;
    time_options at = o->view.time;
    uint32_t step = o->view.step;
    const status st = at.given ? time_options_find(&at, volume, &step) : ST_OK;
    if (st == ST_OK && step >= steps)
        return status_describe(ST_USAGE, "--step %u: there are steps 0 to %u", step, steps - 1);
    if (st == ST_OK)
        *time = at.given ? at.time : leafcast_step_time(volume, step);
    return st;
}

/* Load the camera path. Which step a time is, the file says. */
static status load_path(const render_options *o, render_job *job, json_t **path) {
    status st = script_load_path(o->camera_path, path);
    if (st == ST_OK && step_list_given(&o->steps))
        st = key_times_none(*path, o->camera_path, "--steps says the steps");
    if (st != ST_OK || !key_times_any(*path))
        return st == ST_OK ? spread_path(o, path) : st;
    double first = 0.0;
    st = open_file(o, job);
    if (st == ST_OK)
        st = first_time(o, job->volume, &first);
    if (st == ST_OK)
        st = key_times_unify(*path, o->camera_path, job->volume, first);
    if (st == ST_OK)
        st = spread_path(o, path);
    /* With --interpolate, times between steps are drawn themselves. */
    return st == ST_OK && !o->view.time.interpolate ? key_times_settle(*path, job->volume) : st;
}

static status count_frames(const render_options *o, render_job *job, sequence *s) {
    int64_t count = 1;
    for (const char *at = o->iso_list ? o->iso_list : ""; *at; at++)
        count += *at == ',';
    status st = o->camera_path ? load_path(o, job, &s->path) : ST_OK;
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

static status check_sequence(const render_options *o, const render_job *job, sequence *s,
                             script_frame *frame) {
    status st = ST_OK;
    for (int i = 0; i < s->count && st == ST_OK; i++) {
        st = describe_frame(o, s, i, frame);
        if (st == ST_OK)
            st = render_picture_guard(o, frame);
        if (st == ST_OK)
            st = render_job_check(job, frame);
    }
    return st;
}

static status draw_sequence(const render_options *o, render_job *job, sequence *s,
                            script_frame *frame, json_t *all) {
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
            expect_next(o, s, job, i, frame);
        if (st == ST_OK)
            st = render_picture_draw(o, job, frame, &stats);
        if (st == ST_OK && o->common.json && render_options_many(o))
            st = cli_print_json(&o->common, json_incref(stats));
        if (stats)
            json_array_append_new(all, stats);
    }
    if (st == ST_OK && o->common.json && !render_options_many(o))
        st = cli_print_json(&o->common, json_incref(json_array_get(all, 0)));
    if (st || !s->stats)
        return st;
    json_t *frames = render_options_many(o) ? json_pack("{s:O}", "frames", all)
                                            : json_incref(json_array_get(all, 0));
    st = write_stats(s->stats, frames);
    s->stats = NULL;
    json_decref(frames);
    return st;
}

status render_sequence_run(render_options *o, render_job *job) {
    static script_frame frame;
    sequence s = {0};
    json_t *all = json_array();
    mem_init(&s.m, 0);
    status st = o->steps.all ? settle_steps(o, job) : ST_OK;
    if (st == ST_OK)
        st = count_frames(o, job, &s);
    if (st == ST_OK)
        st = check_sequence(o, job, &s, &frame);
    if (st == ST_OK)
        st = settle_steps(o, job);
    if (st == ST_OK)
        st = render_options_check_file(o, &job->info);
    if (st == ST_OK && o->stats)
        st = out_file_create(&s.m, o->stats, o->common.force, &s.stats);
    if (st == ST_OK)
        st = draw_sequence(o, job, &s, &frame, all);
    out_file_discard(s.stats);
    json_decref(all);
    json_decref(s.path);
    return st;
}
