#include "render/view/view_draw.h"

#include <pthread.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/thread.h"
#include "render/view/view_map.h"

/* Seconds of one turn; then the next client has its own. */
#define SLICE_S 0.030
/* Least seconds between two maps of treelets; the last part always gets one. */
#define MAP_S 0.2
/* Pictures as files are drawn one after another: each takes 12 bytes a pixel and more. The next one
 * begins when no more than so many bytes of those before it still wait for their clients. */
enum { HELD_MAX = 64 << 20 };

typedef struct pick {
    int64_t id;
    view_place place;
} pick;

typedef struct sent {
    uint64_t number;
    int part;
} sent;

struct view_seat {
    /* Set from opening to closing. The contents of picture and slices belong to the drawing
     * thread: */
    view_draw *draw;
    view_picture *picture;
    view_slices *slices;
    double mapped; /* when the last map of treelets was sent */
    /* The client's; zeros: the seat is free. */
    bool taken, gone; /* gone: the client has left, and the drawing thread has to clear the seat */
    view_wish wish;   /* the newest wish */
    bool wanted;      /* drawing it has not begun */
    bool any;         /* there was a wish */
    bool patient; /* a file for which there was no memory: it waits until no other one is held */
    pick picks[VIEW_PICKS_MAX];
    int pick_count;
    view_residency residency;
    view_queue queue;
    sent unseen[VIEW_UNSEEN_MAX];
    int unseen_count;
};

struct view_draw {
    mem *m;
    view_tools tools;
    const view_file *files;
    int file_count;
    void (*notify)(void *ctx);
    void *ctx;
    pthread_t thread;
    pthread_mutex_t lock; /* guards all that follows, and the seats */
    pthread_cond_t work;
    bool ending;
    bool refresh;    /* files may have grown */
    int skips, most; /* of refreshes, after one that failed: how many are left, and were at first */
    view_stuck *stuck; /* per file */
    uint32_t reasons;  /* that files were stuck for */
    size_t held;       /* bytes of pictures as files that are not sent yet */
    int next;          /* the seat whose turn is next */
    view_seat seats[VIEW_SEATS_MAX];
};

/* What a seat needs now. */
typedef struct turn {
    bool leave, begin, draw, may_send, pick, slice;
    pick picked;
    view_residency residency;
    size_t held;
} turn;

/* ---- Messages ---- */

static void say(view_draw *d, view_seat *seat, view_message *message) {
    if (!message)
        return;
    pthread_mutex_lock(&d->lock);
    message->held = seat->wish.file && message->binary ? message->room : 0;
    const bool full = !message->binary && seat->queue.count >= VIEW_TEXTS_MAX;
    if (seat->gone || full) {
        view_message_free(message);
        message = NULL;
    } else {
        if (message->binary && !message->slice && seat->unseen_count < VIEW_UNSEEN_MAX)
            seat->unseen[seat->unseen_count++] = (sent){message->number, message->part};
        d->held += message->held;
        view_queue_push(&seat->queue, message);
    }
    pthread_mutex_unlock(&d->lock);
    if (message)
        d->notify(d->ctx);
}

static void refuse(view_draw *d, view_seat *seat, uint64_t number) {
    view_message *message =
        view_message_json(d->m, json_pack("{s:s,s:I,s:s}", "type", "refused", "number",
                                          (json_int_t)number, "why", view_message_why()));
    if (message)
        message->failed = true;
    say(d, seat, message);
}

/* ---- A turn; the lock is not held ---- */

static uint64_t others_bytes(const view_draw *d, const view_seat *seat, size_t held) {
    uint64_t bytes = held;
    for (int i = 0; i < VIEW_SEATS_MAX; i++) {
        if (&d->seats[i] != seat)
            bytes += view_picture_bytes(d->seats[i].picture);
        bytes += view_slices_bytes(d->seats[i].slices);
    }
    return bytes;
}

