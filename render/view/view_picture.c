#include "render/view/view_picture.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "formats/base/clock.h"
#include "render/app/picture_png.h"

/* A preview takes less of what takes time: one ray a pixel, and media so exact. */
#define PREVIEW_ERROR (1.0 / 64.0)
/* One that is not complete after so long gives way to a coarser one, or to a newer view. */
#define OVERDUE_S (2.0 * VIEW_MOVING_S)
/* At rest, a preview is worth its time where the whole takes longer. */
#define SOON_S 0.080

typedef enum phase { IDLE, PREVIEW, EXACT, FINAL } phase;

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
    leafcast_image *i = &p->image;
    void *const all[] = {i->r, i->g, i->b, i->a, i->z, i->error, i->provisional};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        mem_free(m, all[k]);
    *p = (planes){0};
}

static uint64_t planes_bytes(const planes *p) {
    const leafcast_image *i = &p->image;
    const uint64_t one = 3 * sizeof(float) + 1 + (i->a ? sizeof(float) : 0) +
                         (i->error ? sizeof(double) : 0) + (i->z ? sizeof(double) : 0);
    return i->r ? one * p->width * p->height : 0;
}

/* Which there are to be: as render takes them for a PNG. Pointers that only are not NULL. */
static leafcast_image planes_wanted(const view_picture *p) {
    static float any_float;
    static double any_double;
    static uint8_t any_byte;
    const view_options *v = &p->wish.view;
    return (leafcast_image){.size = sizeof(leafcast_image),
                            .r = &any_float,
                            .g = &any_float,
                            .b = &any_float,
                            .a = v->scene.background[3] >= 1.0f ? NULL : &any_float,
                            .z = v->annotation.parts & ANNOTATE_BOX ? &any_double : NULL,
                            .error = view_options_any_medium(v) ? &any_double : NULL,
                            .provisional = &any_byte};
}

/* Zeroed, all of it provisional. */
static status planes_make(mem *m, const leafcast_image *wanted, uint32_t width, uint32_t height,
                          planes *out) {
    const size_t count = (size_t)width * height;
    leafcast_image *i = &out->image;
    *out = (planes){.width = width, .height = height, .image = {.size = sizeof *i}};
    i->r = mem_array(m, count, sizeof *i->r);
    i->g = mem_array(m, count, sizeof *i->g);
    i->b = mem_array(m, count, sizeof *i->b);
    i->a = wanted->a ? mem_array(m, count, sizeof *i->a) : NULL;
    i->z = wanted->z ? mem_array(m, count, sizeof *i->z) : NULL;
    i->error = wanted->error ? mem_array(m, count, sizeof *i->error) : NULL;
    i->provisional = mem_array(m, count, sizeof *i->provisional);
    if (!i->r || !i->g || !i->b || !i->provisional || (wanted->a && !i->a) ||
        (wanted->z && !i->z) || (wanted->error && !i->error)) {
        planes_release(m, out);
        return ST_NOMEM;
    }
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
    planes_release(p->tools.m, &p->now);
    planes_release(p->tools.m, &p->base);
    picture_scene_release(&p->parts);
    p->phase = IDLE;
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

static double largest_error(const planes *of) {
    const size_t count = of->image.error ? (size_t)of->width * of->height : 0;
    double most = 0.0;
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
    json_object_set_new(out, "error", cli_json_real(largest_error(&p->now)));
    json_object_set_new(out, "render_ms", json_real(1e3 * p->stats.render_s));
    json_object_set_new(out, "age_ms", json_real(1e3 * (clock_seconds() - p->wish.asked)));
    json_object_set_new(out, "stats", describe_stats(&p->stats));
    return out;
}

/* The JSON before a picture, and its length before that. */
static status put_header(view_message **to, json_t *header) {
    view_message *text = view_message_json((*to)->m, header);
    if (!text)
        return ST_NOMEM;
    const uint32_t n = (uint32_t)text->size;
    const uint8_t length[4] = {(uint8_t)n, (uint8_t)(n >> 8), (uint8_t)(n >> 16),
                               (uint8_t)(n >> 24)};
    status st = view_message_put(to, length, sizeof length);
    if (st == ST_OK)
        st = view_message_put(to, text->bytes, text->size);
    view_message_free(text);
    return st;
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
    if (st == ST_OK && !p->wish.file)
        st = put_header(&made, describe_part(p, png, final));
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

/* ---- Drawing ---- */

static void learn(view_picture *p) {
    const double cost = p->drawn_s / ((double)p->now.width * p->now.height);
    p->cost = cost > p->cost ? cost : 0.5 * (cost + p->cost);
}

static status end_preview(view_picture *p, bool may_send, view_message **out) {
    status st = may_send ? make_part(p, false, out) : ST_OK;
    set_frame(p, NULL);
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
    if (p->phase == FINAL) {
        if (!may_send)
            return ST_OK;
        st = make_part(p, true, out);
        view_picture_stop(p);
        return st;
    }
    if (!p->frame)
        st = begin_frame(p);
    if (st == ST_OK)
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

bool view_picture_may_change(const view_picture *p) {
    return p->phase != PREVIEW || !p->frame ||
           (p->drawn_s > OVERDUE_S && p->scale < VIEW_SCALE_MAX);
}

uint64_t view_picture_bytes(const view_picture *p) {
    return planes_bytes(&p->now) + planes_bytes(&p->base);
}

const view_wish *view_picture_wish(const view_picture *p) {
    return &p->wish;
}

const leafcast_stats *view_picture_stats(const view_picture *p) {
    return &p->stats;
}
