#include "render/app/scene_file.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "formats/base/file.h"
#include "formats/input/named_file.h"
#include "render/app/colour.h"
#include "render/app/colour_map.h"
#include "render/app/render_script.h"
#include "render/app/scene_place.h"
#include "render/app/transfer_preset.h"
#include "render/ray/placement.h"

enum { WHAT_MAX = 512 };

/* A scene file that is being read. */
typedef struct reading {
    mem m; /* outside of all budgets */
    const char *path;
    bool follow_links;
    view_options picture; /* the keys outside of "objects" */
    render_also *objects;
    int count;
} reading;

/* Where in the file: its name, and a path of keys. */
static const char *place_in(const reading *r, char what[WHAT_MAX], const char *form, ...) {
    va_list args;
    const int n = snprintf(what, WHAT_MAX, "%s: ", r->path);
    va_start(args, form);
    if (n > 0 && n < WHAT_MAX)
        vsnprintf(what + n, (size_t)(WHAT_MAX - n), form, args);
    va_end(args);
    return what;
}

/* ---- Keys ---- */

static const char OBJECT_KEYS[] = "file surfaces transform instances",
                  SURFACE_KEYS[] = "isovalue colour color opacity reflectivity",
                  PICTURE_KEYS[] = "objects camera",
                  CAMERA_KEYS[] = "eye look-at look_at up fov view ortho";

/* Refuse a key. known: those that are no flags of render's. */
static status unknown(const char *what, const char *key, const char *known) {
    return status_describe(ST_USAGE, "%s: there is no \"%s\" (keys: %s%s)", what, key, known,
                           known == SURFACE_KEYS ? "" : ", and flags");
}

/* Whether a key is a flag of one volume (of_one), or of the picture. */
static bool is_flag(const char *key, bool of_one) {
    bool repeats;
    view_value takes;
    const int flag = view_options_key(key, &repeats, &takes);
    return flag && view_options_of_one(flag) == of_one;
}

/* ---- Files ---- */

static status find_file(const reading *r, const char *name, const char *what, char **out) {
    mem m = r->m;
    char why[STATUS_TEXT_MAX];
    const status st = named_file_find(&m, r->path, name, r->follow_links, out);
    if (st == ST_OK)
        return ST_OK;
    snprintf(why, sizeof why, "%s", status_text());
    return status_describe(st, "%s: %s", what, why);
}

static bool is_map(const reading *r, const char *name) {
    transfer_list map = {.m = (mem *)(uintptr_t)&r->m};
    const bool is = colour_map_named(name, &map) == ST_OK;
    transfer_list_release(&map);
    return is;
}

/* Let the name of a transfer function or map lead where the scene file says, unless `is` one that
 * is known by name. FILE#NAME is a map in a file. */
static status lead(const reading *r, char name[MEDIUM_NAME_MAX], bool is, const char *what) {
    char first[MEDIUM_NAME_MAX], rest[MEDIUM_NAME_MAX], *path = NULL;
    mem m = r->m;
    if (!name[0] || is)
        return ST_OK;
    const size_t length = strcspn(name, "#");
    snprintf(first, sizeof first, "%.*s", (int)length, name);
    snprintf(rest, sizeof rest, "%s", name + length);
    status st = find_file(r, first, what, &path);
    if (st == ST_OK && strlen(path) + strlen(rest) >= MEDIUM_NAME_MAX)
        st = status_describe(ST_USAGE, "%s: a name of more than %d bytes: %s", what,
                             MEDIUM_NAME_MAX - 1, path);
    if (st == ST_OK)
        snprintf(name, MEDIUM_NAME_MAX, "%s%s", path, rest);
    mem_free(&m, path);
    return st;
}

static status lead_medium(const reading *r, medium_options *medium, const char *what) {
    status st = lead(r, medium->tf, transfer_preset_is(medium->tf), what);
    return st == ST_OK ? lead(r, medium->colour_map, is_map(r, medium->colour_map), what) : st;
}

/* ---- Objects ---- */

