#include "render/app/scene_objects.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "render/app/colour.h"
#include "render/app/render_script.h"
#include "render/app/scene_place.h"
#include "render/app/scene_tiles.h"
#include "render/ray/placement.h"

static const char OBJECT_KEYS[] = "file surfaces transform instances",
                  NESTED_KEYS[] = "scene transform instances",
                  SURFACE_KEYS[] = "isovalue colour color opacity reflectivity refraction bounces";

enum {
    INSTANCES_MAX = 1 << 24,
    NESTED_MOST = 16 /* scenes in scenes, one inside the other */
};

/* Objects that are to be read: those of a scene, or one that is an object at many places. */
typedef struct task {
    json_t *top; /* kept */
    json_t *objects;
    const char *path; /* of the scene's file */
    int number;       /* of the one object there; below 0: all */
    int group;        /* in which they lie, or 0 */
    bool placed;
    double place[12]; /* in that */
    int depth;        /* of scenes in scenes */
} task;

/* What is still to be read, in order: groups in the order in which they were made. */
typedef struct queue {
    task *of;
    size_t first, count, room;
} queue;

/* ---- Surfaces, and places ---- */

/* The numbers of a surface. Their ranges are tested before they are rounded to a float. */
typedef struct surface_number {
    const char *key;
    double lo, hi;
    size_t at;
} surface_number;

static const surface_number NUMBERS[] = {
    {"opacity", 1e-37, 1.0, offsetof(leafcast_surface, opacity)}, /* above 0 as a float, too */
    {"reflectivity", 0.0, 1.0, offsetof(leafcast_surface, reflectivity)},
    {"refraction", 1.0 / LEAFCAST_REFRACTION_MOST, LEAFCAST_REFRACTION_MOST,
     offsetof(leafcast_surface, refraction)}};

static const surface_number *find_number(const char *key) {
    for (size_t i = 0; i < sizeof NUMBERS / sizeof *NUMBERS; i++)
        if (strcmp(key, NUMBERS[i].key) == 0)
            return &NUMBERS[i];
    return NULL;
}

static status read_number(const json_t *item, const surface_number *n, const char *what,
                          leafcast_surface *s) {
    const double number = json_number_value(item);
    if (!json_is_number(item) || !(number >= n->lo && number <= n->hi))
        return status_describe(ST_USAGE, "%s: \"%s\" takes a number, %g to %g", what, n->key, n->lo,
                               n->hi);
    const float rounded = (float)number;
    memcpy((char *)s + n->at, &rounded, sizeof rounded);
    return ST_OK;
}

static status read_bounces(const json_t *item, const char *what, int *bounces) {
    const json_int_t number = json_integer_value(item);
    if (!json_is_integer(item) || number < 1 || number > LEAFCAST_BOUNCES_MAX)
        return status_describe(ST_USAGE, "%s: \"bounces\" takes a whole number, 1 to %d", what,
                               LEAFCAST_BOUNCES_MAX);
    *bounces = (int)number;
    return ST_OK;
}

/* Read {"isovalue": 0.5, "colour": "red", "opacity": 0.4}. *bounces: 0 where none are given. */
static status read_surface(json_t *value, const char *what, leafcast_surface *s, int *bounces) {
    const char *key;
    json_t *item;
    status st = ST_OK;
    if (!json_is_object(value) || !json_is_number(json_object_get(value, "isovalue")))
        return status_describe(ST_USAGE, "%s: a surface is an object with an \"isovalue\"", what);
    *s = leafcast_surface_default(json_number_value(json_object_get(value, "isovalue")));
    json_object_foreach(value, key, item) {
        char text[SCRIPT_TEXT_MAX];
        const surface_number *number = find_number(key);
        if (st != ST_OK || strcmp(key, "isovalue") == 0)
            continue;
        if (number) {
            st = read_number(item, number, what, s);
        } else if (strcmp(key, "bounces") == 0) {
            st = read_bounces(item, what, bounces);
        } else if (strcmp(key, "colour") == 0 || strcmp(key, "color") == 0) {
            st = script_text(item, what, key, text);
            if (st == ST_OK)
                st = colour_parse(text, what, s->rgb, NULL);
        } else {
            st = scene_unknown(what, key, SURFACE_KEYS, false);
        }
    }
    if (st == ST_OK && *bounces > 0 && s->reflectivity == 0.0f && s->refraction == 0.0f)
        st = status_describe(ST_USAGE, "%s: \"bounces\" is of \"reflectivity\" and \"refraction\"",
                             what);
    return st;
}

