#include "render/app/render_job.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/box3.h"
#include "formats/base/clock.h"
#include "formats/base/file.h"
#include "formats/base/num.h"
#include "formats/base/output_name.h"
#include "formats/base/printed_file.h"
#include "render/app/lost_marks.h"
#include "render/app/render_groups.h"
#include "render/app/transfer_file.h"
#include "render/app/view_camera.h"
#include "render/look/camera.h"

enum { META_TEXT_MAX = 1024, NOTES_MAX = 16 };

status render_status(leafcast_status st) {
    return (status)st;
}

/* Use the axes of the first volume that names them for the volumes that follow. */
static void choose_world(leafcast_options *options, const leafcast *volume) {
    if (options->axes == LEAFCAST_AXES_FILE)
        options->axes = leafcast_describe(volume).axes;
}

/* Open a file; too little memory for it names it, as other errors do. */
static status open_volume(const char *path, const leafcast_options *on, leafcast **volume) {
    char why[STATUS_TEXT_MAX];
    const status st = render_status(leafcast_open(path, on, volume));
    if (st != ST_NOMEM || strstr(status_text(), path))
        return st;
    snprintf(why, sizeof why, "%s", status_text());
    return status_describe(st, "%s does not fit: %s", path, why);
}

/* Open all volumes on one device, which closes with them. */
static status open_volumes(render_job *job, const char *path, const leafcast_options *options) {
    leafcast_options on = *options;
    status st = render_status(leafcast_device_create(options, &on.device));
    on.memory = 0;
    on.threads = 0;
    on.isa = NULL;
    if (st == ST_OK)
        st = open_volume(path, &on, &job->volume);
    if (st == ST_OK)
        choose_world(&on, job->volume);
    for (int i = 0; i < job->also_count && st == ST_OK; i++) {
        render_also *also = &job->also[i];
        if (also->same >= 0)
            continue;
        st = open_volume(also->path, &on, &also->volume);
        if (st == ST_OK)
            choose_world(&on, also->volume);
    }
    for (int i = 0; i < job->also_count && st == ST_OK; i++) {
        const int same = job->also[i].same;
        if (same >= 0)
            job->also[i].volume = same == 0 ? job->volume : job->also[same - 1].volume;
    }
    leafcast_device_destroy(on.device);
    return st;
}

static int places_of(const render_places *p) {
    return p->count > 0 ? p->count : 1;
}

/* List a volume at its places. */
static void list_places(render_job *job, leafcast *volume, const view_options *view,
                        const render_places *p, int group) {
    for (int i = 0; i < places_of(p); i++)
        job->objects[job->object_count++] =
            (picture_volume){volume, view, p->count > 0 ? p->at + 12 * (size_t)i : NULL, group};
}

status render_job_list(render_job *job) {
    job->object_count = 0;
    size_t count = (size_t)places_of(&job->places);
    for (int i = 0; i < job->also_count; i++)
        count += (size_t)places_of(&job->also[i].places);
    if (count > LEAFCAST_VOLUMES_MAX)
        return status_describe(ST_USAGE, "%zu objects: a picture has at most %d", count,
                               LEAFCAST_VOLUMES_MAX);
    job->objects = mem_array(&job->m, count, sizeof *job->objects);
    if (!job->objects)
        return ST_NOMEM;
    list_places(job, job->volume, NULL, &job->places, job->group);
    for (int i = 0; i < job->also_count; i++)
        list_places(job, job->also[i].volume, &job->also[i].view, &job->also[i].places,
                    job->also[i].group);
    return ST_OK;
}

void render_job_unlist(render_job *job) {
    mem_free(&job->m, job->objects);
    job->objects = NULL;
}

status render_job_open(render_job *job, const char *path, const leafcast_options *options) {
    mem_init(&job->m, 0);
    picture_scene_init(&job->scene, &job->m);
    job->scene.opens = true;
    job->source = path;
    status st = open_volumes(job, path, options);
    if (st == ST_OK)
        st = render_job_list(job);
    if (st == ST_OK && job->group_count > 0)
        st = render_groups_place(job);
    job->scene.groups = job->placed;
    job->scene.group_count = job->group_count;
    if (st == ST_OK)
        job->info = leafcast_describe(job->volume);
    if (st == ST_OK)
        st = image_out_open(&job->m, &job->out, &job->files);
    return st;
}

