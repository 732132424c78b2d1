#include "render/view/view_talk.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/num.h"
#include "render/view/view_map.h"
#include "render/view/view_slice_state.h"
#include "render/view/view_state.h"

/* Messages per second, and how many may come at once: a hand moves at most that fast. */
enum { RATE = 500, BURST = 1000 };
#define NUMBER_MAX 9007199254740991.0 /* the largest integer that is exact in JavaScript */

struct view_talk {
    mem *m;
    view_seat *seat;
    const view_file *files;
    int file_count, file;    /* file_count files; `file` is shown */
    uint32_t steps;          /* that the page was told of; */
    uint32_t stuck;          /* and why there are no further ones (view_stuck) */
    const view_scene *scene; /* whose objects the files are; or NULL */
    const view_machine *machine;
    const view_life *life;
    uint64_t client;
    view_queue queue; /* sent before the messages at the seat */
    double allowance, last_received;
    size_t received, told; /* bytes of the message that arrives, and of the last one that arrived */
    view_wish wish;
    view_slice_wish slice;
    bool marks_steps; /* the page marks the steps that have the isovalues; */
    view_marks marks; /* those that it was told of last */
    char text[VIEW_HEARD_MAX];
};

static bool has_room(const view_talk *t) {
    return t->queue.count < VIEW_TEXTS_MAX;
}

static void tell(view_talk *t, json_t *object) {
    if (!has_room(t)) {
        json_decref(object);
        return;
    }
    view_message *message = view_message_json(t->m, object);
    if (message)
        view_queue_push(&t->queue, message);
}

/* ---- Steps that have the isovalues ---- */

static bool same_marks(const view_marks *a, const view_marks *b) {
    bool same = a->volume == b->volume && a->field == b->field && a->steps == b->steps &&
                a->count == b->count;
    for (int i = 0; i < a->count && same; i++)
        same = a->isovalues[i] == b->isovalues[i];
    return same;
}

/* Tell a page that marks steps where the newest view's isovalues are, unless it was told. */
static void tell_marks(view_talk *t) {
    if (!t->wish.volume)
        return;
    const view_options *view = view_wish_of_one(&t->wish);
    view_marks now = {.volume = t->wish.volume, .steps = t->steps, .count = view->isos};
    if (!t->marks_steps || now.volume != t->files[t->file].volume || now.steps < 2 ||
        !has_room(t) || view_options_field(view, now.volume, &now.field) != ST_OK)
        return;
    for (int i = 0; i < now.count; i++)
        now.isovalues[i] = view->surfaces[i].isovalue;
    if (same_marks(&now, &t->marks))
        return;
    t->marks = now;
    tell(t, view_map_marks(t->m, &now));
}

/* ---- The volume ---- */

/* type: "volume", or "grown": of the one that is shown, which has further steps. */
static void tell_volume(view_talk *t, const char *type) {
    json_t *said = view_volume_json(t->files, t->file_count, t->file, t->scene, t->machine);
    json_t *before = view_life_json(t->life);
    if (said) {
        json_object_set_new(said, "type", json_string(type));
        json_object_set_new(said, "talk", json_integer((json_int_t)t->client));
        t->steps = (uint32_t)json_array_size(json_object_get(said, "steps"));
    }
    if (said && before)
        json_object_set(said, "crash", before);
    json_decref(before);
    tell(t, said);
}

view_talk *view_talk_open(mem *m, view_draw *draw, const view_file *files, int count,
                          const view_scene *scene, const view_machine *machine, view_life *life) {
    view_talk *t = mem_zalloc(m, sizeof *t);
    if (!t)
        return NULL;
    t->m = m;
    t->files = files;
    t->file_count = count;
    t->scene = scene;
    t->machine = machine;
    t->life = life;
    t->client = view_life_client(life);
    t->allowance = BURST;
    t->last_received = clock_seconds();
    t->seat = view_draw_sit(draw);
    if (t->seat)
        tell_volume(t, "volume");
    if (t->queue.count > 0)
        return t;
    view_talk_close(t);
    return NULL;
}

void view_talk_close(view_talk *t) {
    if (!t)
        return;
    view_draw_leave(t->seat);
    view_queue_clear(&t->queue);
    view_wish_release(&t->wish);
    mem_free(t->m, t);
}

/* ---- Messages ---- */

static status wrong(const char *key) {
    return status_describe(ST_USAGE, "\"%s\" is missing, or none that can be", key);
}

static status take_number(const json_t *object, const char *key, double lo, double hi,
                          double *out) {
    const json_t *value = json_object_get(object, key);
    *out = json_number_value(value);
    return json_is_number(value) && *out >= lo && *out <= hi ? ST_OK : wrong(key);
}

static status take_whole(const json_t *object, const char *key, double lo, double hi, double *out) {
    const status st = take_number(object, key, lo, hi, out);
    return st == ST_OK && *out != floor(*out) ? wrong(key) : st;
}