static void answer_pick(view_draw *d, view_seat *seat, const view_wish *wish, const pick *what) {
    json_t *answer = NULL;
    if (view_pick(d->m, wish, &what->place, &answer) != ST_OK)
        answer = json_pack("{s:s,s:b,s:s}", "type", "picked", "hit", 0, "why", view_message_why());
    if (answer) {
        json_object_set_new(answer, "number", json_integer((json_int_t)wish->number));
        json_object_set_new(answer, "id", json_integer(what->id));
    }
    say(d, seat, view_message_json(d->m, answer));
}

static void tell_steps(view_draw *d, view_seat *seat) {
    const view_wish *wish = view_picture_wish(seat->picture);
    uint32_t field;
    if (view_options_field(view_wish_of_one(wish), wish->volume, &field) == ST_OK)
        say(d, seat, view_message_json(d->m, view_map_steps(d->m, wish->volume, field)));
}

static void tell_residency(view_draw *d, view_seat *seat, const view_residency *wanted) {
    const view_picture *p = seat->picture;
    const double now = clock_seconds();
    const bool last = !view_picture_busy(p) && !view_picture_wish(p)->moving;
    if (!last && now - seat->mapped < MAP_S)
        return;
    seat->mapped = now;
    if (wanted->map)
        say(d, seat,
            view_message_json(d->m,
                              view_map_describe(d->m, view_picture_wish(p)->volume,
                                                view_picture_level(p), view_picture_stats(p))));
    if (wanted->steps)
        tell_steps(d, seat);
}

/* What is held leaves no memory for a file: it is drawn when that is sent. */
static void wait_for_room(view_draw *d, view_seat *seat) {
    pthread_mutex_lock(&d->lock);
    seat->wanted = seat->patient = true;
    pthread_mutex_unlock(&d->lock);
}

static void draw_slice(view_draw *d, view_seat *seat, const turn *t) {
    view_message *message = NULL;
    const uint64_t number = view_picture_wish(seat->picture)->number;
    const status st = view_picture_advance(seat->picture, SLICE_S, t->may_send, &message);
    if (st == ST_NOMEM && view_picture_wish(seat->picture)->file && t->held > 0)
        wait_for_room(d, seat);
    else if (st != ST_OK && st != ST_STOPPED)
        refuse(d, seat, number);
    const bool any = message != NULL;
    if (!view_picture_busy(seat->picture))
        view_doing_end(d->tools.doing); /* before a client can know that the picture is done */
    say(d, seat, message);
    if (any && (t->residency.map || t->residency.steps))
        tell_residency(d, seat, &t->residency);
}

static void draw_panes(view_draw *d, view_seat *seat, size_t held) {
    view_message *message = NULL;
    uint64_t number;
    int pane;
    const uint64_t beside = others_bytes(d, seat, held) + view_picture_bytes(seat->picture) -
                            view_slices_bytes(seat->slices);
    const status st = view_slices_advance(seat->slices, SLICE_S, beside, &message, &number, &pane);
    if (st != ST_OK)
        message = view_message_json(d->m, json_pack("{s:s,s:I,s:i,s:s}", "type", "refused", "slice",
                                                    (json_int_t)number, "pane", pane, "why",
                                                    view_message_why()));
    say(d, seat, message);
}

static void tell_doing(view_draw *d, view_doing_what what, const view_wish *wish) {
    view_doing_begin(d->tools.doing, wish->file ? VIEW_DOING_FILE : what, &wish->told,
                     wish->number);
}

static void take_turn(view_draw *d, view_seat *seat, const turn *t, const view_wish *wish) {
    if (t->leave) {
        view_picture_leave(seat->picture);
        view_slices_clear(seat->slices);
        return;
    }
    if (t->slice)
        draw_panes(d, seat, t->held);
    if (t->pick) {
        tell_doing(d, VIEW_DOING_PICK, wish);
        answer_pick(d, seat, wish, &t->picked);
    }
    if (t->begin || t->draw)
        tell_doing(d, VIEW_DOING_VIEW, t->begin ? wish : view_picture_wish(seat->picture));
    if (t->begin &&
        view_picture_begin(seat->picture, wish, others_bytes(d, seat, t->held)) != ST_OK) {
        view_picture_stop(seat->picture);
        refuse(d, seat, wish->number);
    } else if (t->begin || t->draw) {
        draw_slice(d, seat, t);
    }
}

