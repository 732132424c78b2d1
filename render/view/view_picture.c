#include "render/view/view_picture.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "formats/base/clock.h"
#include "render/app/picture_png.h"
#include "render/app/view_camera.h"
#include "render/view/view_cast.h"
#include "render/view/view_planes.h"
#include "render/view/view_stride.h"
#include "render/view/view_task.h"
#include "render/view/view_where.h"

/* A preview saves time: one ray per pixel, and media with at least this error bound. */
#define PREVIEW_ERROR (1.0 / 64.0)
#define DEFAULT_ERROR (1.0 / 510.0) /* leafcast_scene.error */
/* A preview that is far from complete after this time gives way to a coarser one, or to a newer
 * view. */
#define OVERDUE_S (1.5 * VIEW_MOVING_S)
#define ENOUGH    0.5 /* but it is completed if this share of its pixels is drawn */
/* At rest, draw a preview only if the full picture takes longer than SOON_S. After it, draw a
 * better preview if the full picture takes at least LONG_S, and the better preview takes at most
 * BETTER_SHARE of that time. */
#define SOON_S       0.080
#define LONG_S       1.0
#define BETTER_SHARE 0.2

typedef enum phase { IDLE, PREVIEW, BETTER, EXACT, FINAL, WRITING } phase;

struct view_picture {
    view_tools tools;
    phase phase;
    view_wish wish;
    view_stride stride;            /* of the steps of its volume */
    view_cast *cast;               /* what a scene shows; NULL: it is one volume */
    picture_volume volume;         /* that volume */
    const picture_volume *objects; /* object_count of them */
    int object_count;
    picture_scene parts;
    leafcast_scene scene;
    leafcast_camera camera; /* for the whole picture */
    uint64_t beside;
    view_planes now, base; /* base: the preview of this view, if any */
    pthread_mutex_t lock;  /* guards the next two */
    leafcast_frame *frame;
    bool frame_is_preview;
    /* For the drawing thread, from here on: */
    leafcast_stats stats;
    view_task task;   /* this picture, as the pace sees it */
    view_pace *pace;  /* its pace, one of `paces` */
    view_grade grade; /* grade of the frame being drawn */
    bool overdue;     /* the last preview was given up as late: the next one is coarser */
    int part;
    view_file *writing;     /* the file being written, if any */
    uint64_t writing_bytes; /* bytes of that file's planes */
    bool ready;             /* a moving preview is complete and waits until it may be sent */
    double drawn_s, next_s; /* time of this frame so far; when the next part is due */
    const void *paced;      /* the volume or scene that `paces` are about */
    view_pace paces[VIEW_WAYS];
};

void view_wish_release(view_wish *w) {
    view_changes_drop(w->changes);
    w->changes = NULL;
}

void view_wish_copy(view_wish *to, const view_wish *from) {
    view_changes *held = view_changes_hold(from->changes);
    view_wish_release(to);
    *to = *from;
    to->changes = held;
}

const view_options *view_wish_of_one(const view_wish *w) {
    return w->scene ? view_changes_view(w->changes, w->scene, w->chosen) : &w->view;
}

status view_picture_create(const view_tools *tools, view_picture **out) {
    view_picture *p = mem_zalloc(tools->m, sizeof *p);
    if (!p)
        return ST_NOMEM;
    p->tools = *tools;
    p->volume.view = &p->wish.view;
    pthread_mutex_init(&p->lock, NULL);
    picture_scene_init(&p->parts, tools->m);
    *out = p;
    return ST_OK;
}

/* ---- Planes ---- */

static bool is_preview(const view_picture *p) {
    return p->phase == PREVIEW || p->phase == BETTER;
}

/* Returns whether there is a plane of errors: not for several rays per pixel, but a preview takes
 * one. */
static bool has_errors(const view_picture *p) {
    return view_options_any_medium(&p->wish.view) && (is_preview(p) || p->scene.samples <= 1);
}

/* Returns which planes to make, as non-NULL pointers: the same ones as `render` makes for a PNG or
 * an EXR. */