/* Refuse flags about isovalues beside "surfaces", which would replace what they say. */
static status check_beside(const scene_reading *r, int object, const view_options *v) {
    const struct {
        int count;
        const char *flag, *key;
    } flags[] = {{v->isos, "iso", "isovalue"},
                 {v->colours, "colour", "colour"},
                 {v->opacities, "opacity", "opacity"},
                 {v->reflects, "reflect", "reflectivity"},
                 {v->refracts, "refract", "refraction"}};
    char what[SCENE_WHAT_MAX];
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        if (flags[i].count > 0)
            return status_describe(
                ST_USAGE, "%s: \"%s\" beside \"surfaces\": it is \"%s\" of each of these",
                scene_place_in(r, what, "objects[%d]", object), flags[i].flag, flags[i].key);
    return ST_OK;
}

static status read_surfaces(const scene_reading *r, int object, const json_t *value,
                            view_options *v) {
    char what[SCENE_WHAT_MAX];
    const size_t count = json_array_size(value);
    if (!json_is_array(value) || count == 0 || count > LEAFCAST_SURFACES_MAX)
        return status_describe(ST_USAGE, "%s: an array of 1 to %d surfaces",
                               scene_place_in(r, what, "objects[%d].surfaces", object),
                               LEAFCAST_SURFACES_MAX);
    status st = check_beside(r, object, v);
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        const leafcast_surface *s = &v->surfaces[i];
        int bounces = 0;
        st = read_surface(json_array_get(value, i),
                          scene_place_in(r, what, "objects[%d].surfaces[%zu]", object, i),
                          &v->surfaces[i], &bounces);
        if (s->refraction > 0.0f)
            v->refracts = (int)i + 1;
        view_options_bounce(v, s->reflectivity > 0.0f ? (bounces > 1 ? bounces : 1) : 0,
                            s->refraction > 0.0f ? bounces : 0);
    }
    v->isos = v->colours = v->opacities = v->reflects = (int)count;
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
        placement_follow(place, own);
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
static status read_places(scene_reading *r, int object, const json_t *value,
                          render_places *places) {
    const json_t *transform = json_object_get(value, "transform"),
                 *instances = json_object_get(value, "instances");
    const size_t count = instances ? json_array_size(instances) : 1;
    char what[SCENE_WHAT_MAX];
    double first[12];
    status st = ST_OK;
    if (!transform && !instances)
        return ST_OK;
    if (count == 0 || count > INSTANCES_MAX)
        return status_describe(ST_USAGE, "%s: an array of 1 to %d transforms",
                               scene_place_in(r, what, "objects[%d].instances", object),
                               INSTANCES_MAX);
    places->at = mem_array(&r->m, count, 12 * sizeof *places->at);
    if (!places->at)
        return ST_NOMEM;
    places->count = (int)count;
    if (transform)
        st = read_place(transform, scene_place_in(r, what, "objects[%d].transform", object), NULL,
                        first);
    if (!instances)
        memcpy(places->at, first, sizeof first);
    for (size_t i = 0; i < count && instances && st == ST_OK; i++)
        st = read_place(json_array_get(instances, i),
                        scene_place_in(r, what, "objects[%d].instances[%zu]", object, i),
                        transform ? first : NULL, places->at + 12 * i);
    return st;
}

