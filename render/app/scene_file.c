#include "render/app/scene_file.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "formats/base/file.h"
#include "render/app/render_script.h"
#include "render/app/scene_objects.h"
#include "render/app/scene_tiles.h"

static const char PICTURE_KEYS[] = "objects camera",
                  CAMERA_KEYS[] = "eye look-at look_at up fov view ortho";

/* ---- The picture ---- */

static status read_picture(scene_reading *r, json_t *top, bool inner) {
    char what[SCENE_WHAT_MAX];
    const char *key;
    json_t *item;
    status st = ST_OK;
    scene_place_in(r, what, inner ? "camera" : "the picture");
    json_object_foreach(top, key, item) {
        if (st != ST_OK || (!inner && strcmp(key, "objects") == 0))
            continue;
        if (!inner && strcmp(key, "camera") == 0 && json_is_object(item))
            st = read_picture(r, item, true);
        else if (inner && !cli_options_listed(CAMERA_KEYS, key))
            st = status_describe(ST_USAGE, "%s: there is no \"%s\" (keys: %s)", what, key,
                                 CAMERA_KEYS);
        else if (scene_is_flag(key, false))
            st = script_flag(&r->picture, key, item, what);
        else if (scene_is_flag(key, true))
            st = status_describe(ST_USAGE, "%s: \"%s\" is of one of the objects", what, key);
        else
            st = scene_unknown(what, key, PICTURE_KEYS, true);
    }
    return st == ST_OK && !inner ? scene_lead_medium(r, &r->picture.caps, what) : st;
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
    to->refracts = of->refracts;
    view_options_bounce(to, of->reflect_bounces, of->refract_bounces);
    memcpy(to->field, of->field, sizeof to->field);
    memcpy(to->colour_by, of->colour_by, sizeof to->colour_by);
    to->colour_by_from = of->colour_by_from;
    to->colour_by_links = of->colour_by_links;
    to->step = of->step;
    to->time = of->time;
    to->medium = of->medium;
    to->given |= of->given;
}

/* Put the objects of the scene itself before those of --and, and those of its groups behind. */
static status put_objects(scene_reading *r, render_options *o) {
    const int others = o->also_count;
    int own = 0;
    while (own < r->count && r->objects[own].group == 0)
        own++;
    if (own == 0 && others > 0)
        return status_describe(ST_USAGE, "--and: beside no scene whose objects are all placed many "
                                         "times");
    for (int i = 1; i < r->count; i++)
        if (!render_options_also(o))
            return ST_NOMEM;
    if (others > 0)
        memmove(o->also + own - 1, o->also, (size_t)others * sizeof *o->also);
    for (int i = 1; i < r->count; i++) {
        render_also *to = &o->also[i - 1 + (i < own ? 0 : others)];
        *to = r->objects[i];
        if (to->same >= own)
            to->same += others;
        r->objects[i] = (render_also){.same = -1};
    }
    o->common.input = o->first_path = r->objects[0].allocated;
    o->places = r->objects[0].places;
    o->group = r->objects[0].group;
    o->view = r->picture;
    o->scene = true;
    r->objects[0] = (render_also){.same = -1};
    o->groups = r->groups;
    o->group_count = r->group_count;
    o->scene_tiles = r->tiles;
    o->scene_paths = r->paths;
    o->scene_path_count = r->path_count;
    r->groups = NULL;
    r->tiles = NULL;
    r->paths = NULL;
    r->group_count = 0;
    r->path_count = 0;
    return ST_OK;
}

static void release(scene_reading *r) {
    for (int i = 0; i < r->count; i++) {
        mem_free(&r->m, r->objects[i].allocated);
        mem_free(&r->m, r->objects[i].places.at);
    }
    for (int i = 0; i < r->group_count; i++)
        mem_free(&r->m, r->groups[i].places.at); /* there is no `which` yet */
    for (size_t i = 0; i < r->path_count; i++)
        mem_free(&r->m, r->paths[i]);
    scene_tiles_free(&r->m, r->tiles);
    mem_free(&r->m, r->groups);
    mem_free(&r->m, r->paths);
    mem_free(&r->m, r->objects);
}

static status load(scene_reading *r, render_options *o, json_t *top) {
    char what[SCENE_WHAT_MAX];
    if (!json_is_object(top) || !json_object_get(top, "objects"))
        return status_describe(
            ST_CORRUPT, "%s: neither a treelet file nor a scene: a scene has \"objects\"", r->path);
    if (o->state)
        return status_describe(ST_USAGE, "%s: not with --state",
                               scene_place_in(r, what, "a scene file says the view"));
    status st = read_picture(r, top, false);
    if (st == ST_OK)
        st = scene_objects_read(r, top);
    if (st == ST_OK)
        st = override(o, &r->picture);
    if (st != ST_OK)
        return st;
    scene_file_take_first(&r->picture, &r->objects[0].view);
    return put_objects(r, o);
}

status scene_file_load(render_options *o) {
    static scene_reading r;
    json_t *top = NULL;
    r = (scene_reading){.path = o->common.input, .follow_links = o->follow_links};
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