/* Read {"isovalue": 0.5, "colour": "red", "opacity": 0.4}. */
static status read_surface(json_t *value, const char *what, leafcast_surface *s) {
    const char *key;
    json_t *item;
    status st = ST_OK;
    if (!json_is_object(value) || !json_is_number(json_object_get(value, "isovalue")))
        return status_describe(ST_USAGE, "%s: a surface is an object with an \"isovalue\"", what);
    *s = leafcast_surface_default(json_number_value(json_object_get(value, "isovalue")));
    json_object_foreach(value, key, item) {
        char text[SCRIPT_TEXT_MAX];
        const double number = json_number_value(item);
        if (st != ST_OK || strcmp(key, "isovalue") == 0)
            continue;
        if (strcmp(key, "opacity") == 0) {
            s->opacity = (float)number;
            if (!json_is_number(item) || !(number > 0.0 && number <= 1.0))
                st =
                    status_describe(ST_USAGE, "%s: \"opacity\" takes a number above 0, to 1", what);
        } else if (strcmp(key, "reflectivity") == 0) {
            s->reflectivity = (float)number;
            if (!json_is_number(item) || !(number >= 0.0 && number <= 1.0))
                st = status_describe(ST_USAGE, "%s: \"reflectivity\" takes a number, 0 to 1", what);
        } else if (strcmp(key, "colour") == 0 || strcmp(key, "color") == 0) {
            st = script_text(item, what, key, text);
            if (st == ST_OK)
                st = colour_parse(text, what, s->rgb, NULL);
        } else {
            st = unknown(what, key, SURFACE_KEYS);
        }
    }
    return st;
}

static status read_surfaces(const reading *r, int object, const json_t *value, view_options *v) {
    char what[WHAT_MAX];
    const size_t count = json_array_size(value);
    if (!json_is_array(value) || count == 0 || count > LEAFCAST_SURFACES_MAX || v->isos > 0)
        return status_describe(ST_USAGE, "%s: an array of 1 to %d, instead of \"iso\"",
                               place_in(r, what, "objects[%d].surfaces", object),
                               LEAFCAST_SURFACES_MAX);
    status st = ST_OK;
    for (size_t i = 0; i < count && st == ST_OK; i++)
        st = read_surface(json_array_get(value, i),
                          place_in(r, what, "objects[%d].surfaces[%zu]", object, i),
                          &v->surfaces[i]);
    v->isos = v->colours = v->opacities = v->reflects = (int)count;
    for (size_t i = 0; i < count && v->scene.bounces == 0; i++)
        v->scene.bounces = v->surfaces[i].reflectivity > 0.0f;
    return st;
}

static status read_place(const json_t *value, const char *what, const double *first,
                         double place[12]) {
    double own[12];
    char why[STATUS_TEXT_MAX];
    status st = scene_place_read(value, what, own);
    if (st != ST_OK)
        return st;
    if (first) {
        memcpy(place, first, 12 * sizeof *place);
        scene_place_after(place, own);
    } else {
        memcpy(place, own, sizeof own);
    }
    st = placement_check(place);
    if (st == ST_OK)
        return ST_OK;
    snprintf(why, sizeof why, "%s", status_text());
    return status_describe(st, "%s: %s", what, why);
}

/* Read "transform", and "instances": places that follow it. */
static status read_places(reading *r, int object, const json_t *value, render_places *places) {
    const json_t *transform = json_object_get(value, "transform"),
                 *instances = json_object_get(value, "instances");
    const size_t count = instances ? json_array_size(instances) : 1;
    char what[WHAT_MAX];
    double first[12];
    status st = ST_OK;
    if (!transform && !instances)
        return ST_OK;
    if (count == 0 || count > LEAFCAST_VOLUMES_MAX)
        return status_describe(ST_USAGE, "%s: an array of 1 to %d transforms",
                               place_in(r, what, "objects[%d].instances", object),
                               LEAFCAST_VOLUMES_MAX);
    places->at = mem_array(&r->m, count, 12 * sizeof *places->at);
    if (!places->at)
        return ST_NOMEM;
    places->count = (int)count;
    if (transform)
        st = read_place(transform, place_in(r, what, "objects[%d].transform", object), NULL, first);
    if (!instances)
        memcpy(places->at, first, sizeof first);
    for (size_t i = 0; i < count && instances && st == ST_OK; i++)
        st = read_place(json_array_get(instances, i),
                        place_in(r, what, "objects[%d].instances[%zu]", object, i),
                        transform ? first : NULL, places->at + 12 * i);
    return st;
}

