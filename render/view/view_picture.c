#include "render/view/view_picture.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "formats/base/clock.h"
#include "render/app/picture_png.h"

/* A preview takes less of what takes time: one ray a pixel, and media so exact. */
#define PREVIEW_ERROR (1.0 / 64.0)
#define DEFAULT_ERROR (1.0 / 510.0) /* leafcast_scene.error */
/* One that is not complete after so long gives way to a coarser one, or to a newer view. */
#define OVERDUE_S (2.0 * VIEW_MOVING_S)
/* At rest, a preview is worth its time where the whole takes longer. */
#define SOON_S 0.080

typedef enum phase { IDLE, PREVIEW, EXACT, FINAL, WRITING } phase;

/* Planes of one size. */
typedef struct planes {
    uint32_t width, height;
    leafcast_image image;
} planes;

struct view_picture {
    view_tools tools;
    phase phase;
    view_wish wish;
    picture_volume volume;
    picture_scene parts;
    leafcast_scene scene;
    leafcast_camera camera; /* of the whole picture */
    uint64_t beside;
    planes now, base; /* base: the preview of this view */
    leafcast_scene_experiments experiments;
    pthread_mutex_t lock; /* of this: */
    leafcast_frame *frame;
    bool frame_is_preview;
    /* Of the drawing thread again: */
    leafcast_stats stats;
    uint32_t scale; /* of what is drawn */
    int part;
    view_file *writing;     /* where it becomes a file, */
    uint64_t writing_bytes; /* with planes of so many */
    bool ready;             /* a moving preview is complete, and waits until it may be sent */
    double drawn_s, next_s; /* of this frame so far; when the next part is due */
    double cost;            /* of a preview, seconds a pixel; 0: not known */
};

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

static void planes_release(mem *m, planes *p) {
    view_file_free_planes(m, &p->image);
    *p = (planes){0};
}

static uint64_t planes_bytes(const planes *p) {
    const leafcast_image *i = &p->image;
    const uint64_t one = 3 * sizeof(float) + 1 + (i->a ? sizeof(float) : 0) +
                         (i->error ? sizeof(double) : 0) + (i->z ? sizeof(double) : 0) +
                         (i->id ? 3 * sizeof(float) + sizeof(int32_t) : 0) +
                         (i->value ? sizeof(double) : 0);
    return i->r ? one * p->width * p->height : 0;
}

/* Several rays a pixel have no plane of errors; a preview takes one. */
static bool has_errors(const view_picture *p) {
    return view_options_any_medium(&p->wish.view) && (p->phase == PREVIEW || p->scene.samples <= 1);
}

/* Which there are to be: as render takes them for a PNG or an EXR. Pointers that only are not NULL.
 */
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

/* A plane, if it is wanted. Zeroed where parts of it will be seen: else a picture writes all of it,
 * and touching it here would take long. */
static void *make_plane(mem *m, const void *wanted, size_t count, size_t size, bool zeroed) {
    if (!wanted)
        return NULL;
    return zeroed ? mem_array(m, count, size) : mem_alloc(m, count * size);
}

/* All of it provisional. */
static status planes_make(mem *m, const leafcast_image *w, uint32_t width, uint32_t height,
                          planes *out) {
    const size_t count = (size_t)width * height;
    const bool zeroed = w->provisional;
    leafcast_image *i = &out->image;
    *out = (planes){.width = width, .height = height, .image = {.size = sizeof *i}};
    i->r = make_plane(m, w->r, count, sizeof *i->r, zeroed);
    i->g = make_plane(m, w->g, count, sizeof *i->g, zeroed);
    i->b = make_plane(m, w->b, count, sizeof *i->b, zeroed);
    i->a = make_plane(m, w->a, count, sizeof *i->a, zeroed);
    i->z = make_plane(m, w->z, count, sizeof *i->z, zeroed);
    i->error = make_plane(m, w->error, count, sizeof *i->error, zeroed);
    i->value = make_plane(m, w->value, count, sizeof *i->value, zeroed);
    i->id = make_plane(m, w->id, count, sizeof *i->id, zeroed);
    i->provisional = make_plane(m, w->provisional, count, sizeof *i->provisional, zeroed);
    bool failed = !i->r || !i->g || !i->b || !i->a != !w->a || !i->z != !w->z ||
                  !i->error != !w->error || !i->value != !w->value || !i->id != !w->id ||
                  !i->provisional != !w->provisional;
    for (int k = 0; k < 3; k++) {
        i->normal[k] = make_plane(m, w->normal[k], count, sizeof(float), zeroed);
        failed |= !i->normal[k] != !w->normal[k];
    }
    if (failed) {
        planes_release(m, out);
        return ST_NOMEM;
    }
    if (i->provisional)
        memset(i->provisional, 1, count);
    return ST_OK;
}

