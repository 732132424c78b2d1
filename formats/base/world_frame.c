#include "formats/base/world_frame.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "formats/base/text.h"

/* ends: for each axis, the letters where it comes from and where it goes. */
static const struct {
    const char *name;
    const char *ends[3];
    const char *words;
} axes_table[WORLD_AXES] = {
    [WORLD_UNTOLD] = {"", {"", "", ""}, ""},
    [WORLD_LPS] = {"LPS", {"RL", "AP", "IS"}, "LPS (x to the left, y to the back, z to the head)"},
    [WORLD_RAS] = {
        "RAS", {"LR", "PA", "IS"}, "RAS (x to the right, y to the front, z to the head)"}};

bool world_frame_is_told(const world_frame *f) {
    static const world_frame nothing;
    return memcmp(f, &nothing, sizeof nothing) != 0;
}

/* Copy a text and fill with zeros, since files store the struct as it is. Replace quotation marks,
 * as headers made of text put their own around it. */
static void set_text(char *to, size_t room, const char *from) {
    char text[TEXT_NAME_MAX];
    text_name(text, room, from);
    for (char *at = text; (at = strchr(at, '"'));)
        *at = '\'';
    memset(to, 0, room);
    memcpy(to, text, strlen(text));
}

void world_frame_set_unit(world_frame *f, int axis, const char *unit) {
    set_text(f->unit[axis], sizeof f->unit[axis], unit);
}

void world_frame_set_time_unit(world_frame *f, const char *unit) {
    set_text(f->time_unit, sizeof f->time_unit, unit);
}

void world_frame_set(world_frame *f, world_axes axes, const char *unit) {
    f->axes = axes;
    for (int a = 0; a < 3; a++)
        world_frame_set_unit(f, a, unit);
}

const char *world_frame_unit(const world_frame *f) {
    const bool same = strcmp(f->unit[0], f->unit[1]) == 0 && strcmp(f->unit[0], f->unit[2]) == 0;
    return same ? f->unit[0] : "";
}

const char *world_frame_units_print(const world_frame *f, char text[WORLD_UNITS_TEXT]) {
    const bool any = f->unit[0][0] || f->unit[1][0] || f->unit[2][0];
    if (!any || world_frame_unit(f)[0])
        return world_frame_unit(f);
    const char *unit[3];
    for (int a = 0; a < 3; a++)
        unit[a] = f->unit[a][0] ? f->unit[a] : "-";
    snprintf(text, WORLD_UNITS_TEXT, "%s, %s, %s", unit[0], unit[1], unit[2]);
    return text;
}

const char *world_frame_print(const world_frame *f, char text[WORLD_FRAME_TEXT]) {
    char units[WORLD_UNITS_TEXT];
    const char *words = f->axes < WORLD_AXES ? axes_table[f->axes].words : "";
    const char *all = world_frame_units_print(f, units);
    snprintf(text, WORLD_FRAME_TEXT, "%s%s%s", words, *words && *all ? ", " : "", all);
    return text;
}

const char *world_axes_name(uint32_t axes) {
    return axes < WORLD_AXES ? axes_table[axes].name : "";
}

bool world_axes_find(const char *name, world_axes *out) {
    *out = WORLD_UNTOLD;
    if (strcasecmp(name, "none") == 0)
        return true;
    for (uint32_t i = WORLD_UNTOLD + 1; i < WORLD_AXES; i++)
        if (strcasecmp(name, axes_table[i].name) == 0)
            *out = (world_axes)i;
    return *out != WORLD_UNTOLD;
}

char world_axes_end(uint32_t axes, int axis, bool positive) {
    return axes < WORLD_AXES && axes != WORLD_UNTOLD ? axes_table[axes].ends[axis][positive] : 0;
}

bool world_axes_turn(uint32_t from, uint32_t to, double map[3][4]) {
    if (from == WORLD_UNTOLD || to == WORLD_UNTOLD)
        return false;
    for (int row = 0; row < 2 && from != to; row++)
        for (int column = 0; column < 4; column++)
            map[row][column] = 0 - map[row][column]; /* + 0, never -0 */
    return true;
}
