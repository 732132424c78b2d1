#include "render/app/render_picture.h"

#include <string.h>

#include "formats/base/file_guard.h"
#include "formats/base/num.h"

/* ---- one picture ---- */

/* The range of the values drawn. Of a time between steps: that of both, which holds it. Returns
 * false if there is none. */
static bool range_of(const render_job *job, double range[2]) {
    double next[2];
    if (leafcast_range(job->volume, job->field, job->step, range) != LEAFCAST_OK)
        return false;
    if (job->between == 0.0)
        return true;
    if (leafcast_range(job->volume, job->field, job->step + 1, next) != LEAFCAST_OK)
        return false;
    range[0] = next[0] < range[0] ? next[0] : range[0];
    range[1] = next[1] > range[1] ? next[1] : range[1];
    return true;
}

/* Note isovalues that have no surface in what is drawn. Returns whether any may have one. */
static bool say_absent(const render_options *o, const render_job *job, const view_options *view) {
    char value[NUM_TEXT_MAX], lo[NUM_TEXT_MAX], hi[NUM_TEXT_MAX];
    double range[2];
    bool any = false;
    if (view->is_surface || !range_of(job, range))
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

static void say_empty(const render_options *o, render_job *job, const view_options *view,
                      const leafcast_stats *t) {
    const bool any = say_absent(o, job, view);
    const char *what = view->is_surface ? "nothing in the picture: the surface is"
                                        : "no surface in the picture: there is one, but";
    /* A pixel that is provisional may have one. */
    if (t->covered_pixels > 0 || t->provisional_pixels > 0 || view_options_any_filled(view))
        return;
    job->empty++;
    if (any)
        cli_note(&o->common, 1, "%s outside of the camera's view, or clipped away", what);
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

static void say_lacking(const render_options *o, const leafcast_stats *t) {
    cli_note(&o->common, 0,
             "%llu treelets are lost, the first as %s; %llu pixels, marked, show coarser data or "
             "nothing in their place",
             (unsigned long long)t->treelets_lost, t->lost_why,
             (unsigned long long)t->provisional_pixels);
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
    if (s->first_s > 0.0)
        cli_note(&o->common, 1, "first picture in %.3g s: %llu pixels were provisional", s->first_s,
                 (unsigned long long)s->first_provisional);
    if (t->treelets_lost && t->provisional_pixels)
        say_lacking(o, t);
    else if (t->provisional_pixels && t->provisional_error_most > 0.0)
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

status render_picture_draw(const render_options *o, render_job *job, const script_frame *frame,
                           json_t **stats) {
    render_stats s;
    say_suggested(o, frame);
    say_aside(o, job, frame);
    status st = render_job_draw(job, frame, &s);
    if (st)
        return st;
    job->drawn++;
    job->lacking += s.trace.treelets_lost > 0 && s.trace.provisional_pixels > 0;
    say_empty(o, job, &frame->view, &s.trace);
    say_done(o, frame, &s);
    *stats = render_stats_json(&s, &frame->view, frame->file[FRAME_PICTURE]);
    return ST_OK;
}

status render_picture_guard(const render_options *o, const script_frame *frame) {
    file_guard_next();
    status st = file_guard_output(o->stats);
    for (int i = 0; i < FRAME_FILES && st == ST_OK; i++)
        if (frame->file[i][0])
            st = file_guard_output(frame->file[i]);
    return st;
}