static leafcast_image planes_wanted(const view_picture *p) {
    static float any_float;
    static double any_double;
    static uint8_t any_byte;
    static int32_t any_id;
    const view_options *v = &p->wish.view;
    const bool all = p->wish.file && p->wish.kind == VIEW_FILE_EXR;
    const bool projected = v->scene.project != LEAFCAST_PROJECT_NONE;
    float *const n = all ? &any_float : NULL;
    return (leafcast_image){.size = sizeof(leafcast_image),
                            .r = &any_float,
                            .g = &any_float,
                            .b = &any_float,
                            .a = !all && v->scene.background[3] >= 1.0f ? NULL : &any_float,
                            .z = all || v->annotation.parts & ANNOTATE_BOX ? &any_double : NULL,
                            .normal = {n, n, n},
                            .id = all ? &any_id : NULL,
                            .value = all && projected ? &any_double : NULL,
                            .error = has_errors(p) ? &any_double : NULL,
                            .provisional = p->wish.file ? NULL : &any_byte};
}

/* ---- Beginning and ending ---- */

static void set_frame(view_picture *p, leafcast_frame *frame) {
    pthread_mutex_lock(&p->lock);
    leafcast_frame *before = p->frame;
    p->frame = frame;
    p->frame_is_preview = p->phase == PREVIEW;
    pthread_mutex_unlock(&p->lock);
    leafcast_frame_end(before);
}

void view_picture_cancel(view_picture *p) {
    pthread_mutex_lock(&p->lock);
    if (p->frame)
        leafcast_frame_cancel(p->frame);
    pthread_mutex_unlock(&p->lock);
}

void view_picture_cancel_rest(view_picture *p) {
    pthread_mutex_lock(&p->lock);
    if (p->frame && !p->frame_is_preview)
        leafcast_frame_cancel(p->frame);
    pthread_mutex_unlock(&p->lock);
}

void view_picture_stop(view_picture *p) {
    set_frame(p, NULL);
    view_file_end(p->writing);
    p->writing = NULL;
    view_planes_release(p->tools.m, &p->now);
    view_planes_release(p->tools.m, &p->base);
    if (!p->wish.scene)
        picture_scene_release(&p->parts);
    view_cast_free(p->tools.m, p->cast);
    p->cast = NULL;
    p->phase = IDLE;
    p->ready = false;
}

void view_picture_leave(view_picture *p) {
    view_picture_stop(p);
    picture_scene_release(&p->parts);
    for (int i = 0; p->wish.scene && i < p->wish.scene->count; i++)
        leafcast_stop_reading(view_scene_volume(p->wish.scene, i));
    if (p->wish.volume)
        leafcast_stop_reading(p->wish.volume);
    p->wish.volume = NULL;
    view_wish_release(&p->wish);
}

void view_picture_destroy(view_picture *p) {
    if (!p)
        return;
    view_picture_stop(p);
    picture_scene_release(&p->parts);
    view_wish_release(&p->wish);
    pthread_mutex_destroy(&p->lock);
    mem_free(p->tools.m, p);
}

static status check_size(const view_picture *p) {
    const leafcast_camera *size = &p->wish.view.camera;
    if (size->width < 1 || size->height < 1 || size->width > VIEW_SIDE_MAX ||
        size->height > VIEW_SIDE_MAX || (uint64_t)size->width * size->height > VIEW_PIXELS_MAX)
        return status_describe(
            ST_USAGE, "a picture of %u x %u: a side may have 1 to %d pixels, and all of it %d",
            size->width, size->height, VIEW_SIDE_MAX, VIEW_PIXELS_MAX);
    if (p->wish.file && p->wish.kind == VIEW_FILE_EXR &&
        (uint64_t)size->width * size->height > VIEW_EXR_PIXELS_MAX)
        return status_describe(ST_USAGE, "an EXR of %u x %u: it may have %d pixels in all",
                               size->width, size->height, VIEW_EXR_PIXELS_MAX);
    return ST_OK;
}

/* Check the wish, as render checks a picture of one volume. */
static status check_volume(view_picture *p) {
    view_options *v = &p->wish.view;
    double suggested[LEAFCAST_SUGGESTIONS_MAX];
    int count;
    status st = picture_scene_choose(p->wish.volume, v, suggested, &count);
    if (st == ST_OK)
        st = view_options_check(v);
    return st == ST_OK ? view_options_check_volume(v, p->wish.volume) : st;
}