/* What is not drawn yet looks as it did in the preview. */
static void planes_enlarge(const planes *from, planes *to) {
    float *const a[4] = {from->image.r, from->image.g, from->image.b, from->image.a};
    float *const b[4] = {to->image.r, to->image.g, to->image.b, to->image.a};
    for (uint32_t y = 0; y < to->height; y++) {
        const size_t above = (size_t)((uint64_t)y * from->height / to->height) * from->width;
        for (uint32_t x = 0; x < to->width; x++) {
            const size_t in = above + (size_t)((uint64_t)x * from->width / to->width);
            for (int c = 0; c < 4; c++)
                if (a[c] && b[c])
                    b[c][(size_t)y * to->width + x] = a[c][in];
        }
    }
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
    planes_release(p->tools.m, &p->now);
    planes_release(p->tools.m, &p->base);
    picture_scene_release(&p->parts);
    p->phase = IDLE;
    p->ready = false;
}

void view_picture_destroy(view_picture *p) {
    if (!p)
        return;
    view_picture_stop(p);
    pthread_mutex_destroy(&p->lock);
    mem_free(p->tools.m, p);
}

/* As render checks a picture. */
static status check(view_picture *p) {
    view_options *v = &p->wish.view;
    const leafcast_camera *size = &v->camera;
    double suggested[LEAFCAST_SUGGESTIONS_MAX];
    int count;
    if (size->width < 1 || size->height < 1 || size->width > VIEW_SIDE_MAX ||
        size->height > VIEW_SIDE_MAX || (uint64_t)size->width * size->height > VIEW_PIXELS_MAX)
        return status_describe(ST_USAGE, "a picture of %u x %u: a side is 1 to %d, of %d pixels",
                               size->width, size->height, VIEW_SIDE_MAX, VIEW_PIXELS_MAX);
    if (p->wish.file && p->wish.kind == VIEW_FILE_EXR &&
        (uint64_t)size->width * size->height > VIEW_EXR_PIXELS_MAX)
        return status_describe(ST_USAGE, "an EXR of %u x %u: it may have %d pixels", size->width,
                               size->height, VIEW_EXR_PIXELS_MAX);
    status st = picture_scene_choose(p->wish.volume, v, suggested, &count);
    if (st == ST_OK)
        st = view_options_check(v);
    return st == ST_OK ? view_options_check_volume(v, p->wish.volume) : st;
}

status view_picture_begin(view_picture *p, const view_wish *wish, uint64_t beside) {
    view_picture_stop(p);
    p->wish = *wish;
    p->volume = (picture_volume){wish->volume, &p->wish.view};
    p->beside = beside;
    p->part = 0;
    status st = check(p);
    if (st != ST_OK)
        return st;
    picture_scene_init(&p->parts, p->tools.m);
    st = picture_scene_describe(&p->parts, &p->volume, 1, true, &p->scene);
    if (st != ST_OK)
        return st;
    p->camera = view_options_camera(&p->wish.view, p->wish.volume);
    const double whole = p->cost * p->camera.width * p->camera.height;
    const bool soon = p->cost > 0.0 && whole < SOON_S && p->stats.provisional_pixels == 0;
    p->phase = wish->file || (!wish->moving && soon) ? EXACT : PREVIEW;
    return ST_OK;
}