static status read_object(reading *r, int i, json_t *value) {
    render_also *to = &r->objects[i];
    char what[WHAT_MAX];
    const char *key, *name = json_string_value(json_object_get(value, "file"));
    json_t *item;
    status st = ST_OK;
    place_in(r, what, "objects[%d]", i);
    if (!json_is_object(value) || !name || !*name)
        return status_describe(ST_USAGE, "%s: an object has a \"file\"", what);
    to->same = -1;
    view_options_init(&to->view);
    to->view.takes_media = true;
    to->view.colour_by_from = r->path;
    to->view.colour_by_links = r->follow_links;
    json_object_foreach(value, key, item) {
        if (st != ST_OK || cli_options_listed(OBJECT_KEYS, key))
            continue;
        st = is_flag(key, true) ? script_flag(&to->view, key, item, what)
                                : unknown(what, key, OBJECT_KEYS);
    }
    if (st == ST_OK)
        st = find_file(r, name, what, &to->allocated);
    to->path = to->allocated;
    if (st == ST_OK)
        st = lead_medium(r, &to->view.medium, what);
    if (st == ST_OK && json_object_get(value, "surfaces"))
        st = read_surfaces(r, i, json_object_get(value, "surfaces"), &to->view);
    return st == ST_OK ? read_places(r, i, value, &to->places) : st;
}

static bool same_moment(const view_options *a, const view_options *b) {
    return strcmp(a->field, b->field) == 0 && a->step == b->step &&
           a->time.given == b->time.given && a->time.interpolate == b->time.interpolate &&
           (!a->time.given || a->time.time == b->time.time);
}

/* Open a file once for all objects that show the same of it. */
static void share_file(reading *r, int i) {
    for (int k = 0; k < i; k++)
        if (r->objects[k].same < 0 && strcmp(r->objects[k].path, r->objects[i].path) == 0 &&
            same_moment(&r->objects[k].view, &r->objects[i].view)) {
            r->objects[i].same = k;
            return;
        }
}

static status read_objects(reading *r, const json_t *value) {
    char what[WHAT_MAX];
    const size_t count = json_array_size(value);
    if (count == 0 || count > LEAFCAST_VOLUMES_MAX)
        return status_describe(ST_USAGE, "%s: an array of 1 to %d", place_in(r, what, "objects"),
                               LEAFCAST_VOLUMES_MAX);
    r->objects = mem_array(&r->m, count, sizeof *r->objects);
    if (!r->objects)
        return ST_NOMEM;
    r->count = (int)count;
    status st = ST_OK;
    for (int i = 0; i < r->count && st == ST_OK; i++) {
        st = read_object(r, i, json_array_get(value, (size_t)i));
        if (st == ST_OK)
            share_file(r, i);
    }
    return st;
}

/* ---- The picture ---- */

static status read_picture(reading *r, json_t *top, bool inner) {
    char what[WHAT_MAX];
    const char *key;
    json_t *item;
    status st = ST_OK;
    place_in(r, what, inner ? "camera" : "the picture");
    json_object_foreach(top, key, item) {
        if (st != ST_OK || (!inner && strcmp(key, "objects") == 0))
            continue;
        if (!inner && strcmp(key, "camera") == 0 && json_is_object(item))
            st = read_picture(r, item, true);
        else if (inner && !cli_options_listed(CAMERA_KEYS, key))
            st = status_describe(ST_USAGE, "%s: there is no \"%s\" (keys: %s)", what, key,
                                 CAMERA_KEYS);
        else if (is_flag(key, false))
            st = script_flag(&r->picture, key, item, what);
        else if (is_flag(key, true))
            st = status_describe(ST_USAGE, "%s: \"%s\" is of one of the objects", what, key);
        else
            st = unknown(what, key, PICTURE_KEYS);
    }
    return st == ST_OK && !inner ? lead_medium(r, &r->picture.caps, what) : st;
}

/* ---- Flags ---- */

