#include "render/view/view_saved.h"

#include <stdlib.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "render/view/view_cast.h"
#include "render/view/view_state.h"

static void put_places(json_t *object, const render_places *p) {
    json_t *all = json_array();
    for (int i = 0; i < p->count; i++)
        json_array_append_new(all, cli_json_reals(p->at + 12 * (size_t)i, 12));
    if (p->count == 1)
        json_object_set(object, "transform", json_array_get(all, 0));
    else if (p->count > 1)
        json_object_set(object, "instances", all);
    json_decref(all);
}

static json_t *object_json(const view_scene *s, int object, const view_options *v) {
    json_t *out = json_object();
    json_object_set_new(out, "file", json_string(view_scene_told(s, view_scene_path(s, object))));
    json_object_update_new(out, view_scene_flags(s, v));
    put_places(out, view_scene_places(s, object));
    return out;
}

static json_t *scene_json(const view_scene *s, const view_cast *cast, const json_t *state) {
    json_t *out = json_copy((json_t *)state), *objects = json_array();
    json_object_del(out, "page");
    for (int k = 0; k <= cast->job.also_count; k++)
        json_array_append_new(
            objects, object_json(s, cast->objects[k],
                                 k == 0 ? &cast->frame.view : &cast->job.also[k - 1].view));
    json_object_set_new(out, "objects", objects);
    return out;
}

/* Leave out flags that change nothing, which render refuses. Returns whether there are any. */
static bool drop_idle(mem *m, const view_scene *s, json_t *state, const view_options *all,
                      const view_changes *c) {
    const char *key;
    json_t *value;
    void *next;
    bool any = false;
    json_object_foreach_safe(state, next, key, value) {
        if (view_scene_bit(key) == 0 || !view_cast_idle(m, s, all, c, key))
            continue;
        json_object_del(state, key);
        any = true;
    }
    return any;
}

static status print(mem *m, const json_t *object, view_message **out) {
    char *text = json_dumps(object, JSON_INDENT(1));
    view_message *made = text ? view_message_new(m, strlen(text) + 1) : NULL;
    status st = made ? view_message_put(&made, text, strlen(text)) : ST_NOMEM;
    if (st == ST_OK)
        st = view_message_put(&made, "\n", 1);
    free(text);
    if (st == ST_OK)
        *out = made;
    else
        view_message_free(made);
    return st;
}

/* Check the state as a picture of it is. */
static status save(mem *m, const view_scene *s, json_t *state, view_options *all,
                   view_message **out) {
    view_changes *changes = NULL;
    view_cast *cast = NULL;
    status st = view_changes_apply(m, state, s, all, &changes);
    if (st == ST_OK)
        st = view_cast_make(m, s, all, changes, &cast);
    /* Without one of them another one may change nothing: shadows without a light. */
    if (st == ST_OK && view_changes_any(changes) && drop_idle(m, s, state, all, changes)) {
        view_cast_free(m, cast);
        view_changes_drop(changes);
        return save(m, s, state, all, out);
    }
    json_t *object = st == ST_OK ? scene_json(s, cast, state) : NULL;
    if (st == ST_OK)
        st = print(m, object, out);
    json_decref(object);
    view_cast_free(m, cast);
    view_changes_drop(changes);
    return st;
}

status view_saved_scene(mem *m, const view_scene *s, const char *text, view_message **out) {
    json_t *state = NULL;
    view_options *all = mem_zalloc(m, sizeof *all);
    status st = all ? view_state_parse(text, strlen(text), &state) : ST_NOMEM;
    if (st == ST_OK)
        st = save(m, s, state, all, out);
    json_decref(state);
    mem_free(m, all);
    return st;
}
