#include "render/view/view_changes.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "render/app/colour_map.h"
#include "render/app/transfer_preset.h"
#include "render/view/view_state.h"

struct view_changes {
    mem *m;
    atomic_int holders;
    int count;
    view_change of[];
};

view_changes *view_changes_hold(view_changes *c) {
    if (c)
        atomic_fetch_add(&c->holders, 1);
    return c;
}

void view_changes_drop(view_changes *c) {
    if (c && atomic_fetch_sub(&c->holders, 1) == 1)
        mem_free(c->m, c);
}

static const view_change *find(const view_changes *c, int object) {
    for (int i = 0; c && i < c->count; i++)
        if (c->of[i].object == object)
            return &c->of[i];
    return NULL;
}

const view_options *view_changes_view(const view_changes *c, const view_scene *s, int object) {
    const view_change *found = find(c, object);
    return found && found->flags ? &found->view : &s->views[object];
}

bool view_changes_hides(const view_changes *c, int object) {
    const view_change *found = find(c, object);
    return found && found->hidden;
}

bool view_changes_any(const view_changes *c) {
    return c && c->count > 0;
}

/* ---- Files ---- */

/* Take a name out of *flags where it is that of a file in the scene file: returns whether it is.
 * own: as that was found; "": none. */
static bool take_name(json_t *flags, const char *key, const view_scene *s, const char *own) {
    const char *told = own[0] ? view_scene_told(s, own) : "", *name;
    json_t *value;
    json_object_foreach(flags, name, value) {
        const char *text = json_string_value(value);
        if (!cli_options_same(name, key) || !text || !own[0] || strcmp(text, told) != 0)
            continue;
        json_object_del(flags, name);
        return true;
    }
    return false;
}

/* ---- An object ---- */

/* Check that flags are of one volume, or of the picture. */
static status check_keys(const json_t *flags, bool of_one, const char *what) {
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)flags, key, value) {
        bool repeats;
        view_value takes;
        const int flag =
            view_options_key(strcmp(key, "isovalues") == 0 ? "iso" : key, &repeats, &takes);
        if (flag && view_options_of_one(flag) != of_one)
            return status_describe(ST_USAGE, "%s: \"%s\" is of %s", what, key,
                                   of_one ? "the picture" : "one of the objects");
        if (!flag && of_one && strcmp(key, "page") != 0)
            return status_describe(ST_USAGE, "%s: there is no \"%s\"", what, key);
    }
    return ST_OK;
}

static status apply_flags(mem *m, const json_t *given, const view_scene *s, view_change *to) {
    const view_options *own = &s->views[to->object];
    char what[64];
    snprintf(what, sizeof what, "objects: %d", to->object);
    if (!json_is_object(given))
        return status_describe(ST_USAGE, "%s: \"flags\" takes an object", what);
    status st = check_keys(given, true, what);
    json_t *flags = st == ST_OK ? json_copy((json_t *)given) : NULL;
    if (st != ST_OK || !flags)
        return st == ST_OK ? ST_NOMEM : st;
    const bool tf = take_name(flags, "tf", s, own->medium.tf),
               map = take_name(flags, "colour-map", s, own->medium.colour_map),
               by = take_name(flags, "colour-by", s, own->colour_by);
    st = view_state_apply(m, flags, &to->view);
    json_decref(flags);
    if (st == ST_OK && to->view.colour_by[0])
        st = status_describe(ST_USAGE, "%s: a page may colour by what the scene file names", what);
    if (st != ST_OK)
        return st;
    if (tf)
        memcpy(to->view.medium.tf, own->medium.tf, sizeof own->medium.tf);
    if (map)
        memcpy(to->view.medium.colour_map, own->medium.colour_map, sizeof own->medium.colour_map);
    if (by)
        memcpy(to->view.colour_by, own->colour_by, sizeof own->colour_by);
    to->view.colour_by_from = own->colour_by_from;
    to->view.colour_by_links = own->colour_by_links;
    to->flags = true;
    return ST_OK;
}