/* Choose what is drawn of a scene. */
static status cast_scene(view_picture *p) {
    const view_wish *w = &p->wish;
    const status st = view_cast_make(p->tools.m, w->scene, &w->view, w->changes, &p->cast);
    if (st != ST_OK)
        return st;
    p->wish.view = p->cast->frame.view;
    p->objects = render_job_objects(&p->cast->job, &p->wish.view);
    p->object_count = p->cast->job.object_count;
    picture_scene_renew(&p->parts);
    p->parts.opens = true; /* what the scene file names */
    return ST_OK;
}

/* Choose and check what is drawn, and by which camera. */
static status cast(view_picture *p) {
    status st = check_size(p);
    p->volume = (picture_volume){p->wish.volume, &p->wish.view, NULL, 0};
    p->objects = &p->volume;
    p->object_count = 1;
    if (st == ST_OK && !p->wish.scene)
        picture_scene_init(&p->parts, p->tools.m);
    if (st == ST_OK)
        st = p->wish.scene ? cast_scene(p) : check_volume(p);
    if (st == ST_OK)
        st = picture_scene_describe(&p->parts, p->objects, p->object_count, true, &p->scene);
    if (st == ST_OK)
        p->camera = p->cast ? render_job_camera(&p->cast->job, &p->wish.view)
                            : view_camera_of(&p->wish.view, p->wish.volume);
    return st;
}

/* ---- The pace ---- */

static void set_pace(view_picture *p) {
    const view_way of = view_task_way(&p->scene, &p->wish.view);
    const void *paced = p->wish.scene ? (const void *)p->wish.scene : p->wish.volume;
    if (p->paced != paced)
        memset(p->paces, 0, sizeof p->paces);
    p->paced = paced;
    p->pace = &p->paces[of];
    p->task = view_task_of(p->objects, p->object_count, &p->scene, &p->camera, of);
}

/* Returns the expected time of the whole picture in seconds, by earlier pictures. */
static double whole_s(const view_picture *p) {
    return view_pace_seconds(p->pace, &p->task, (view_grade){1, 0});
}

static void choose_grade(view_picture *p) {
    p->grade = p->overdue ? view_pace_coarser(p->pace, &p->task, VIEW_MOVING_S)
                          : view_pace_choose(p->pace, &p->task, VIEW_MOVING_S);
    p->overdue = false;
}

/* Returns the phase that follows a preview at rest. */
static phase after_preview(view_picture *p) {
    const view_grade half = {2, view_pace_quick_level(&p->task, 2)};
    const double whole = whole_s(p), better = view_pace_seconds(p->pace, &p->task, half);
    if (p->grade.scale <= half.scale || whole < LONG_S || better > BETTER_SHARE * whole)
        return EXACT;
    p->grade = half;
    return BETTER;
}

static void expect_next(view_picture *p, const view_wish *now) {
    const uint32_t steps = leafcast_describe(now->volume).steps;
    const view_options *v = view_wish_of_one(now);
    uint32_t field;
    if (now->volume != p->wish.volume)
        p->stride = (view_stride){false, 0, 0, 0};
    /* A wrong step is refused when the picture is described. */
    if (v->step < steps && view_options_field(v, now->volume, &field) == ST_OK)
        (void)leafcast_expect_set(now->volume, field, view_stride_next(&p->stride, v->step, steps));
}

status view_picture_begin(view_picture *p, const view_wish *wish, uint64_t beside) {
    view_picture_stop(p);
    expect_next(p, wish);
    view_wish_copy(&p->wish, wish);
    p->beside = beside;
    p->part = 0;
    p->overdue = false;
    const status st = cast(p);
    if (st != ST_OK)
        return st;
    set_pace(p);
    const bool soon =
        p->pace->cost[0] > 0.0 && whole_s(p) < SOON_S && p->stats.provisional_pixels == 0;
    p->phase = wish->file || (!wish->moving && soon) ? EXACT : PREVIEW;
    return ST_OK;
}

/* Returns the level of detail that the state asks for, at most the last one. */
static uint32_t asked_level(const view_picture *p) {
    const uint32_t asked = p->scene.lod == LEAFCAST_LOD_LEVEL ? p->scene.lod_level : 0;
    uint32_t last = 0;
    for (int i = 0; i < p->object_count && asked > 0; i++) {
        const uint32_t own = leafcast_describe(p->objects[i].volume).preview_levels - 1;
        last = own > last ? own : last;
    }
    return asked < last ? asked : last;
}