/* ---- Whose turn it is; the lock is held ---- */

/* Whether a file has to wait until others are drawn, or sent. */
static bool file_waits(const view_draw *d, const view_seat *seat) {
    if (!seat->wish.file)
        return false;
    for (int i = 0; i < VIEW_SEATS_MAX; i++)
        if (&d->seats[i] != seat && d->seats[i].wish.file && view_picture_busy(d->seats[i].picture))
            return true;
    return d->held > (seat->patient ? 0 : HELD_MAX);
}

static bool needs(const view_seat *seat, turn *t) {
    *t = (turn){.leave = seat->gone,
                .held = seat->draw->held,
                .may_send = seat->unseen_count < VIEW_UNSEEN_MAX,
                .residency = seat->residency};
    if (!seat->taken)
        return false;
    if (t->leave)
        return true;
    t->pick = seat->pick_count > 0;
    t->begin = seat->wanted && !file_waits(seat->draw, seat) &&
               view_picture_may_change(seat->picture) &&
               (t->may_send || view_picture_busy(seat->picture));
    t->draw = !t->begin && view_picture_busy(seat->picture) &&
              !view_picture_writes(seat->picture) &&
              (t->may_send || !view_picture_waits(seat->picture));
    t->slice = view_slices_need(seat->slices);
    return t->pick || t->begin || t->draw || t->slice;
}

static view_seat *next_seat(view_draw *d, turn *t) {
    for (int i = 0; i < VIEW_SEATS_MAX; i++) {
        view_seat *seat = &d->seats[(d->next + i) % VIEW_SEATS_MAX];
        if (needs(seat, t)) {
            d->next = (d->next + i + 1) % VIEW_SEATS_MAX;
            return seat;
        }
    }
    return NULL;
}

static void clear(view_seat *seat) {
    const size_t kept = offsetof(view_seat, taken); /* fields before are read without the lock */
    for (const view_message *at = seat->queue.first; at; at = at->next)
        seat->draw->held -= at->held;
    view_queue_clear(&seat->queue);
    view_wish_release(&seat->wish);
    memset((char *)seat + kept, 0, sizeof *seat - kept);
}

/* Note how a file's refresh ended. Needs the lock. */
static void note_refresh(view_draw *d, int file, leafcast_status st) {
    view_stuck *now = &d->stuck[file];
    if (st == LEAFCAST_OK) {
        now->number = 0;
    } else if (now->number == 0 || strncmp(now->why, view_message_why(), VIEW_WHY_MAX - 1) != 0) {
        now->number = ++d->reasons;
        snprintf(now->why, sizeof now->why, "%s", view_message_why());
    }
}

/* Take in the steps that have come. What fails leaves a volume as it was, and is tried again ever
 * less often. Releases the lock meanwhile. */
static void refresh_files(view_draw *d) {
    enum { SKIPS_MAX = 63 };
    bool failed = false;
    d->refresh = false;
    if (d->skips > 0) {
        d->skips--;
        return;
    }
    for (int i = 0; i < d->file_count; i++) {
        uint32_t steps;
        pthread_mutex_unlock(&d->lock);
        const leafcast_status st = leafcast_refresh(d->files[i].volume, &steps);
        pthread_mutex_lock(&d->lock);
        note_refresh(d, i, st);
        failed |= st != LEAFCAST_OK;
    }
    d->most = !failed ? 0 : d->most < SKIPS_MAX ? 2 * d->most + 1 : SKIPS_MAX;
    d->skips = d->most;
}

