#include "render/view/view_slice.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/app/picture_png.h"
#include "render/app/render_job.h"
#include "render/view/view_slice_state.h"

/* BAND: rows that are sampled at a time. SCALE_MAX: the coarsest preview. */
enum { BAND = 32, SCALE_MAX = 4 };
/* At rest, draw a preview only if the whole takes longer. */
#define SOON_S 0.080

typedef struct pane {
    view_slice_wish wish; /* the newest wish */
    bool wanted;          /* drawing it has not begun */
    bool sent;            /* a picture was sent and is not seen yet */
    uint64_t unseen;
} pane;

struct view_slices {
    view_tools tools;
    pthread_mutex_t lock; /* guards these: */
    pane panes[VIEW_PANES_MAX];
    int drawn_pane; /* pane being drawn; -1: none */
    bool preview;   /* that is a preview */
    /* For any thread: */
    atomic_bool cancel;
    /* For the drawing thread: */
    int next;             /* pane whose turn is next */
    view_slice_wish wish; /* the wish being drawn */
    leafcast_slice_pixels whole, now;
    uint32_t scale, row; /* scale: of a preview, 0 for the whole; row: rows that are done */
    double *value;
    leafcast_image image;
    double drawn_s, cost; /* time so far; seconds per pixel, 0: unknown */
    uint64_t bytes_read, treelets_read;
};

