#include "render/view/view_slice_state.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "render/app/render_script.h"
#include "render/view/view_state.h"

static status set_flag(slice_request *r, const char *name, const json_t *value) {
    static const char *const never[] = {"line", "sweep", "size"};
    char text[SCRIPT_TEXT_MAX];
    view_value takes = VIEW_VALUE_NEEDED;
    const int key = slice_request_key(name, &takes);
    for (size_t i = 0; i < sizeof never / sizeof *never; i++)
        if (strcmp(name, never[i]) == 0)
            return status_describe(ST_USAGE, "slice: a page may not say \"%s\"", name);
    if (!key)
        return status_describe(ST_USAGE, "slice: there is no \"%s\"", name);
    if (takes == VIEW_VALUE_NONE) {
        if (!json_is_boolean(value))
            return status_describe(ST_USAGE, "slice: \"%s\" takes true or false", name);
        return json_is_true(value) ? slice_request_set(r, key, NULL) : ST_OK;
    }
    const status st = script_text(value, "slice", name, text);
    return st == ST_OK ? slice_request_set(r, key, text) : st;
}

status view_slice_state_apply(mem *m, const json_t *object, slice_request *r) {
    const char *key;
    json_t *value;
    status st = ST_OK;
    slice_request_init(r, m);
    if (!json_is_object(object))
        return status_describe(ST_USAGE, "slice: not a JSON object");
    json_object_foreach((json_t *)object, key, value) {
        if (st == ST_OK)
            st = set_flag(r, key, value);
    }
    if (st == ST_OK)
        st = view_state_check_names(&r->medium);
    return st == ST_OK ? slice_request_check(r) : st;
}

void view_slice_state_fit(leafcast_slice_pixels *s, const uint32_t box[2]) {
    const double width = vec3_length(s->u), height = vec3_length(s->v);
    const double pixels = fmin(box[0] / width, box[1] / height); /* per world unit */
    s->width = (uint32_t)fmax(1.0, fmin(box[0], rint(width * pixels)));
    s->height = (uint32_t)fmax(1.0, fmin(box[1], rint(height * pixels)));
}