/* The least that fits its time. */
static uint32_t choose_scale(const view_picture *p) {
    const double pixels = (double)p->camera.width * p->camera.height;
    uint32_t scale = 1;
    if (p->cost == 0.0)
        return 2;
    while (scale < VIEW_SCALE_MAX && p->cost * pixels / (scale * scale) > VIEW_MOVING_S)
        scale++;
    return scale;
}

static status begin_frame(view_picture *p) {
    leafcast_scene scene = p->scene;
    leafcast_camera camera = p->camera;
    leafcast_frame *frame = NULL;
    const leafcast_image wanted = planes_wanted(p);
    p->scale = 1;
    p->drawn_s = 0.0;
    if (p->phase == PREVIEW) {
        p->scale = choose_scale(p);
        scene.preview = true;
        scene.samples = 1;
        if (view_options_any_medium(&p->wish.view))
            scene.error = fmax(scene.error, PREVIEW_ERROR);
        camera.width = (camera.width + p->scale - 1) / p->scale;
        camera.height = (camera.height + p->scale - 1) / p->scale;
    } else {
        p->next_s = 0.1;
    }
    const uint64_t png = picture_png_bytes(pool_threads(p->tools.threads), camera.width);
    status st = (status)leafcast_check_room(p->wish.volume, &scene, &camera, &wanted,
                                            p->beside + planes_bytes(&p->base) + png);
    if (st == ST_OK)
        st = planes_make(p->tools.m, &wanted, camera.width, camera.height, &p->now);
    if (st == ST_OK && p->base.image.r)
        planes_enlarge(&p->base, &p->now);
    planes_release(p->tools.m, &p->base);
    if (st == ST_OK)
        st = (status)leafcast_frame_begin(p->wish.volume, &scene, &camera, &p->now.image, &frame);
    if (st == ST_OK)
        set_frame(p, frame);
    return st;
}

/* ---- Parts ---- */

static uint64_t count_provisional(const planes *of) {
    const size_t count = (size_t)of->width * of->height;
    uint64_t n = 0;
    for (size_t i = 0; i < count; i++)
        n += of->image.provisional[i] != 0;
    return n;
}

/* Without a plane: of several rays a pixel each is as exact as was asked for, and so is their mean.
 */
static double largest_error(const view_picture *p) {
    const planes *const of = &p->now;
    const size_t count = of->image.error ? (size_t)of->width * of->height : 0;
    double most = 0.0;
    if (count == 0 && view_options_any_medium(&p->wish.view))
        most = p->scene.error > 0.0 ? p->scene.error : DEFAULT_ERROR;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, of->image.error[i]);
    return most;
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
    const leafcast_scene *scene = &p->scene;
    const uint64_t provisional = count_provisional(&p->now);
    const bool certified = p->wish.view.experiments.summing == LEAFCAST_CERTIFIED;
    const bool exact = final && provisional == 0 && scene->lod == LEAFCAST_LOD_EXACT;
    json_t *out =
        json_pack("{s:I,s:i,s:I,s:I,s:s,s:b,s:b,s:b}", "number", (json_int_t)p->wish.number, "part",
                  p->part, "width", (json_int_t)p->now.width, "height", (json_int_t)p->now.height,
                  "format", png ? "png" : "jpeg", "final", (int) final, "exact", (int)exact,
                  "certified", (int)(certified && p->stats.uncertified_pixels == 0));
    if (!out)
        return NULL;
    json_object_set_new(out, "lod_level", json_integer(scene->lod_level));
    json_object_set_new(out, "scale", json_integer(p->scale));
    json_object_set_new(out, "provisional", json_integer((json_int_t)provisional));
    json_object_set_new(out, "uncertified", json_integer((json_int_t)p->stats.uncertified_pixels));
    json_object_set_new(out, "error", cli_json_real(largest_error(p)));
    json_object_set_new(out, "render_ms", json_real(1e3 * p->stats.render_s));
    json_object_set_new(out, "age_ms", json_real(1e3 * (clock_seconds() - p->wish.asked)));
    json_object_set_new(out, "stats", describe_stats(&p->stats));
    return out;
}