/* Set what is to be shown from a state. */
static status take_state(mem *m, json_t *state, const view_scene *scene, view_wish *w) {
    view_changes *changes = NULL;
    const status st = scene ? view_changes_apply(m, state, scene, &w->view, &changes)
                            : view_state_apply(m, state, &w->view);
    if (st != ST_OK)
        return st;
    view_wish_release(w);
    w->scene = scene;
    w->changes = changes;
    return ST_OK;
}

/* Take a wish for a view. *number: 0 if the message has none. */
static status receive_view(view_talk *t, const json_t *message, double *number) {
    double width, height;
    json_t *state = json_object_get(message, "state");
    view_wish *w = &t->wish;
    status st = take_whole(message, "number", 0.0, NUMBER_MAX, number);
    if (st == ST_OK)
        st = take_whole(message, "width", 1.0, VIEW_SIDE_MAX, &width);
    if (st == ST_OK)
        st = take_whole(message, "height", 1.0, VIEW_SIDE_MAX, &height);
    if (st == ST_OK && !json_is_object(state))
        st = wrong("state");
    if (st == ST_OK)
        st = take_state(t->m, state, t->scene, w);
    if (st != ST_OK)
        return st;
    view_told_keep(&w->told, t->client, t->text, t->told);
    w->view.camera.width = (uint32_t)width;
    w->view.camera.height = (uint32_t)height;
    w->number = (uint64_t)*number;
    w->volume = t->files[t->file].volume;
    w->chosen = t->file;
    w->moving = json_is_true(json_object_get(message, "moving"));
    w->where = json_is_true(json_object_get(message, "where"));
    w->asked = clock_seconds();
    view_seat_want(t->seat, w);
    tell_marks(t);
    return ST_OK;
}

static status receive_seen(view_talk *t, const json_t *message) {
    double number, part;
    status st = take_whole(message, "number", 0.0, NUMBER_MAX, &number);
    if (st == ST_OK)
        st = take_whole(message, "part", 0.0, 1e9, &part);
    if (st == ST_OK)
        view_seat_seen(t->seat, (uint64_t)number, (int)part);
    return st;
}

static status take_point(const json_t *point, double out[3]) {
    for (size_t i = 0; i < 3; i++) {
        const json_t *value = json_array_get(point, i);
        if (!json_is_number(value) || json_array_size(point) != 3)
            return wrong("point");
        out[i] = json_number_value(value);
    }
    return ST_OK;
}

static status receive_pick(view_talk *t, const json_t *message) {
    const json_t *point = json_object_get(message, "point");
    view_place place = {.in_world = point};
    double id;
    status st = take_whole(message, "id", 0.0, NUMBER_MAX, &id);
    if (st == ST_OK && point)
        st = take_point(point, place.point);
    if (st == ST_OK && !point)
        st = take_number(message, "x", -VIEW_SIDE_MAX, 2.0 * VIEW_SIDE_MAX, &place.pixel[0]);
    if (st == ST_OK && !point)
        st = take_number(message, "y", -VIEW_SIDE_MAX, 2.0 * VIEW_SIDE_MAX, &place.pixel[1]);
    if (st == ST_OK && !view_seat_pick(t->seat, (int64_t)id, &place))
        st = status_describe(ST_USAGE, "too many picks at a time, or none of a view");
    return st;
}

static status receive_slice(view_talk *t, const json_t *message) {
    view_slice_wish *w = &t->slice;
    double number, pane, side[2];
    status st = take_whole(message, "slice", 0.0, NUMBER_MAX, &number);
    if (st == ST_OK)
        st = take_whole(message, "pane", 0.0, VIEW_PANES_MAX - 1, &pane);
    if (st == ST_OK)
        st = take_whole(message, "width", 1.0, VIEW_SLICE_SIDE_MAX, &side[0]);
    if (st == ST_OK)
        st = take_whole(message, "height", 1.0, VIEW_SLICE_SIDE_MAX, &side[1]);
    if (st == ST_OK && side[0] * side[1] > VIEW_SLICE_PIXELS_MAX)
        st = status_describe(ST_USAGE, "a slice may have %d pixels", VIEW_SLICE_PIXELS_MAX);
    if (st == ST_OK)
        st = view_slice_state_apply(t->m, json_object_get(message, "state"), &w->request);
    if (st != ST_OK)
        return st;
    view_told_keep(&w->told, t->client, t->text, t->told);
    for (int i = 0; i < 2; i++)
        w->box[i] = (uint32_t)side[i];
    w->number = (uint64_t)number;
    w->pane = (int)pane;
    w->volume = t->files[t->file].volume;
    w->moving = json_is_true(json_object_get(message, "moving"));
    w->asked = clock_seconds();
    view_seat_slice(t->seat, w);
    return ST_OK;
}

static status receive_slice_seen(view_talk *t, const json_t *message) {
    double number, pane;
    status st = take_whole(message, "slice", 0.0, NUMBER_MAX, &number);
    if (st == ST_OK)
        st = take_whole(message, "pane", 0.0, VIEW_PANES_MAX - 1, &pane);
    if (st == ST_OK)
        view_seat_slice_seen(t->seat, (int)pane, (uint64_t)number);
    return st;
}