static void make_coarse(const view_picture *p, leafcast_scene *scene, leafcast_camera *camera) {
    scene->preview = true;
    scene->samples = 1;
    if (view_options_any_medium(&p->wish.view))
        scene->error = fmax(scene->error, PREVIEW_ERROR);
    if (p->grade.level > asked_level(p)) {
        scene->lod = LEAFCAST_LOD_LEVEL;
        scene->lod_level = p->grade.level;
    }
    camera->width = (camera->width + p->grade.scale - 1) / p->grade.scale;
    camera->height = (camera->height + p->grade.scale - 1) / p->grade.scale;
}

static status begin_frame(view_picture *p) {
    leafcast_scene scene = p->scene;
    leafcast_camera camera = p->camera;
    leafcast_frame *frame = NULL;
    const leafcast_image wanted = planes_wanted(p);
    p->drawn_s = 0.0;
    if (p->phase == PREVIEW)
        choose_grade(p);
    if (p->phase == EXACT)
        p->grade = (view_grade){1, 0};
    if (is_preview(p))
        make_coarse(p, &scene, &camera);
    p->next_s = 0.1;
    const uint64_t png = picture_png_bytes(pool_threads(p->tools.threads), camera.width);
    const uint64_t beside = p->beside + view_planes_bytes(&p->base) + png;
    status st = p->cast
                    ? view_cast_room(p->cast, p->wish.scene, &scene, &camera, &wanted, beside)
                    : (status)leafcast_check_room(p->wish.volume, &scene, &camera, &wanted, beside);
    if (st == ST_OK)
        st = view_planes_make(p->tools.m, &wanted, camera.width, camera.height, &p->now);
    if (st == ST_OK && p->base.image.r)
        view_planes_enlarge(&p->base, &p->now);
    else if (st == ST_OK && p->phase == PREVIEW)
        view_planes_blank(&p->now);
    view_planes_release(p->tools.m, &p->base);
    if (st == ST_OK)
        st = (status)leafcast_frame_begin(p->objects[0].volume, &scene, &camera, &p->now.image,
                                          &frame);
    if (st == ST_OK)
        set_frame(p, frame);
    return st;
}

/* ---- Parts ---- */

/* Returns the largest error bound of a pixel. With several rays per pixel there is no plane: each
 * ray is as exact as asked for, and so is their mean.
 */
static double largest_error(const view_picture *p) {
    const view_planes *const of = &p->now;
    const size_t count = of->image.error ? (size_t)of->width * of->height : 0;
    double most = 0.0;
    if (count == 0 && view_options_any_medium(&p->wish.view))
        most = p->scene.error > 0.0 ? p->scene.error : DEFAULT_ERROR;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, of->image.error[i]);
    return most;
}

/* Returns the error bound of a part. It is unknown (infinite) for media drawn coarser than the
 * data, and while pixels of the preview are left. */
static double bound_of(const view_picture *p, bool coarse, uint64_t provisional) {
    const bool waits = !is_preview(p) && provisional > 0;
    return (coarse || waits) && p->now.image.error ? INFINITY : largest_error(p);
}

static json_t *describe_stats(const leafcast_stats *s) {
    return json_pack(
        "{s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I}", "treelets_active", (json_int_t)s->treelets_active,
        "treelets_loaded", (json_int_t)s->treelets_loaded, "treelets_total",
        (json_int_t)s->treelets_total, "bytes_read", (json_int_t)s->bytes_read, "bytes_resident",
        (json_int_t)s->bytes_resident, "bytes_file", (json_int_t)s->bytes_file, "bytes_active",
        (json_int_t)s->bytes_active, "bytes_peak", (json_int_t)s->bytes_peak, "bytes_read_ever",
        (json_int_t)s->bytes_read_ever);
}

