#include "render/view/view_state.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/cli_json.h"
#include "formats/base/cli_options.h"
#include "formats/base/json_text.h"
#include "formats/base/vec3.h"
#include "render/app/colour_map.h"
#include "render/app/render_script.h"
#include "render/app/transfer_preset.h"

status view_state_parse(const char *text, size_t size, json_t **object) {
    json_error_t error;
    *object = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    if (!*object)
        return status_describe(json_text_status(&error, ST_USAGE), "no JSON: column %d: %s",
                               error.column, error.text);
    if (json_is_object(*object))
        return ST_OK;
    json_decref(*object);
    *object = NULL;
    return status_describe(ST_USAGE, "not a JSON object");
}

/* Returns whether this name is one of `names`, which are separated by '|'. */
static bool is_one_of(const char *names, const char *name) {
    const size_t length = strcspn(name, "|");
    if (name[length])
        return false;
    for (const char *at = names; at; at = strchr(at, '|')) {
        at += *at == '|';
        if (strncmp(at, name, length) == 0 && (at[length] == '|' || at[length] == 0))
            return length > 0;
    }
    return false;
}

static status check_map(const char *name, const char *what) {
    if (!name[0] || is_one_of(colour_map_names(), name))
        return ST_OK;
    return status_describe(ST_USAGE, "%s: a page may name one of %s, and no file", what,
                           colour_map_names());
}

status view_state_check_names(const medium_options *medium) {
    if (medium->tf[0] && !transfer_preset_is(medium->tf))
        return status_describe(ST_USAGE, "--tf: a page may name one of %s, and no file",
                               transfer_preset_names());
    return check_map(medium->colour_map, "--colour-map");
}

status view_state_apply(mem *m, json_t *state, view_options *v) {
    script_frame *frame = mem_zalloc(m, sizeof *frame);
    if (!frame)
        return ST_NOMEM;
    view_options_init(&frame->view);
    frame->view.takes_media = true;
    status st = script_apply(frame, state, "state");
    for (int i = 0; i < FRAME_FILES && st == ST_OK; i++)
        if (frame->file[i][0])
            st = status_describe(ST_USAGE, "state: a page may name no file to write");
    if (st == ST_OK)
        st = view_state_check_names(&frame->view.medium);
    if (st == ST_OK)
        st = check_map(frame->view.caps.colour_map, "--caps");
    if (st == ST_OK)
        *v = frame->view;
    mem_free(m, frame);
    return st;
}

static json_t *vector(const double x[3]) {
    return json_pack("[f,f,f]", x[0], x[1], x[2]);
}

static double first_isovalue(const leafcast *volume) {
    double isovalue = 0.0, range[2] = {0.0, 1.0};
    int count = 0;
    if (leafcast_suggested_isovalues(volume, 0, 0, &isovalue, 1, &count) == LEAFCAST_OK &&
        count > 0)
        return isovalue;
    /* Nothing can be suggested: no two values differ. */
    return leafcast_range(volume, 0, 0, range) == LEAFCAST_OK && range[0] <= range[1] ? range[1]
                                                                                      : 0.0;
}

/* Returns the camera that fits the surface of an isovalue into a picture. */
static leafcast_camera first_camera(const leafcast *volume, double isovalue, uint32_t width,
                                    uint32_t height) {
    leafcast_camera c = {.size = sizeof c};
    if (leafcast_fit_view(volume, 0, 0, &isovalue, 1, 0.0, width, height, &c) != LEAFCAST_OK)
        c = leafcast_standard_view(volume, 2.2, width, height);
    return c;
}

json_t *view_state_fits(const leafcast *volume) {
    enum { HEIGHT = 720 };
    static const double widths[] = {0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0}; /* of the height */
    const double isovalue = first_isovalue(volume);
    json_t *out = json_array();
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        const leafcast_camera c =
            first_camera(volume, isovalue, (uint32_t)(widths[i] * HEIGHT), HEIGHT);
        double away[3];
        vec3_sub(c.eye, c.look_at, away);
        json_array_append_new(out, json_pack("[f,f]", widths[i], vec3_length(away)));
    }
    return out;
}

json_t *view_state_first(const leafcast *volume) {
    const double isovalue = first_isovalue(volume);
    const leafcast_camera c = first_camera(volume, isovalue, 1280, 720);
    json_t *state = json_object();
    if (!(leafcast_describe(volume).abilities & LEAFCAST_ABILITY_GIVEN))
        json_object_set_new(state, "iso", json_pack("[f]", isovalue));
    json_object_set_new(state, "eye", vector(c.eye));
    json_object_set_new(state, "look-at", vector(c.look_at));
    json_object_set_new(state, "up", vector(c.up));
    json_object_set_new(state, "fov", json_real(c.fov));
    return state;
}