/* ---- Groups ---- */

/* Let places be followed by that of the scene in which they are. */
static status follow_all(scene_reading *r, const task *t, int object, render_places *places) {
    char what[SCENE_WHAT_MAX], why[STATUS_TEXT_MAX];
    if (!t->placed)
        return ST_OK;
    if (places->count == 0) {
        places->at = mem_array(&r->m, 1, 12 * sizeof *places->at);
        if (!places->at)
            return ST_NOMEM;
        memcpy(places->at, t->place, sizeof t->place);
        places->count = 1;
        return ST_OK;
    }
    for (int i = 0; i < places->count; i++) {
        double *place = places->at + 12 * (size_t)i;
        placement_follow(place, t->place);
        if (placement_check(place) == ST_OK)
            continue;
        snprintf(why, sizeof why, "%s", status_text());
        return status_describe(ST_USAGE, "%s, inside another scene: %s",
                               scene_place_in(r, what, "objects[%d]", object), why);
    }
    return ST_OK;
}

/* Add a group, which takes the places, and put what lies in it into the queue; NULL: nothing. A
 * scene that lies in itself several times would have more groups at each depth than before. */
static status add_group(scene_reading *r, queue *q, const render_group *group, const task *in_it) {
    status st = ST_OK;
    if (r->group_count == LEAFCAST_VOLUMES_MAX)
        st = status_describe(ST_USAGE, "%s: more than %d groups: does a scene lie in itself?",
                             r->path, LEAFCAST_VOLUMES_MAX);
    if (st == ST_OK)
        st = mem_grow(&r->m, &r->groups, sizeof *r->groups, (size_t)r->group_count, 4,
                      &r->group_room);
    if (st == ST_OK)
        st = mem_grow(&r->m, &q->of, sizeof *q->of, q->count, 4, &q->room);
    if (st != ST_OK) {
        mem_free(&r->m, group->places.at);
        return st;
    }
    r->groups[r->group_count++] = *group;
    if (!in_it)
        return ST_OK;
    q->of[q->count] = *in_it;
    q->of[q->count].group = r->group_count;
    json_incref(q->of[q->count++].top);
    return ST_OK;
}

/* ---- Objects ---- */

static status read_all(scene_reading *r, queue *q, const task *t);

/* Make room for one more object of a group. */
static status add_object(scene_reading *r, int group, render_also **out) {
    char what[SCENE_WHAT_MAX];
    if (r->count == LEAFCAST_VOLUMES_MAX)
        return status_describe(ST_USAGE, "%s: more than %d, with those of the scenes in it",
                               scene_place_in(r, what, "objects"), LEAFCAST_VOLUMES_MAX);
    const status st =
        mem_grow(&r->m, &r->objects, sizeof *r->objects, (size_t)r->count, 4, &r->room);
    if (st != ST_OK)
        return st;
    *out = &r->objects[r->count++];
    **out = (render_also){.same = -1, .group = group};
    view_options_init(&(*out)->view);
    return ST_OK;
}

/* Read what is shown of a file. */
static status read_shown(scene_reading *r, int i, json_t *value, render_also *to) {
    char what[SCENE_WHAT_MAX];
    const char *key, *name = json_string_value(json_object_get(value, "file"));
    json_t *item;
    status st = ST_OK;
    scene_place_in(r, what, "objects[%d]", i);
    if (!name || !*name)
        return status_describe(ST_USAGE, "%s: \"file\" takes a name", what);
    to->view.takes_media = true;
    to->view.colour_by_from = r->path;
    to->view.colour_by_links = r->follow_links;
    json_object_foreach(value, key, item) {
        if (st != ST_OK || cli_options_listed(OBJECT_KEYS, key))
            continue;
        st = scene_is_flag(key, true) ? script_flag(&to->view, key, item, what)
                                      : scene_unknown(what, key, OBJECT_KEYS, true);
    }
    if (st == ST_OK)
        st = scene_find_file(r, name, what, &to->allocated);
    to->path = to->allocated;
    if (st == ST_OK)
        st = scene_lead_medium(r, &to->view.medium, what);
    if (st == ST_OK && json_object_get(value, "surfaces"))
        st = read_surfaces(r, i, json_object_get(value, "surfaces"), &to->view);
    return st;
}