static status read_change(mem *m, const json_t *entry, const view_scene *s, view_changes *c) {
    const json_t *index = json_object_get(entry, "index"), *hidden;
    view_change *to = &c->of[c->count];
    const char *key;
    json_t *value;
    *to = (view_change){.object = -1};
    if (!json_is_integer(index) || json_integer_value(index) < 0 ||
        json_integer_value(index) >= s->count)
        return status_describe(ST_USAGE, "objects: an \"index\" is 0 to %d", s->count - 1);
    to->object = (int)json_integer_value(index);
    if (find(c, to->object))
        return status_describe(ST_USAGE, "objects: %d is there twice", to->object);
    json_object_foreach((json_t *)entry, key, value) {
        if (!cli_options_listed("index hidden flags page", key))
            return status_describe(ST_USAGE, "objects: %d: there is no \"%s\"", to->object, key);
    }
    hidden = json_object_get(entry, "hidden");
    if (hidden && !json_is_boolean(hidden))
        return status_describe(ST_USAGE, "objects: %d: \"hidden\" takes true or false", to->object);
    to->hidden = json_is_true(hidden);
    const json_t *flags = json_object_get(entry, "flags"), *page = json_object_get(entry, "page");
    if (page && !json_is_object(page))
        return status_describe(ST_USAGE, "objects: %d: \"page\" takes an object", to->object);
    const status st = flags ? apply_flags(m, flags, s, to) : ST_OK;
    c->count += st == ST_OK;
    return st;
}

static status check_shown(const view_changes *c, const view_scene *s) {
    int hidden = 0;
    for (int i = 0; i < c->count; i++)
        hidden += c->of[i].hidden;
    return hidden < s->count ? ST_OK : status_describe(ST_USAGE, "objects: all of them are hidden");
}

static status read_changes(mem *m, const json_t *list, const view_scene *s, view_changes **out) {
    const size_t count = json_array_size(list);
    if (list && (!json_is_array(list) || count > (size_t)s->count))
        return status_describe(ST_USAGE, "objects: an array of at most %d", s->count);
    view_changes *c = mem_zalloc(m, sizeof *c + count * sizeof c->of[0]);
    if (!c)
        return ST_NOMEM;
    c->m = m;
    atomic_init(&c->holders, 1);
    status st = ST_OK;
    for (size_t i = 0; i < count && st == ST_OK; i++)
        st = read_change(m, json_array_get(list, i), s, c);
    if (st == ST_OK)
        st = check_shown(c, s);
    if (st == ST_OK)
        *out = c;
    else
        view_changes_drop(c);
    return st;
}

/* ---- The picture ---- */

static status apply_picture(mem *m, json_t *flags, const view_scene *s, view_options *all) {
    const medium_options *own = &s->picture_view.caps;
    status st = check_keys(flags, false, "state");
    if (st == ST_OK && json_object_get(flags, "camera"))
        st = status_describe(ST_USAGE, "state: of a scene, without a \"camera\": its flags alone");
    if (st != ST_OK)
        return st;
    const bool caps = take_name(flags, "caps", s, own->colour_map);
    if (caps && json_object_set_new(flags, "caps", json_true()) != 0)
        return ST_NOMEM;
    st = view_state_apply(m, flags, all);
    if (st == ST_OK && caps)
        all->caps = *own;
    return st;
}

status view_changes_apply(mem *m, json_t *state, const view_scene *s, view_options *all,
                          view_changes **out) {
    json_t *flags = json_copy(state);
    if (!flags)
        return ST_NOMEM;
    json_object_del(flags, "objects");
    status st = apply_picture(m, flags, s, all);
    json_decref(flags);
    return st == ST_OK ? read_changes(m, json_object_get(state, "objects"), s, out) : st;
}