static void release_planes(render_job *job) {
    leafcast_image *i = &job->image;
    void *const planes[] = {i->r,         i->g,         i->b,          i->a,  i->z,
                            i->normal[0], i->normal[1], i->normal[2],  i->id, i->rgba,
                            i->error,     i->value,     i->provisional};
    for (size_t p = 0; p < sizeof planes / sizeof *planes; p++)
        mem_free(&job->m, planes[p]);
    *i = (leafcast_image){.size = sizeof(leafcast_image)};
}

void render_job_close(render_job *job) {
    release_planes(job);
    picture_scene_release(&job->scene);
    text_face_close(job->face);
    job->face = NULL;
    image_out_close(job->files);
    job->files = NULL;
    render_job_unlist(job);
    render_groups_release(job);
    for (int i = 0; i < job->also_count; i++) {
        if (job->also[i].same < 0)
            leafcast_close(job->also[i].volume);
        job->also[i].volume = NULL;
    }
    leafcast_close(job->volume);
    job->volume = NULL;
}

/* ---- before anything is drawn ---- */

/* Choose what the other volumes show, once they are open. */
static status choose_also(const render_job *job, const view_options *first) {
    double suggested[LEAFCAST_SUGGESTIONS_MAX];
    int count;
    status st = ST_OK;
    for (int i = 0; i < job->also_count && job->volume && st == ST_OK; i++) {
        view_options *v = &job->also[i].view;
        v->scene.project = first->scene.project;
        if (job->also[i].same == 0) { /* one field and step for all objects of a volume */
            memcpy(v->field, first->field, sizeof v->field);
            v->step = first->step;
            v->time = first->time;
        }
        st = picture_scene_choose(job->also[i].volume, v, suggested, &count);
        if (st == ST_OK)
            st = picture_scene_check_used(job->also[i].volume, v);
    }
    return st;
}

/* Check the flags of the other volumes. Default colours continue behind those of the volume
 * before. */
static status check_also(const render_job *job, const view_options *first) {
    int painted = first->isos;
    status st = ST_OK;
    for (int i = 0; i < job->also_count && job->volume && st == ST_OK; i++) {
        view_options *v = &job->also[i].view;
        v->painted = painted;
        st = view_options_check(v);
        painted += v->isos;
    }
    return st;
}

/* Note in the first volume's flags what the other volumes show. */
static void note_others(const render_job *job, view_options *first) {
    const bool projected = first->scene.project != LEAFCAST_PROJECT_NONE;
    int reflect = first->reflect_bounces, refract = first->refract_bounces;
    bool bends = first->refracts > 0;
    for (int i = 0; i < job->also_count; i++) {
        const view_options *v = &job->also[i].view;
        const bool filled = view_options_medium(v);
        first->others_transparent |= view_options_transparent(v);
        first->others_surfaces |= v->isos > 0 || (!filled && !projected);
        first->others_filled |= filled;
        first->others_coloured |= view_options_coloured(v);
        reflect = v->reflect_bounces > reflect ? v->reflect_bounces : reflect;
        refract = v->refract_bounces > refract ? v->refract_bounces : refract;
        bends |= v->refracts > 0;
    }
    first->scene.bounces = view_options_bounces(reflect, refract, bends);
}

/* Refuse output files for planes that the picture does not have. */
static status check_planes(const script_frame *frame) {
    const view_options *v = &frame->view;
    if (frame->file[FRAME_RAW + IMAGE_ERROR][0] && !view_options_any_medium(v))
        return status_describe(ST_USAGE, "--error-f64 is of media: --tf, --colour-map or "
                                         "--opacity V:A");
    if (frame->file[FRAME_RAW + IMAGE_VALUE][0] && v->scene.project == LEAFCAST_PROJECT_NONE)
        return status_describe(ST_USAGE, "--value-f64 is of --project");
    if (frame->file[FRAME_TF][0] && !view_options_any_filled(v))
        return status_describe(ST_USAGE, "--write-tf is of media and projections: --tf, "
                                         "--colour-map, --opacity V:A or --project");
    return ST_OK;
}

