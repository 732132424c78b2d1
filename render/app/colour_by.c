#include "render/app/colour_by.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/colour_field.h"
#include "formats/base/num.h"
#include "formats/input/named_file.h"
#include "render/ray/kind.h"
#include "render/ray/open_volume.h"

void colour_by_close(colour_by *b) {
    leafcast_close(b->volume);
    *b = (colour_by){.opened = b->opened};
}

leafcast_axes colour_by_world(const leafcast *volume) {
    const leafcast_axes asked = (leafcast_axes)volume->options.axes;
    return asked != LEAFCAST_AXES_FILE ? asked : leafcast_describe(volume).axes;
}

bool colour_by_image(const leafcast_colouring *by) {
    return by->volume->kind->draped &&
           strcmp(leafcast_field_name(by->volume, by->field), COLOUR_FIELD) == 0;
}

/* ---- Opening ---- */

static status open_on(colour_by *b, const char *path) {
    const leafcast_options on = {.size = sizeof on,
                                 .device = b->of->device,
                                 .backend = b->of->options.backend,
                                 .axes = b->world};
    return (status)leafcast_open(path, &on, &b->volume);
}

/* Open the file of a name, if there is one: *there. A scene file's names lead where it lies. */
static status open_named(colour_by *b, const view_options *v, const char *name, bool *there) {
    mem m;
    char *path = NULL;
    mem_init(&m, 0);
    status st = named_file_find(&m, v->colour_by_from ? v->colour_by_from : "-", name,
                                v->colour_by_from ? v->colour_by_links : true, &path);
    *there = st == ST_OK && access(path, F_OK) == 0;
    if (*there)
        st = open_on(b, path);
    mem_free(&m, path);
    return st;
}

/* Open FILE or FILE:FIELD. */
static status open_other(colour_by *b, const view_options *v) {
    char name[MEDIUM_NAME_MAX], why[STATUS_TEXT_MAX / 2];
    bool there = false;
    status st = open_named(b, v, v->colour_by, &there);
    if (there || st != ST_OK)
        return st;
    snprintf(name, sizeof name, "%s", v->colour_by);
    char *field = strrchr(name, ':');
    if (field) {
        *field++ = 0;
        st = open_named(b, v, name, &there);
    }
    if (st != ST_OK || !there)
        return st;
    st = (status)leafcast_find_field(b->volume, field, &b->field);
    if (st == ST_OK)
        return ST_OK;
    snprintf(why, sizeof why, "%s", status_text());
    return status_describe(st, "--colour-by %s: %s", v->colour_by, why);
}

static status open_any(colour_by *b, const view_options *v) {
    char why[STATUS_TEXT_MAX];
    uint32_t field;
    b->same = leafcast_find_field(b->of, v->colour_by, &field) == LEAFCAST_OK;
    snprintf(why, sizeof why, "%s", b->same ? "" : status_text());
    if (!b->same) {
        const status st = open_other(b, v);
        return st != ST_OK || b->volume
                   ? st
                   : status_describe(ST_USAGE,
                                     "--colour-by: \"%s\" is neither a file nor a field: %s",
                                     v->colour_by, why);
    }
    b->field = field;
    if (b->of->kind->given && !b->of->kind->draped) /* its values lie on it */
        return ST_OK;
    return open_on(b, file_path(b->of->file->source));
}

/* ---- Its step ---- */

/* Check that a step of both has the same time. */
static status check_time(const colour_by *b, uint32_t step) {
    char one[NUM_TEXT_MAX], other[NUM_TEXT_MAX];
    const leafcast_info info = leafcast_describe(b->volume);
    if (step >= info.steps)
        return status_describe(ST_USAGE,
                               "--colour-by %s: there are steps 0 to %u, and step %u is shown",
                               b->name, info.steps - 1, step);
    const double shown = leafcast_step_time(b->of, step),
                 time = leafcast_step_time(b->volume, step);
    if (time == shown)
        return ST_OK;
    return status_describe(ST_USAGE,
                           "--colour-by %s: its step %u is at time %s, what is shown there at %s",
                           b->name, step, num_print(time, one), num_print(shown, other));
}

status colour_by_find(colour_by *b, const view_options *v, leafcast_axes world,
                      leafcast_shown *shown, leafcast_colouring *out) {
    status st = ST_OK;
    if (b->of != shown->volume || strcmp(b->name, v->colour_by) != 0) {
        colour_by_close(b);
        b->of = shown->volume;
        b->world = world;
        b->opened++;
        st = open_any(b, v);
        snprintf(b->name, sizeof b->name, "%s", st == ST_OK ? v->colour_by : "");
    }
    if (st == ST_OK && b->same && b->volume && b->field == shown->field)
        st = status_describe(ST_USAGE, "--colour-by %s: that is the field whose %s", v->colour_by,
                             b->of->kind->given
                                 ? "elevations are shown: --colour-map alone colours by them"
                                 : "isosurfaces are shown, each of one value");
    if (st != ST_OK)
        return st;
    *out = (leafcast_colouring){.volume = b->volume, .field = b->field};
    if (!b->volume) {
        shown->field = b->field;
        return ST_OK;
    }
    out->place = b->same ? shown->place : NULL;
    if (leafcast_describe(b->volume).steps == 1)
        return ST_OK;
    out->step = shown->step;
    out->between = shown->between;
    st = check_time(b, shown->step);
    return st == ST_OK && shown->between > 0.0 ? check_time(b, shown->step + 1) : st;
}