/* Read an object with a file. At many places it is many objects of the scene itself, which may have
 * all that objects have; in a group, or at more places than a scene has objects, a group. */
static status read_file(scene_reading *r, queue *q, const task *t, int i, json_t *value) {
    render_places places = {NULL, 0};
    render_also *to = NULL;
    status st = t->number < 0 ? read_places(r, i, value, &places) : ST_OK;
    if (st == ST_OK)
        st = follow_all(r, t, i, &places);
    if (st == ST_OK && places.count > (t->group ? 1 : LEAFCAST_VOLUMES_MAX)) {
        task alone = *t;
        alone.number = i;
        alone.placed = false;
        return add_group(r, q, &(render_group){.parent = t->group, .places = places}, &alone);
    }
    if (st == ST_OK)
        st = add_object(r, t->group, &to);
    if (st != ST_OK) {
        mem_free(&r->m, places.at);
        return st;
    }
    to->places = places;
    return read_shown(r, i, value, to);
}

/* Load the scene that an object names: a task to read it; its top is the caller's to let go. */
static status load_scene(scene_reading *r, const task *t, int i, const char *name, task *in_it) {
    char what[SCENE_WHAT_MAX];
    scene_place_in(r, what, "objects[%d]", i);
    if (!name || !*name)
        return status_describe(ST_USAGE, "%s: \"scene\" takes a name", what);
    if (t->depth >= NESTED_MOST)
        return status_describe(ST_USAGE, "%s: scenes in scenes, %d deep: does one lie in itself?",
                               what, NESTED_MOST);
    status st = mem_grow(&r->m, &r->paths, sizeof *r->paths, r->path_count, 4, &r->path_room);
    if (st == ST_OK)
        st = scene_find_file(r, name, what, &r->paths[r->path_count]);
    if (st != ST_OK)
        return st;
    *in_it = (task){.path = r->paths[r->path_count++], .number = -1, .depth = t->depth + 1};
    st = script_load(in_it->path, &in_it->top);
    if (st != ST_OK)
        return st;
    in_it->objects = json_object_get(in_it->top, "objects");
    if (in_it->objects)
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: no scene: a scene has \"objects\"", in_it->path);
}

/* Read a scene in the scene: at one place as if its objects stood here, at many as a group. What it
 * says of the picture is its own affair. */
static status read_nested(scene_reading *r, queue *q, const task *t, int i, json_t *value) {
    char what[SCENE_WHAT_MAX];
    const char *key, *name = json_string_value(json_object_get(value, "scene"));
    render_places places = {NULL, 0};
    json_t *item;
    task in_it = {.top = NULL};
    scene_place_in(r, what, "objects[%d]", i);
    json_object_foreach(value, key, item) {
        if (!cli_options_listed(NESTED_KEYS, key))
            return scene_unknown(what, key, NESTED_KEYS, false);
    }
    status st = read_places(r, i, value, &places);
    if (st == ST_OK)
        st = follow_all(r, t, i, &places);
    if (st == ST_OK)
        st = load_scene(r, t, i, name, &in_it);
    if (st == ST_OK && places.count > 1) {
        st = add_group(r, q, &(render_group){.parent = t->group, .places = places}, &in_it);
        places.at = NULL;
    } else if (st == ST_OK) {
        in_it.group = t->group;
        in_it.placed = places.count > 0;
        if (in_it.placed)
            memcpy(in_it.place, places.at, sizeof in_it.place);
        st = read_all(r, q, &in_it);
    }
    mem_free(&r->m, places.at);
    json_decref(in_it.top);
    return st;
}