static status check_files(const render_job *job, const script_frame *frame) {
    status st = check_planes(frame);
    mem m;
    mem_init(&m, 0);
    for (int i = 0; i < FRAME_FILES && st == ST_OK; i++) {
        const char *path = frame->file[i];
        if (!path[0])
            continue;
        if (i == FRAME_PICTURE)
            st = image_out_check(&job->out, path);
        else if (i == FRAME_TF)
            st = out_file_check(&m, path, job->out.force);
        else
            st = image_out_check_raw(&job->out, path);
    }
    return st;
}

status render_job_check(const render_job *job, script_frame *frame) {
    status st =
        picture_scene_choose(job->volume, &frame->view, frame->suggested, &frame->suggestions);
    if (st == ST_OK)
        st = picture_scene_check_used(job->volume, &frame->view);
    if (st == ST_OK)
        st = choose_also(job, &frame->view);
    note_others(job, &frame->view);
    if (st == ST_OK)
        st = view_options_check(&frame->view);
    if (st == ST_OK)
        st = check_also(job, &frame->view);
    if (st == ST_OK && job->certify && !view_options_any_medium(&frame->view))
        st =
            status_describe(ST_USAGE, "--certify is of media: --tf, --colour-map or --opacity V:A");
    if (st == ST_OK && job->certify && frame->view.experiments.summing != LEAFCAST_CERTIFIED)
        st = status_describe(ST_USAGE, "--certify: steps of --medium have no error that is known");
    if (st == ST_OK && job->certify && frame->view.scene.shade_media)
        st = status_describe(ST_USAGE, "--certify: what --shade-medium shades has no error that is "
                                       "known");
    if (st == ST_OK && job->certify && frame->view.scene.samples > 1)
        st = status_describe(ST_USAGE, "--certify is of one sample a pixel: without --samples");
    if (st == ST_OK && job->volume)
        st = view_options_check_volume(&frame->view, job->volume);
    return st == ST_OK ? check_files(job, frame) : st;
}

/* ---- drawing ---- */

/* Returns the planes that a picture needs, as non-NULL pointers: planes that are written, and
 * planes that the picture is made of. */
static leafcast_image planes_wanted(const render_job *job, const script_frame *frame) {
    static float any_float;
    static double any_double;
    static int32_t any_id;
    static uint8_t any_mark;
    bool raws = false, raw[IMAGE_RAWS];
    for (int i = 0; i < IMAGE_RAWS; i++)
        raws |= raw[i] = frame->file[FRAME_RAW + i][0] != 0;
    const view_options *v = &frame->view;
    const bool colour = frame->file[FRAME_PICTURE][0] || !raws;
    const bool certify = job->certify;
    const bool all = image_out_wants_all(&job->out, frame->file[FRAME_PICTURE]);
    const bool opaque = v->scene.background[3] >= 1.0f; /* then every pixel is, too */
    const bool projected = v->scene.project != LEAFCAST_PROJECT_NONE;
    float *const c = colour ? &any_float : NULL, *const n = all ? &any_float : NULL;
    return (leafcast_image){
        .size = sizeof(leafcast_image),
        .r = c,
        .g = c,
        .b = c,
        .a = all || !opaque ? c : NULL,
        .z = all || raw[IMAGE_DEPTH] || v->annotation.parts & ANNOTATE_BOX ? &any_double : NULL,
        .normal = {n, n, n},
        .id = all ? &any_id : NULL,
        .provisional = v->scene.allow_missing && colour ? &any_mark : NULL,
        .rgba = raw[IMAGE_RGBA] || certify ? &any_double : NULL,
        .error =
            raw[IMAGE_ERROR] || certify || (all && view_options_any_medium(v)) ? &any_double : NULL,
        .value = raw[IMAGE_VALUE] || (all && projected) ? &any_double : NULL};
}