static json_t *describe_part(const view_picture *p, bool png, bool final) {
    const bool coarse = p->grade.level > asked_level(p); /* all of it is coarser than asked for */
    const uint64_t pixels = (uint64_t)p->now.width * p->now.height;
    const uint64_t provisional = coarse ? pixels : view_planes_provisional(&p->now);
    const bool certified = p->wish.view.experiments.summing == LEAFCAST_CERTIFIED && !coarse;
    const bool exact = final && provisional == 0 && p->scene.lod == LEAFCAST_LOD_EXACT;
    json_t *out =
        json_pack("{s:I,s:i,s:I,s:I,s:s,s:b,s:b,s:b}", "number", (json_int_t)p->wish.number, "part",
                  p->part, "width", (json_int_t)p->now.width, "height", (json_int_t)p->now.height,
                  "format", png ? "png" : "jpeg", "final", (int) final, "exact", (int)exact,
                  "certified", (int)(certified && p->stats.uncertified_pixels == 0));
    if (!out)
        return NULL;
    json_object_set_new(out, "lod_level", json_integer(view_picture_level(p)));
    json_object_set_new(out, "scale", json_integer(p->grade.scale));
    json_object_set_new(out, "provisional", json_integer((json_int_t)provisional));
    json_object_set_new(out, "uncertified", json_integer((json_int_t)p->stats.uncertified_pixels));
    json_object_set_new(out, "error", cli_json_real(bound_of(p, coarse, provisional)));
    json_object_set_new(out, "render_ms", json_real(1e3 * p->stats.render_s));
    json_object_set_new(out, "age_ms", json_real(1e3 * (clock_seconds() - p->wish.asked)));
    json_object_set_new(out, "stats", describe_stats(&p->stats));
    if (p->wish.where)
        json_object_set_new(out, "where",
                            view_where_describe(coarse ? NULL : p->now.image.provisional,
                                                p->now.width, p->now.height));
    return out;
}

/* Draw legend and annotations over the complete picture. */
static status mark(const view_picture *p) {
    text_face *face = NULL;
    status st = ST_OK;
    const view_options *v = &p->wish.view;
    const bool named = p->cast && v->legend && (v->colour_by[0] || v->others_coloured);
    if (named || annotate_wanted(&v->annotation))
        st = text_face_open(p->tools.m, NULL, &face);
    if (st == ST_OK)
        picture_scene_mark(&p->parts, p->objects, &p->scene, &p->camera, &p->now.image, face);
    text_face_close(face);
    return st;
}

/* Make a message with the picture as drawn so far. The last part, and pictures with alpha, are PNG;
 * others are JPEG. */
static status make_part(view_picture *p, bool final, view_message **out) {
    const bool png = final || p->now.image.a;
    const picture shown = {p->now.width, p->now.height, &p->now.image, NULL, 0};
    view_message *made = view_message_new(p->tools.m, 64 << 10);
    if (!made)
        return ST_NOMEM;
    p->part++;
    made->binary = true;
    made->number = p->wish.number;
    made->part = p->part;
    status st = final ? mark(p) : ST_OK;
    if (st == ST_OK)
        st = view_message_head(&made, describe_part(p, png, final));
    const byte_sink sink = {view_message_put, &made};
    if (st == ST_OK && png)
        st = picture_png_write(p->tools.m, p->tools.threads, &shown, &sink);
    else if (st == ST_OK)
        st = view_jpeg_write(p->tools.jpeg, &shown, &made);
    if (st == ST_OK)
        *out = made;
    else
        view_message_free(made);
    return st;
}

/* Start to write the finished picture as a file. */
static status begin_file(view_picture *p) {
    const picture shown = {p->now.width, p->now.height, &p->now.image, NULL, 0};
    const view_tools *t = &p->tools;
    status st = mark(p);
    p->phase = WRITING;
    if (st == ST_OK) {
        p->writing_bytes = view_planes_bytes(&p->now);
        st = view_file_begin(t->m, p->wish.kind, &shown, t->wake, t->wake_ctx, &p->writing);
        p->now = (view_planes){0};
    }
    if (st != ST_OK)
        view_picture_stop(p);
    return st;
}

static status end_file(view_picture *p, view_message **out) {
    view_file *f = p->writing;
    p->writing = NULL;
    const status st = view_file_take(f, out);
    if (st == ST_OK)
        (*out)->binary = true;
    view_picture_stop(p);
    return st;
}

/* ---- Drawing ---- */