/* Read tiles: a group, whose places come once the ground is open, and in it one of each. */
static status read_tiles(scene_reading *r, queue *q, const task *t, int i, json_t *value) {
    char what[SCENE_WHAT_MAX];
    scene_tiles *tiles = NULL;
    scene_place_in(r, what, "objects[%d]", i);
    if (t->group || t->placed)
        return status_describe(ST_USAGE, "%s: \"tiles\" are of a scene that lies in no other",
                               what);
    status st = scene_tiles_read(r, value, what, &tiles);
    if (st == ST_OK)
        st = add_group(r, q, &(render_group){.tiles = tiles}, NULL);
    const int all = r->group_count;
    for (int k = 0; st == ST_OK && k < scene_tiles_count(tiles); k++) {
        task in_it = {.top = NULL};
        st = load_scene(r, t, i, scene_tiles_scene(tiles, k), &in_it);
        if (st == ST_OK)
            st = add_group(r, q, &(render_group){.parent = all, .chosen = true}, &in_it);
        json_decref(in_it.top);
    }
    return st;
}

static status read_object(scene_reading *r, queue *q, const task *t, int i, json_t *value) {
    static const struct {
        const char *key;
        status (*read)(scene_reading *r, queue *q, const task *t, int i, json_t *value);
    } ways[] = {{"file", read_file}, {"scene", read_nested}, {"tiles", read_tiles}};
    char what[SCENE_WHAT_MAX];
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++)
        if (json_object_get(value, ways[k].key))
            return ways[k].read(r, q, t, i, value);
    return status_describe(ST_USAGE, "%s: an object has a \"file\", a \"scene\", or \"tiles\"",
                           scene_place_in(r, what, "objects[%d]", i));
}

/* Read all objects of a scene; or one of them, which was found to be at many places. */
static status read_all(scene_reading *r, queue *q, const task *t) {
    char what[SCENE_WHAT_MAX];
    const char *before = r->path;
    const size_t count = json_array_size(t->objects);
    status st = ST_OK;
    r->path = t->path;
    if (count == 0 || count > LEAFCAST_VOLUMES_MAX)
        st = status_describe(ST_USAGE, "%s: an array of 1 to %d",
                             scene_place_in(r, what, "objects"), LEAFCAST_VOLUMES_MAX);
    for (int i = 0; i < (int)count && st == ST_OK; i++)
        if (t->number < 0 || t->number == i)
            st = read_object(r, q, t, i, json_array_get(t->objects, (size_t)i));
    r->path = before;
    return st;
}

/* ---- Files ---- */

static bool same_moment(const view_options *a, const view_options *b) {
    return strcmp(a->field, b->field) == 0 && a->step == b->step &&
           a->time.given == b->time.given && a->time.interpolate == b->time.interpolate &&
           (!a->time.given || a->time.time == b->time.time);
}

/* Open a file once for all objects that show the same of it. */
static void share_file(scene_reading *r, int i) {
    for (int k = 0; k < i; k++)
        if (r->objects[k].same < 0 && strcmp(r->objects[k].path, r->objects[i].path) == 0 &&
            same_moment(&r->objects[k].view, &r->objects[i].view)) {
            r->objects[i].same = k;
            return;
        }
}

status scene_objects_read(scene_reading *r, json_t *top) {
    queue q = {.of = NULL};
    const task own = {
        .top = top, .objects = json_object_get(top, "objects"), .path = r->path, .number = -1};
    status st = read_all(r, &q, &own);
    for (; q.first < q.count; q.first++) {
        const task next = q.of[q.first]; /* the queue grows meanwhile */
        if (st == ST_OK)
            st = read_all(r, &q, &next);
        json_decref(next.top);
    }
    mem_free(&r->m, q.of);
    for (int i = 0; i < r->count && st == ST_OK; i++)
        share_file(r, i);
    return st;
}