/* Returns the plane as it is needed now: the existing one, a new one, or NULL. Sets *failed if
 * there is no memory. New planes are not zeroed: that would touch their pages on one thread, and a
 * picture writes every pixel.
 */
static void *plane(render_job *job, void *there, const void *wanted, size_t size, bool *failed) {
    if (there && wanted)
        return there;
    mem_free(&job->m, there);
    void *made = wanted ? mem_alloc(&job->m, (size_t)job->width * job->height * size) : NULL;
    *failed |= wanted && !made;
    return made;
}

/* Allocate the planes. They count against the treelets' budget, so check first that they fit. */
static status make_planes(render_job *job, const script_frame *frame, const leafcast_scene *scene,
                          const leafcast_camera *seen_by) {
    const leafcast_image w = planes_wanted(job, frame);
    leafcast_image *i = &job->image;
    if (job->width != seen_by->width || job->height != seen_by->height)
        release_planes(job);
    status st = render_status(leafcast_check_room(
        job->volume, scene, seen_by, &w,
        image_out_bytes(&job->out, frame->file[FRAME_PICTURE], seen_by->width)));
    if (st != ST_OK)
        return st;
    job->width = seen_by->width;
    job->height = seen_by->height;
    bool failed = false;
    i->r = plane(job, i->r, w.r, sizeof *i->r, &failed);
    i->g = plane(job, i->g, w.g, sizeof *i->g, &failed);
    i->b = plane(job, i->b, w.b, sizeof *i->b, &failed);
    i->a = plane(job, i->a, w.a, sizeof *i->a, &failed);
    i->z = plane(job, i->z, w.z, sizeof *i->z, &failed);
    for (int a = 0; a < 3; a++)
        i->normal[a] = plane(job, i->normal[a], w.normal[a], sizeof *i->normal[a], &failed);
    i->id = plane(job, i->id, w.id, sizeof *i->id, &failed);
    i->provisional = plane(job, i->provisional, w.provisional, sizeof *i->provisional, &failed);
    i->rgba = plane(job, i->rgba, w.rgba, 4 * sizeof *i->rgba, &failed);
    i->error = plane(job, i->error, w.error, sizeof *i->error, &failed);
    i->value = plane(job, i->value, w.value, sizeof *i->value, &failed);
    return failed ? ST_NOMEM : ST_OK;
}

static bool same_surfaces(const render_job *job, const view_options *view) {
    if (job->selected_count != view->isos)
        return false;
    for (int i = 0; i < view->isos; i++) {
        const leafcast_surface *a = &job->selected[i], *b = &view->surfaces[i];
        if (a->isovalue != b->isovalue || a->opacity != b->opacity ||
            memcmp(a->rgb, b->rgb, sizeof a->rgb) != 0)
            return false;
    }
    return true;
}

/* Select the isosurfaces, which sweeps the directory. Skip that if the last picture had the same
 * ones, or none is given: a scene that lists its volumes needs none. */
static status select_surfaces(render_job *job, const view_options *view) {
    if (view->isos == 0 || same_surfaces(job, view))
        return ST_OK;
    job->selected_count = 0;
    status st = render_status(leafcast_select(job->volume, view->surfaces, view->isos));
    if (st == ST_OK) {
        memcpy(job->selected, view->surfaces, sizeof job->selected);
        job->selected_count = view->isos;
    }
    return st;
}

/* Select the field and time step, unless they are selected already. */
static status select_set(render_job *job, const view_options *view) {
    uint32_t field;
    status st = view_options_field(view, job->volume, &field);
    const double between = view->time.between;
    if (st != ST_OK || (field == job->field && view->step == job->step && between == job->between))
        return st;
    st = render_status(leafcast_select_between(job->volume, field, view->step, between));
    if (st == ST_OK) {
        job->field = field;
        job->step = view->step;
        job->between = between;
    }
    return st;
}

/* A picture's part in the progress of the whole job. */
typedef struct part {
    const progress *watch;
    double done, share;
} part;