static void *draw_all(void *arg) {
    view_draw *d = arg;
    view_wish *wish = mem_zalloc(d->m, sizeof *wish);
    turn t;
    pthread_mutex_lock(&d->lock);
    while (!d->ending && wish) {
        if (d->refresh)
            refresh_files(d);
        view_seat *seat = next_seat(d, &t);
        if (!seat) {
            pthread_cond_wait(&d->work, &d->lock);
            continue;
        }
        if (t.begin || t.pick)
            view_wish_copy(wish, &seat->wish);
        if (t.begin)
            seat->wanted = false;
        if (t.pick) {
            t.picked = seat->picks[0];
            seat->pick_count--;
            memmove(seat->picks, seat->picks + 1, (size_t)seat->pick_count * sizeof *seat->picks);
        }
        pthread_mutex_unlock(&d->lock);
        take_turn(d, seat, &t, wish);
        view_doing_end(d->tools.doing);
        pthread_mutex_lock(&d->lock);
        if (t.leave)
            clear(seat);
    }
    pthread_mutex_unlock(&d->lock);
    if (wish)
        view_wish_release(wish);
    mem_free(d->m, wish);
    return NULL;
}

/* ---- Opening and closing ---- */

static void wake(void *ctx) {
    view_draw *d = ctx;
    pthread_mutex_lock(&d->lock);
    pthread_cond_signal(&d->work);
    pthread_mutex_unlock(&d->lock);
}

static void release(view_draw *d) {
    for (int i = 0; i < VIEW_SEATS_MAX; i++) {
        view_queue_clear(&d->seats[i].queue);
        view_wish_release(&d->seats[i].wish);
        view_picture_destroy(d->seats[i].picture);
        view_slices_destroy(d->seats[i].slices);
    }
    mem_free(d->m, d->stuck);
    view_jpeg_close(d->tools.jpeg);
    pool_destroy(d->tools.threads);
    pthread_cond_destroy(&d->work);
    pthread_mutex_destroy(&d->lock);
    mem_free(d->m, d);
}

status view_draw_open(mem *m, const view_file *files, int count, int threads, view_doing *doing,
                      void (*notify)(void *ctx), void *ctx, view_draw **out) {
    view_draw *d = mem_zalloc(m, sizeof *d);
    if (!d)
        return ST_NOMEM;
    *d = (view_draw){.m = m,
                     .tools = {.m = m, .doing = doing, .wake = wake, .wake_ctx = d},
                     .files = files,
                     .file_count = count,
                     .notify = notify,
                     .ctx = ctx};
    pthread_mutex_init(&d->lock, NULL);
    pthread_cond_init(&d->work, NULL);
    status st = pool_create(m, threads, &d->tools.threads);
    d->stuck = mem_array(m, (size_t)count, sizeof *d->stuck);
    if (st == ST_OK && !d->stuck)
        st = ST_NOMEM;
    if (st == ST_OK)
        st = view_jpeg_open(m, &d->tools.jpeg);
    for (int i = 0; i < VIEW_SEATS_MAX && st == ST_OK; i++) {
        d->seats[i].draw = d;
        st = view_picture_create(&d->tools, &d->seats[i].picture);
        if (st == ST_OK)
            st = view_slices_create(&d->tools, &d->seats[i].slices);
    }
    if (st == ST_OK)
        st = thread_start(&d->thread, draw_all, d, "the thread that draws");
    if (st == ST_OK)
        *out = d;
    else
        release(d);
    return st;
}

void view_draw_close(view_draw *d) {
    if (!d)
        return;
    pthread_mutex_lock(&d->lock);
    d->ending = true;
    pthread_cond_signal(&d->work);
    pthread_mutex_unlock(&d->lock);
    for (int i = 0; i < VIEW_SEATS_MAX; i++) {
        view_picture_cancel(d->seats[i].picture);
        view_slices_cancel(d->seats[i].slices);
    }
    pthread_join(d->thread, NULL);
    release(d);
}

void view_draw_sent(view_draw *d, view_message *file) {
    if (file && d) {
        pthread_mutex_lock(&d->lock);
        d->held -= file->held;
        pthread_cond_signal(&d->work);
        pthread_mutex_unlock(&d->lock);
    }
    view_message_free(file);
}