status view_slices_create(const view_tools *tools, view_slices **out) {
    view_slices *s = mem_zalloc(tools->m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->tools = *tools;
    s->drawn_pane = -1;
    pthread_mutex_init(&s->lock, NULL);
    *out = s;
    return ST_OK;
}

/* ---- Planes ---- */

static void release_planes(view_slices *s) {
    void *const all[] = {s->value, s->image.r, s->image.g, s->image.b, s->image.a};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        mem_free(s->tools.m, all[i]);
    s->value = NULL;
    s->image = (leafcast_image){0};
}

static uint64_t bytes_of(const leafcast_slice_pixels *p) {
    return (sizeof(double) + 4 * sizeof(float)) * p->width * p->height;
}

static status make_planes(view_slices *s) {
    const size_t count = (size_t)s->now.width * s->now.height;
    leafcast_image *i = &s->image;
    release_planes(s);
    i->size = sizeof *i;
    s->value = mem_alloc(s->tools.m, count * sizeof *s->value);
    float **const planes[] = {&i->r, &i->g, &i->b, &i->a};
    bool failed = !s->value;
    for (int k = 0; k < 4; k++) {
        *planes[k] = mem_alloc(s->tools.m, count * sizeof(float));
        failed |= !*planes[k];
    }
    if (failed)
        release_planes(s);
    return failed ? ST_NOMEM : ST_OK;
}

uint64_t view_slices_bytes(const view_slices *s) {
    return s->value ? bytes_of(&s->now) : 0;
}

/* ---- Beginning and ending ---- */

static void set_drawn(view_slices *s, int which, bool preview) {
    pthread_mutex_lock(&s->lock);
    s->drawn_pane = which;
    s->preview = preview;
    pthread_mutex_unlock(&s->lock);
}

/* Forget what is being drawn. */
static void stop(view_slices *s) {
    set_drawn(s, -1, false);
    release_planes(s);
    slice_request_release(&s->wish.request);
    s->wish = (view_slice_wish){0};
}

void view_slices_clear(view_slices *s) {
    stop(s);
    pthread_mutex_lock(&s->lock);
    memset(s->panes, 0, sizeof s->panes);
    pthread_mutex_unlock(&s->lock);
    s->cost = 0.0;
    atomic_store(&s->cancel, false);
}

void view_slices_destroy(view_slices *s) {
    if (!s)
        return;
    stop(s);
    pthread_mutex_destroy(&s->lock);
    mem_free(s->tools.m, s);
}

void view_slices_want(view_slices *s, const view_slice_wish *wish) {
    pane *p = &s->panes[wish->pane];
    pthread_mutex_lock(&s->lock);
    p->wish = *wish;
    p->wanted = true;
    /* Leave a preview: it will soon be done. */
    if (s->drawn_pane == wish->pane && !s->preview)
        atomic_store(&s->cancel, true);
    pthread_mutex_unlock(&s->lock);
}

void view_slices_seen(view_slices *s, int which, uint64_t number) {
    pthread_mutex_lock(&s->lock);
    if (s->panes[which].unseen <= number)
        s->panes[which].sent = false;
    pthread_mutex_unlock(&s->lock);
}

void view_slices_cancel(view_slices *s) {
    atomic_store(&s->cancel, true);
}

/* Returns the next pane with a wish that may be sent to; -1: none. The lock is held. */
static int find_pane(const view_slices *s) {
    for (int i = 0; i < VIEW_PANES_MAX; i++) {
        const int k = (s->next + i) % VIEW_PANES_MAX;
        if (s->panes[k].wanted && !s->panes[k].sent)
            return k;
    }
    return -1;
}

bool view_slices_need(view_slices *s) {
    pthread_mutex_lock(&s->lock);
    const int k = s->drawn_pane;
    const bool need = k >= 0 ? !s->panes[k].sent : find_pane(s) >= 0;
    pthread_mutex_unlock(&s->lock);
    return need;
}

/* ---- One slice ---- */

/* Returns the level of detail whose cells are about as large as the slice's pixels. */
static uint32_t level_of(const view_slices *s, const leafcast_slice_pixels *p) {
    const leafcast_info info = leafcast_describe(s->wish.volume);
    leafcast_slice_pixels native = *p;
    uint32_t level = p->level;
    if (leafcast_fit_slice(s->wish.volume, &native) != LEAFCAST_OK)
        return level;
    const double cells = (double)native.width / p->width;
    while (level + 1 < info.levels && (double)(2u << (level - p->level)) <= cells)
        level++;
    return level;
}

static status begin_pass(view_slices *s, uint32_t scale) {
    s->now = s->whole;
    s->scale = scale;
    s->row = 0;
    s->drawn_s = 0.0;
    s->bytes_read = s->treelets_read = 0;
    if (scale > 0) {
        s->now.width = (s->now.width + scale - 1) / scale;
        s->now.height = (s->now.height + scale - 1) / scale;
        s->now.level = level_of(s, &s->now);
    }
    atomic_store(&s->cancel, false);
    set_drawn(s, s->wish.pane, scale > 0);
    return make_planes(s);
}

/* Returns the smallest scale that fits a preview's time. */
static uint32_t choose_scale(const view_slices *s) {
    const double pixels = (double)s->whole.width * s->whole.height;
    uint32_t scale = 1;
    while (s->cost > 0.0 && scale < SCALE_MAX && s->cost * pixels / (scale * scale) > VIEW_MOVING_S)
        scale++;
    return s->cost > 0.0 ? scale : 2;
}

static status begin_wish(view_slices *s) {
    slice_request *r = &s->wish.request;
    status st = slice_request_select(r, s->wish.volume);
    if (st == ST_OK)
        st = slice_request_place(r, s->wish.volume, true);
    if (st != ST_OK)
        return st;
    s->whole = r->place.slice;
    view_slice_state_fit(&s->whole, s->wish.box);
    const double all = s->cost * s->whole.width * s->whole.height;
    const bool soon = s->cost > 0.0 && all < SOON_S;
    return begin_pass(s, s->wish.moving || !soon ? choose_scale(s) : 0);
}

static bool goes_on(void *ctx, double done) {
    const view_slices *s = ctx;
    (void)done;
    return !atomic_load(&s->cancel);
}

/* Sample bands for so many seconds, or to the end. */
static status sample(view_slices *s, double seconds, uint64_t beside) {
    const double begun = clock_seconds();
    status st = slice_request_select(&s->wish.request, s->wish.volume);
    if (st == ST_OK && atomic_load(&s->cancel))
        st = status_describe(ST_STOPPED, "stopped");
    do {
        leafcast_slice_pixels band = s->now;
        leafcast_stats stats = {.size = sizeof stats};
        band.beside = beside + bytes_of(&s->now) +
                      picture_png_bytes(pool_threads(s->tools.threads), s->now.width);
        band.first_row = s->row;
        band.rows = s->now.height - s->row < BAND ? s->now.height - s->row : BAND;
        if (st == ST_OK)
            st = render_status(leafcast_sample_slice(s->wish.volume, &band,
                                                     s->value + (size_t)s->row * s->now.width,
                                                     &stats, goes_on, s));
        if (st == ST_OK) {
            s->row += band.rows;
            s->bytes_read += stats.bytes_read;
            s->treelets_read += stats.treelets_loaded;
        }
    } while (st == ST_OK && s->row < s->now.height && clock_seconds() - begun < seconds);
    s->drawn_s += clock_seconds() - begun;
    return st;
}

/* ---- Its picture ---- */

static json_t *vector(const double x[3]) {
    return json_pack("[f,f,f]", x[0], x[1], x[2]);
}

static json_t *describe(const view_slices *s) {
    const leafcast_slice_pixels *n = &s->now;
    const bool final = s->scale == 0;
    return json_pack(
        "{s:s,s:I,s:i,s:i,s:i,s:[i,i],s:s,s:b,s:b,s:i,s:o,s:o,s:o,s:I,s:I,s:f,s:f}", "type",
        "slice", "slice", (json_int_t)s->wish.number, "pane", s->wish.pane, "width", (int)n->width,
        "height", (int)n->height, "size", (int)s->whole.width, (int)s->whole.height, "format",
        "png", "final", (int) final, "exact", final && n->level == 0, "level", (int)n->level,
        "origin", vector(n->origin), "u", vector(n->u), "v", vector(n->v), "treelets_read",
        (json_int_t)s->treelets_read, "bytes_read", (json_int_t)s->bytes_read, "render_ms",
        1e3 * s->drawn_s, "age_ms", 1e3 * (clock_seconds() - s->wish.asked));
}

static status make_message(view_slices *s, view_message **out) {
    const picture shown = {s->now.width, s->now.height, &s->image, NULL, 0};
    slice_request_draw(&s->wish.request, s->value, s->now.width, s->now.height, &s->image);
    view_message *made = view_message_new(s->tools.m, 64 << 10);
    if (!made)
        return ST_NOMEM;
    made->binary = made->slice = true;
    made->number = s->wish.number;
    status st = view_message_head(&made, describe(s));
    const byte_sink sink = {view_message_put, &made};
    if (st == ST_OK)
        st = picture_png_write(s->tools.m, s->tools.threads, &shown, &sink);
    if (st == ST_OK)
        *out = made;
    else
        view_message_free(made);
    return st;
}

static void learn(view_slices *s) {
    const double cost = s->drawn_s / ((double)s->now.width * s->now.height);
    s->cost = cost > s->cost ? cost : 0.5 * (cost + s->cost);
}

/* Send a picture that is complete. After a preview at rest, begin the whole. */
static status end_pass(view_slices *s, view_message **out) {
    const bool preview = s->scale > 0;
    learn(s);
    status st = make_message(s, out);
    pthread_mutex_lock(&s->lock);
    pane *p = &s->panes[s->wish.pane];
    p->sent = *out != NULL;
    p->unseen = s->wish.number;
    const bool newer = p->wanted;
    pthread_mutex_unlock(&s->lock);
    if (st == ST_OK && preview && !s->wish.moving && !newer)
        return begin_pass(s, 0);
    stop(s);
    return st;
}

static void tell_doing(const view_slices *s) {
    view_doing_begin(s->tools.doing, VIEW_DOING_SLICE, &s->wish.told, s->wish.number);
}

/* Begin the next wish. ST_STOPPED: none may be drawn now. */
static status begin_next(view_slices *s) {
    pthread_mutex_lock(&s->lock);
    const int k = find_pane(s);
    if (k >= 0) {
        s->wish = s->panes[k].wish;
        s->panes[k].wanted = false;
        s->next = (k + 1) % VIEW_PANES_MAX;
    }
    pthread_mutex_unlock(&s->lock);
    if (k < 0)
        return ST_STOPPED;
    tell_doing(s);
    return begin_wish(s);
}

/* Returns whether a newer wish of the pane replaces what is drawn; not a preview that will soon be
 * done. */
static bool gives_way(view_slices *s) {
    pthread_mutex_lock(&s->lock);
    const bool newer = s->drawn_pane >= 0 && s->panes[s->drawn_pane].wanted;
    pthread_mutex_unlock(&s->lock);
    return newer && (s->scale == 0 || s->drawn_s > 2.0 * VIEW_MOVING_S);
}

status view_slices_advance(view_slices *s, double seconds, uint64_t beside, view_message **out,
                           uint64_t *number, int *which) {
    *out = NULL;
    if (gives_way(s))
        stop(s);
    status st = ST_OK;
    if (s->drawn_pane < 0)
        st = begin_next(s);
    else
        tell_doing(s);
    *number = s->wish.number;
    *which = s->wish.pane;
    if (st == ST_OK)
        st = sample(s, seconds, beside);
    if (st == ST_OK && s->row == s->now.height)
        return end_pass(s, out);
    if (st != ST_OK)
        stop(s);
    return st == ST_STOPPED ? ST_OK : st;
}