static bool report(void *ctx, double done) {
    const part *p = ctx;
    if (p->share > 0.0)
        return progress_step(p->watch, "rendering", p->done + p->share * done) == ST_OK;
    return !p->watch->stop || !p->watch->stop(p->watch->ctx);
}

const picture_volume *render_job_objects(const render_job *job, const view_options *first) {
    for (int i = 0; i < places_of(&job->places); i++)
        job->objects[i].view = first;
    return job->objects;
}

/* Open the font when a picture first needs it. */
static status open_face(render_job *job, const view_options *v) {
    const bool named = v->legend && (v->colour_by[0] || v->others_coloured);
    return (named || annotate_wanted(&v->annotation)) && !job->face
               ? text_face_open(&job->m, job->font, &job->face)
               : ST_OK;
}

static status trace(render_job *job, const leafcast_scene *scene, const leafcast_camera *seen_by,
                    leafcast_stats *median) {
    leafcast_stats *all = mem_array(&job->m, (size_t)job->repeat, sizeof *all);
    if (!all)
        return ST_NOMEM;
    status st = ST_OK;
    for (int i = 0; i < job->repeat && st == ST_OK; i++) {
        all[i].size = sizeof all[i];
        part p = {job->watch, job->done + job->share * i / job->repeat, job->share / job->repeat};
        st = render_status(leafcast_trace(job->volume, scene, seen_by, &job->image, &all[i],
                                          job->watch ? report : NULL, &p));
    }
    if (st == ST_OK)
        *median = all[render_stats_median(all, job->repeat)];
    mem_free(&job->m, all);
    return st;
}

/* ---- files ---- */

static bool several(const render_job *job) {
    return job->info.fields > 1 || job->info.steps > 1;
}

/* Metadata that describes a picture, as texts. */
typedef struct notes {
    image_meta meta[NOTES_MAX];
    char text[NOTES_MAX][META_TEXT_MAX]; /* texts of numbers */
    size_t count;
} notes;

static void note_text(notes *n, const char *key, const char *text) {
    n->meta[n->count++] = (image_meta){key, text};
}

static void note_numbers(notes *n, const char *key, const double *x, int count) {
    char *text = n->text[n->count];
    num_print_list(text, META_TEXT_MAX, x, count);
    note_text(n, key, text);
}

/* Note the medium, as far as flags describe it. */
static void note_medium(notes *n, const view_options *v) {
    const medium_options *m = &v->medium;
    double flat[2 * MEDIUM_OPACITIES_MAX];
    if (v->colour_by[0])
        note_text(n, "colour_by", v->colour_by);
    if (m->tf[0])
        note_text(n, "tf", m->tf);
    if (m->colour_map[0])
        note_text(n, "colour_map", m->colour_map);
    if (m->windowed)
        note_numbers(n, "window", m->window, 2);
    if (m->opacities > 0) {
        memcpy(flat, m->opacity, sizeof flat);
        note_numbers(n, "opacity", flat, 2 * m->opacities);
    }
    if (m->opacity_length > 0.0)
        note_numbers(n, "opacity_length", &m->opacity_length, 1);
    if (v->scene.error > 0.0)
        note_numbers(n, "error", &v->scene.error, 1);
}

/* Write the picture, with the metadata that are needed to draw it again. */
static status finish_picture(render_job *job, const script_frame *frame,
                             const leafcast_camera *seen_by, image_target *to) {
    notes n = {.count = 0};
    double isos[LEAFCAST_SURFACES_MAX];
    const double step = job->step;
    const char *slash = strrchr(job->source, '/');
    for (int i = 0; i < frame->view.isos; i++)
        isos[i] = frame->view.surfaces[i].isovalue;
    note_text(&n, "volume", slash ? slash + 1 : job->source);
    note_numbers(&n, "isovalues", isos, frame->view.isos);
    note_numbers(&n, "eye", seen_by->eye, 3);
    note_numbers(&n, "look_at", seen_by->look_at, 3);
    note_numbers(&n, "up", seen_by->up, 3);
    note_numbers(&n, "fov", &seen_by->fov, 1);
    if (several(job)) {
        note_text(&n, "field", leafcast_field_name(job->volume, job->field));
        note_numbers(&n, "step", &step, 1);
        if (job->between > 0.0)
            note_numbers(&n, "between", &job->between, 1);
    }
    note_medium(&n, &frame->view);
    const picture p = {.width = job->width,
                       .height = job->height,
                       .image = &job->image,
                       .meta = n.meta,
                       .meta_count = n.count};
    return image_out_finish(to, &p);
}