static status end_preview(view_picture *p, bool may_send, view_message **out) {
    const double begun = clock_seconds();
    p->ready = p->wish.moving && !may_send;
    if (p->ready) {
        set_frame(p, NULL);
        return ST_OK;
    }
    status st = may_send ? make_part(p, false, out) : ST_OK;
    if (p->phase == PREVIEW)
        view_pace_learn(p->pace, &p->task, p->grade, p->drawn_s + clock_seconds() - begun, 1.0);
    set_frame(p, NULL);
    if (p->wish.moving) {
        view_planes_release(p->tools.m, &p->now);
        p->phase = IDLE;
    } else {
        p->base = p->now;
        p->now = (view_planes){0};
        p->phase = p->phase == PREVIEW ? after_preview(p) : EXACT;
    }
    return st;
}

/* Give up a late preview, unless enough of it is drawn. The next one is coarser. */
static void give_up_if_slow(view_picture *p) {
    const double share = p->drawn_s >= OVERDUE_S ? view_planes_share(&p->now) : 1.0;
    if (share >= ENOUGH)
        return;
    view_pace_learn(p->pace, &p->task, p->grade, p->drawn_s, share);
    p->overdue = true;
    set_frame(p, NULL);
    view_planes_release(p->tools.m, &p->now);
}

/* Returns whether parts may be shown. With several samples per pixel they may not: a pixel is too
 * dark until all samples of the picture are summed up. */
static bool has_parts(const view_picture *p) {
    return !p->wish.file && p->scene.samples <= 1;
}

static status draw(view_picture *p, double seconds, bool may_send, view_message **out) {
    bool done = false;
    const double begun = clock_seconds();
    const bool hurries = p->phase == PREVIEW && !view_pace_coarsest(p->pace, &p->task);
    if (hurries && p->drawn_s < OVERDUE_S)
        seconds = fmin(seconds, OVERDUE_S - p->drawn_s);
    p->stats.size = sizeof p->stats;
    status st = (status)leafcast_frame_advance(p->frame, seconds, &done, &p->stats);
    p->drawn_s += clock_seconds() - begun;
    if (st != ST_OK)
        return st;
    if (is_preview(p) && done)
        return end_preview(p, may_send, out);
    if (is_preview(p)) {
        if (hurries)
            give_up_if_slow(p);
        return ST_OK;
    }
    if (done) {
        set_frame(p, NULL);
        p->phase = FINAL;
        return ST_OK;
    }
    if (p->drawn_s < p->next_s || !has_parts(p) || !may_send)
        return ST_OK;
    p->next_s = p->next_s < 1.0 ? 3.0 * p->next_s + 0.1 : p->next_s + 1.0;
    return make_part(p, false, out);
}

status view_picture_advance(view_picture *p, double seconds, bool may_send, view_message **out) {
    status st = ST_OK;
    *out = NULL;
    if (p->phase == IDLE)
        return ST_OK;
    if (p->phase == WRITING)
        return view_picture_writes(p) ? ST_OK : end_file(p, out);
    if (p->phase == FINAL) {
        if (!may_send)
            return ST_OK;
        if (p->wish.file)
            return begin_file(p);
        st = make_part(p, true, out);
        view_picture_stop(p);
        return st;
    }
    if (!p->frame && !p->ready)
        st = begin_frame(p);
    if (st == ST_OK && p->ready)
        st = end_preview(p, may_send, out);
    else if (st == ST_OK)
        st = draw(p, seconds, may_send, out);
    if (st != ST_OK)
        view_picture_stop(p);
    return st;
}

bool view_picture_busy(const view_picture *p) {
    return p->phase != IDLE;
}

bool view_picture_waits(const view_picture *p) {
    return p->phase == FINAL || (is_preview(p) && !p->frame);
}

bool view_picture_writes(const view_picture *p) {
    return p->writing && !view_file_is_done(p->writing);
}

bool view_picture_may_change(const view_picture *p) {
    return p->phase != PREVIEW || !p->frame;
}

uint64_t view_picture_bytes(const view_picture *p) {
    return view_planes_bytes(&p->now) + view_planes_bytes(&p->base) +
           (p->writing ? p->writing_bytes + view_file_bytes(p->writing) : 0);
}

const view_wish *view_picture_wish(const view_picture *p) {
    return &p->wish;
}

const leafcast_stats *view_picture_stats(const view_picture *p) {
    return &p->stats;
}

uint32_t view_picture_level(const view_picture *p) {
    const uint32_t asked = asked_level(p);
    return p->grade.level > asked ? p->grade.level : asked;
}