/* Legend and annotations, over what is complete. */
static status mark(const view_picture *p) {
    text_face *face = NULL;
    status st = ST_OK;
    if (annotate_wanted(&p->wish.view.annotation))
        st = text_face_open(p->tools.m, NULL, &face);
    if (st == ST_OK)
        picture_scene_mark(&p->parts, &p->volume, &p->scene, &p->camera, &p->now.image, face);
    text_face_close(face);
    return st;
}

/* What there is. A picture that can be seen through, and the last one, go without loss. */
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

/* The finished picture of a file. */
static status begin_file(view_picture *p) {
    const picture shown = {p->now.width, p->now.height, &p->now.image, NULL, 0};
    const view_tools *t = &p->tools;
    status st = mark(p);
    p->phase = WRITING;
    if (st == ST_OK) {
        p->writing_bytes = planes_bytes(&p->now);
        st = view_file_begin(t->m, p->wish.kind, &shown, t->wake, t->wake_ctx, &p->writing);
        p->now = (planes){0};
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

static void learn(view_picture *p) {
    const double cost = p->drawn_s / ((double)p->now.width * p->now.height);
    p->cost = cost > p->cost ? cost : 0.5 * (cost + p->cost);
}

static status end_preview(view_picture *p, bool may_send, view_message **out) {
    status st = may_send ? make_part(p, false, out) : ST_OK;
    set_frame(p, NULL);
    p->ready = p->wish.moving && !may_send;
    if (p->ready)
        return ST_OK;
    if (p->wish.moving) {
        planes_release(p->tools.m, &p->now);
        p->phase = IDLE;
    } else {
        p->base = p->now;
        p->now = (planes){0};
        p->phase = EXACT;
    }
    return st;
}

/* Coarser, for next time at least twice as quick. */
static void try_coarser(view_picture *p) {
    const double pixels = (double)p->now.width * p->now.height;
    p->cost = fmax(2.0 * p->drawn_s / pixels, p->cost);
    set_frame(p, NULL);
    planes_release(p->tools.m, &p->now);
}

/* The samples of a pixel are summed up over the whole picture: until then it is too dark. */
static bool has_parts(const view_picture *p) {
    return !p->wish.file && p->scene.samples <= 1;
}

static status draw(view_picture *p, double seconds, bool may_send, view_message **out) {
    bool done = false;
    const double begun = clock_seconds();
    p->stats.size = sizeof p->stats;
    status st = (status)leafcast_frame_advance(p->frame, seconds, &done, &p->stats);
    p->drawn_s += clock_seconds() - begun;
    if (st != ST_OK)
        return st;
    if (p->phase == PREVIEW && done) {
        learn(p);
        return end_preview(p, may_send, out);
    }
    if (p->phase == PREVIEW) {
        if (p->drawn_s > OVERDUE_S && p->scale < VIEW_SCALE_MAX)
            try_coarser(p);
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
    return p->phase == FINAL || (p->phase == PREVIEW && !p->frame);
}

bool view_picture_writes(const view_picture *p) {
    return p->writing && !view_file_is_done(p->writing);
}

bool view_picture_may_change(const view_picture *p) {
    return p->phase != PREVIEW || !p->frame ||
           (p->drawn_s > OVERDUE_S && p->scale < VIEW_SCALE_MAX);
}

uint64_t view_picture_bytes(const view_picture *p) {
    return planes_bytes(&p->now) + planes_bytes(&p->base) + (p->writing ? p->writing_bytes : 0);
}

const view_wish *view_picture_wish(const view_picture *p) {
    return &p->wish;
}

const leafcast_stats *view_picture_stats(const view_picture *p) {
    return &p->stats;
}