/* ---- a picture ---- */

/* Open files of a picture and its raw planes; NULL: not written. */
typedef struct targets {
    image_target *file[FRAME_TF];
} targets;

/* again: the picture replaces a first one. */
static status open_picture(render_job *job, const script_frame *frame, bool again, targets *to) {
    const char *path = frame->file[FRAME_PICTURE];
    if (!path[0])
        return ST_OK;
    return (again ? image_out_again : image_out_begin)(job->files, path, &to->file[FRAME_PICTURE]);
}

static status open_raw(render_job *job, const script_frame *frame, targets *to) {
    status st = ST_OK;
    for (int i = FRAME_RAW; i < FRAME_TF && st == ST_OK; i++)
        if (frame->file[i][0])
            st = image_out_begin_raw(job->files, frame->file[i], (image_raw)(i - FRAME_RAW),
                                     &to->file[i]);
    return st;
}

static void print_transfer(const void *ctx, FILE *out) {
    const transfer_list *t = ctx;
    transfer_file_print(t->points, t->count, out);
}

/* Write all files, the picture last. */
static status write_targets(render_job *job, const script_frame *frame,
                            const leafcast_camera *seen_by, const leafcast_scene *scene,
                            targets *to) {
    const picture raw = {.width = job->width, .height = job->height, .image = &job->image};
    const int filled = picture_scene_filled(&job->scene, scene);
    status st = ST_OK;
    if (frame->file[FRAME_TF][0] && filled >= 0)
        st = printed_file_write(&job->m, frame->file[FRAME_TF], job->out.force, print_transfer,
                                &job->scene.transfer[filled]);
    for (int i = FRAME_TF - 1; i >= 0 && st == ST_OK; i--) {
        image_target *now = to->file[i];
        to->file[i] = NULL;
        if (now)
            st = i == FRAME_PICTURE ? finish_picture(job, frame, seen_by, now)
                                    : image_out_finish(now, &raw);
    }
    return st;
}

/* Returns a view of the boxes of all objects at their places, as the flags say. *diagonal: that of
 * a box around these. */
static leafcast_camera view_of_all(const render_job *job, const view_options *view,
                                   double *diagonal) {
    double box[2][3], corners[8][3];
    render_groups_box(job, box);
    for (int k = 0; k < 8; k++)
        box3_corner(box, k, corners[k]);
    *diagonal = hypot(hypot(box[1][0] - box[0][0], box[1][1] - box[0][1]), box[1][2] - box[0][2]);
    const uint32_t width = view->camera.width, height = view->camera.height;
    return view_camera_fits(view)
               ? camera_fit((const double(*)[3])corners,
                            view->fov ? view->camera.fov : LEAFCAST_FIT_FOV, width, height)
               : camera_standard((const double(*)[3])box, view->distance, width, height);
}

/* Returns the flags with the view that was fitted to the run's first picture of this size. */
static view_options hold_fitted(render_job *job, const view_options *view) {
    view_options held = *view;
    const leafcast_camera *size = &view->camera;
    if (job->fits_all) {
        job->fitted = view_of_all(job, view, &held.hold_diagonal);
        held.hold = &job->fitted;
    } else if (view_camera_fits(view)) {
        if (job->fitted.width != size->width || job->fitted.height != size->height)
            job->fitted = view_camera_fit(view, job->volume);
        held.hold = &job->fitted;
    }
    return held;
}

leafcast_camera render_job_camera(render_job *job, const view_options *view) {
    const view_options held = hold_fitted(job, view);
    return view_camera_of(&held, job->volume);
}