/* Let the command line replace what the file says of the picture. */
static status override(const render_options *o, view_options *view) {
    status st = ST_OK;
    view_options_inherit(view);
    for (size_t i = 0; i < o->flag_count && st == ST_OK; i++) {
        bool before = false;
        if (o->flags[i].of_one)
            return status_describe(ST_USAGE,
                                   "a scene file says what is shown of each object: no --iso, "
                                   "--tf, --field, --step, .. beside it, but behind --and");
        for (size_t k = 0; k < i; k++)
            before |= o->flags[k].key == o->flags[i].key;
        if (!before)
            view_options_clear(view, o->flags[i].key);
        st = view_options_set(view, o->flags[i].key, o->flags[i].text);
    }
    view->scene.allow_missing = o->view.scene.allow_missing;
    return st;
}

void scene_file_take_first(view_options *to, const view_options *of) {
    memcpy(to->surfaces, of->surfaces, sizeof to->surfaces);
    to->isos = of->isos;
    to->colours = of->colours;
    to->opacities = of->opacities;
    to->reflects = of->reflects;
    if (of->scene.bounces > to->scene.bounces)
        to->scene.bounces = of->scene.bounces;
    memcpy(to->field, of->field, sizeof to->field);
    memcpy(to->colour_by, of->colour_by, sizeof to->colour_by);
    to->colour_by_from = of->colour_by_from;
    to->colour_by_links = of->colour_by_links;
    to->step = of->step;
    to->time = of->time;
    to->medium = of->medium;
    to->given |= of->given;
}

/* Put the objects before those of --and. */
static status put_objects(reading *r, render_options *o) {
    const int more = r->count - 1, others = o->also_count;
    for (int i = 0; i < more; i++)
        if (!render_options_also(o))
            return ST_NOMEM;
    if (others > 0)
        memmove(o->also + more, o->also, (size_t)others * sizeof *o->also);
    for (int i = 0; i < more; i++) {
        o->also[i] = r->objects[i + 1];
        r->objects[i + 1] = (render_also){.same = -1};
    }
    o->common.input = o->first_path = r->objects[0].allocated;
    o->places = r->objects[0].places;
    o->view = r->picture;
    o->scene = true;
    r->objects[0] = (render_also){.same = -1};
    return ST_OK;
}

static void release(reading *r) {
    for (int i = 0; i < r->count; i++) {
        mem_free(&r->m, r->objects[i].allocated);
        mem_free(&r->m, r->objects[i].places.at);
    }
    mem_free(&r->m, r->objects);
}

static status load(reading *r, render_options *o, json_t *top) {
    char what[WHAT_MAX];
    if (!json_is_object(top) || !json_object_get(top, "objects"))
        return status_describe(
            ST_CORRUPT, "%s: neither a treelet file nor a scene: a scene has \"objects\"", r->path);
    if (o->state)
        return status_describe(ST_USAGE, "%s: not with --state",
                               place_in(r, what, "a scene file says the view"));
    status st = read_picture(r, top, false);
    if (st == ST_OK)
        st = read_objects(r, json_object_get(top, "objects"));
    if (st == ST_OK)
        st = override(o, &r->picture);
    if (st != ST_OK)
        return st;
    scene_file_take_first(&r->picture, &r->objects[0].view);
    return put_objects(r, o);
}

status scene_file_load(render_options *o) {
    static reading r;
    json_t *top = NULL;
    r = (reading){.path = o->common.input, .follow_links = o->follow_links};
    mem_init(&r.m, 0);
    view_options_init(&r.picture);
    r.picture.takes_media = true;
    status st = script_load(r.path, &top);
    if (st == ST_OK)
        st = load(&r, o, top);
    release(&r);
    json_decref(top);
    return st;
}

bool scene_file_is(const char *path) {
    mem m;
    file *f = NULL;
    char start[256] = "";
    mem_init(&m, 0);
    if (file_open(&m, path, &f) != ST_OK)
        return false;
    const size_t size = (size_t)(file_size(f) < 255 ? file_size(f) : 255);
    const status st = file_read_at(f, 0, start, size);
    file_close(f);
    return st == ST_OK && start[strspn(start, " \t\r\n")] == '{';
}