void view_draw_refresh(view_draw *d) {
    pthread_mutex_lock(&d->lock);
    d->refresh = true;
    pthread_cond_signal(&d->work);
    pthread_mutex_unlock(&d->lock);
}

/* ---- Seats ---- */

view_seat *view_draw_sit(view_draw *d) {
    view_seat *found = NULL;
    pthread_mutex_lock(&d->lock);
    for (int i = 0; i < VIEW_SEATS_MAX && !found; i++)
        if (!d->seats[i].taken) {
            found = &d->seats[i];
            found->taken = true;
        }
    pthread_mutex_unlock(&d->lock);
    return found;
}

void view_draw_leave(view_seat *seat) {
    if (!seat)
        return;
    pthread_mutex_lock(&seat->draw->lock);
    seat->gone = true;
    view_picture_cancel(seat->picture);
    view_slices_cancel(seat->slices);
    pthread_cond_signal(&seat->draw->work);
    pthread_mutex_unlock(&seat->draw->lock);
}

void view_seat_want(view_seat *seat, const view_wish *wish) {
    pthread_mutex_lock(&seat->draw->lock);
    view_wish_copy(&seat->wish, wish);
    seat->wanted = seat->any = true;
    view_picture_cancel_rest(seat->picture);
    pthread_cond_signal(&seat->draw->work);
    pthread_mutex_unlock(&seat->draw->lock);
}

void view_seat_seen(view_seat *seat, uint64_t number, int part) {
    int kept = 0;
    pthread_mutex_lock(&seat->draw->lock);
    for (int i = 0; i < seat->unseen_count; i++) {
        const sent *s = &seat->unseen[i];
        if (s->number > number || (s->number == number && s->part > part))
            seat->unseen[kept++] = *s;
    }
    seat->unseen_count = kept;
    pthread_cond_signal(&seat->draw->work);
    pthread_mutex_unlock(&seat->draw->lock);
}

bool view_seat_pick(view_seat *seat, int64_t id, const view_place *place) {
    pthread_mutex_lock(&seat->draw->lock);
    const bool room = seat->any && seat->pick_count < VIEW_PICKS_MAX;
    if (room)
        seat->picks[seat->pick_count++] = (pick){id, *place};
    pthread_cond_signal(&seat->draw->work);
    pthread_mutex_unlock(&seat->draw->lock);
    return room;
}

void view_seat_slice(view_seat *seat, const view_slice_wish *wish) {
    pthread_mutex_lock(&seat->draw->lock);
    view_slices_want(seat->slices, wish);
    pthread_cond_signal(&seat->draw->work);
    pthread_mutex_unlock(&seat->draw->lock);
}

void view_seat_slice_seen(view_seat *seat, int pane, uint64_t number) {
    pthread_mutex_lock(&seat->draw->lock);
    view_slices_seen(seat->slices, pane, number);
    pthread_cond_signal(&seat->draw->work);
    pthread_mutex_unlock(&seat->draw->lock);
}

void view_seat_residency(view_seat *seat, const view_residency *wanted) {
    pthread_mutex_lock(&seat->draw->lock);
    seat->residency = *wanted;
    pthread_mutex_unlock(&seat->draw->lock);
}

view_stuck view_seat_stuck(view_seat *seat, int file) {
    pthread_mutex_lock(&seat->draw->lock);
    const view_stuck now = seat->draw->stuck[file];
    pthread_mutex_unlock(&seat->draw->lock);
    return now;
}

view_message *view_seat_take(view_seat *seat) {
    pthread_mutex_lock(&seat->draw->lock);
    view_message *message = view_queue_pop(&seat->queue);
    pthread_mutex_unlock(&seat->draw->lock);
    return message;
}

bool view_seat_any(view_seat *seat) {
    pthread_mutex_lock(&seat->draw->lock);
    const bool any = seat->queue.first != NULL;
    pthread_mutex_unlock(&seat->draw->lock);
    return any;
}