void render_job_turn(render_job *job, view_options *view, double share) {
    *view = hold_fitted(job, view);
    view_camera_turn(view, job->volume, share);
}

/* Whether a first picture is written before the exact one. */
static bool is_progressive(const render_job *job, const script_frame *frame) {
    const char *path = frame->file[FRAME_PICTURE];
    return job->progressive && path[0] && !output_name_is_stdout(path);
}

/* Write what can be drawn at once. */
static status draw_first(render_job *job, const script_frame *frame, const leafcast_camera *seen_by,
                         const leafcast_scene *scene, const picture_volume *volumes,
                         render_stats *stats) {
    const double begun = clock_seconds();
    leafcast_stats t = {.size = sizeof t};
    leafcast_scene now = *scene;
    part whole = {job->watch, job->done, 0.0};
    image_target *to = NULL;
    now.preview = true;
    status st = image_out_begin(job->files, frame->file[FRAME_PICTURE], &to);
    if (st == ST_OK)
        st = render_status(leafcast_trace(job->volume, &now, seen_by, &job->image, &t,
                                          job->watch ? report : NULL, &whole));
    if (st != ST_OK) {
        image_out_discard(to);
        return st;
    }
    picture_scene_mark(&job->scene, volumes, &now, seen_by, &job->image, job->face);
    st = finish_picture(job, frame, seen_by, to);
    stats->first_s = clock_seconds() - begun;
    stats->first_provisional = t.provisional_pixels;
    return st;
}

static status draw_picture(render_job *job, const script_frame *frame, targets *to,
                           render_stats *stats) {
    const bool progressive = is_progressive(job, frame);
    const leafcast_camera seen_by = render_job_camera(job, &frame->view);
    const picture_volume *volumes = render_job_objects(job, &frame->view);
    leafcast_scene scene;
    status st = picture_scene_describe(&job->scene, volumes, job->object_count, false, &scene);
    if (st == ST_OK)
        st = open_face(job, &frame->view);
    if (st == ST_OK && !progressive)
        st = open_picture(job, frame, false, to);
    if (st == ST_OK)
        st = open_raw(job, frame, to);
    /* A time between steps needs other room than a step: select it first. */
    if (st == ST_OK)
        st = select_surfaces(job, &frame->view);
    if (st == ST_OK)
        st = select_set(job, &frame->view);
    if (st == ST_OK)
        st = make_planes(job, frame, &scene, &seen_by);
    if (st == ST_OK && progressive)
        st = draw_first(job, frame, &seen_by, &scene, volumes, stats);
    if (st == ST_OK && progressive)
        st = open_picture(job, frame, true, to);
    if (st == ST_OK)
        st = trace(job, &scene, &seen_by, &stats->trace);
    if (st == ST_OK && job->certify)
        st = certificate_make(job->volume, &scene, &seen_by, &job->image, &job->m,
                              &stats->certified);
    const double traced = clock_seconds();
    if (st == ST_OK && stats->trace.treelets_lost && job->image.provisional)
        lost_marks_draw(&job->image, (size_t)seen_by.width * seen_by.height);
    if (st == ST_OK)
        picture_scene_mark(&job->scene, volumes, &scene, &seen_by, &job->image, job->face);
    if (st == ST_OK)
        st = write_targets(job, frame, &seen_by, &scene, to);
    stats->write_s = clock_seconds() - traced;
    return st;
}

status render_job_draw(render_job *job, const script_frame *frame, render_stats *stats) {
    const double begun = clock_seconds();
    targets to = {{NULL}};
    *stats = (render_stats){.volume = job->volume, .repeats = job->repeat};
    status st = draw_picture(job, frame, &to, stats);
    for (int i = 0; i < FRAME_TF; i++)
        image_out_discard(to.file[i]);
    stats->field = job->field;
    stats->step = job->step;
    stats->between = job->between;
    stats->total_s = clock_seconds() - begun;
    stats->peak_rss_bytes = render_stats_peak_rss();
    return st;
}