static status receive_open(view_talk *t, const json_t *message) {
    double file;
    const status st = take_whole(message, "file", 0.0, t->file_count - 1, &file);
    if (st != ST_OK)
        return st;
    t->file = (int)file;
    tell_volume(t, "volume");
    return ST_OK;
}

static status receive_message(view_talk *t, const json_t *message, double *number) {
    const char *type = json_string_value(json_object_get(message, "type"));
    *number = 0.0;
    if (!type)
        return wrong("type");
    if (strcmp(type, "view") == 0)
        return receive_view(t, message, number);
    if (strcmp(type, "seen") == 0)
        return receive_seen(t, message);
    if (strcmp(type, "pick") == 0)
        return receive_pick(t, message);
    if (strcmp(type, "slice") == 0)
        return receive_slice(t, message);
    if (strcmp(type, "slice-seen") == 0)
        return receive_slice_seen(t, message);
    if (strcmp(type, "open") == 0)
        return receive_open(t, message);
    if (strcmp(type, "residency") == 0) {
        const view_residency wanted = {json_is_true(json_object_get(message, "on")),
                                       json_is_true(json_object_get(message, "steps"))};
        view_seat_residency(t->seat, &wanted);
        t->marks_steps = wanted.steps;
        t->marks = (view_marks){0}; /* what shows them may be new */
        tell_marks(t);
        return ST_OK;
    }
    return wrong("type");
}

static bool is_too_fast(view_talk *t) {
    const double now = clock_seconds();
    t->allowance = fmin(BURST, t->allowance + RATE * (now - t->last_received)) - 1.0;
    t->last_received = now;
    return t->allowance < 0.0;
}

/* Tell the page why its message is refused. The refusal of a pick has its id, like an answer. */
static void refuse(view_talk *t, const json_t *message, double number) {
    json_t *id = json_object_get(message, "id");
    json_t *said = json_pack("{s:s,s:I,s:s}", "type", "refused", "number", (json_int_t)number,
                             "why", view_message_why());
    if (said && json_is_integer(id))
        json_object_set(said, "id", id);
    tell(t, said);
}

view_talk_result view_talk_receive(view_talk *t, const void *bytes, size_t size, bool last) {
    json_t *message = NULL;
    double number = 0.0;
    if (size > sizeof t->text - t->received)
        return VIEW_TALK_TOO_LONG;
    if (size > 0)
        memcpy(t->text + t->received, bytes, size);
    t->received += size;
    if (!last)
        return VIEW_TALK_FINE;
    if (is_too_fast(t))
        return VIEW_TALK_TOO_FAST;
    status st = view_state_parse(t->text, t->received, &message);
    t->told = t->received;
    t->received = 0;
    if (st == ST_OK)
        st = receive_message(t, message, &number);
    if (st != ST_OK)
        refuse(t, message, number);
    json_decref(message);
    return VIEW_TALK_FINE;
}

/* Tell the page why its file takes in no further steps, or that it does again. Returns whether it
 * did not know. */
static bool tell_stuck(view_talk *t) {
    const view_stuck now = view_seat_stuck(t->seat, t->file);
    if (now.number == t->stuck || !has_room(t))
        return false;
    t->stuck = now.number;
    tell(t, json_pack("{s:s,s:s?}", "type", "stuck", "why", now.number ? now.why : NULL));
    return true;
}

bool view_talk_follow(view_talk *t) {
    const bool grown = leafcast_describe(t->files[t->file].volume).steps != t->steps;
    if (grown) {
        tell_volume(t, "grown");
        tell_marks(t);
    }
    return tell_stuck(t) || grown;
}

view_message *view_talk_next(view_talk *t) {
    view_message *message = view_queue_pop(&t->queue);
    return message ? message : view_seat_take(t->seat);
}

bool view_talk_any(view_talk *t) {
    return t->queue.first || view_seat_any(t->seat);
}

/* ---- Pictures as files ---- */

status view_talk_file(mem *m, const view_file *files, int count, const view_scene *scene,
                      const char *state, const char *size, const char *file, view_wish *wish) {
    double sides[2] = {0.0, 0.0};
    int64_t which = 0;
    json_t *object = NULL;
    status st = view_state_parse(state, strlen(state), &object);
    if (st == ST_OK)
        st = take_state(m, object, scene, wish);
    json_decref(object);
    if (st == ST_OK)
        st = num_doubles(size, "size", "x", 2, sides);
    if (st == ST_OK && file[0])
        st = num_int(file, "file", 0, count - 1, &which);
    for (int i = 0; i < 2 && st == ST_OK; i++)
        if (!(sides[i] >= 1.0 && sides[i] <= VIEW_SIDE_MAX && sides[i] == floor(sides[i])))
            st = status_describe(ST_USAGE, "size: a side is 1 to %d", VIEW_SIDE_MAX);
    if (st != ST_OK)
        return st;
    view_told_keep(&wish->told, 0, state, strlen(state));
    wish->view.camera.width = (uint32_t)sides[0];
    wish->view.camera.height = (uint32_t)sides[1];
    wish->number = 0;
    wish->volume = files[which].volume;
    wish->chosen = (int)which;
    wish->moving = false;
    wish->file = true;
    wish->asked = clock_seconds();
    return ST_OK;
}
