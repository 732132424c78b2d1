#include "render/app/scene_reading.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/input/named_file.h"
#include "render/app/colour_map.h"
#include "render/app/transfer_preset.h"

const char *scene_place_in(const scene_reading *r, char what[SCENE_WHAT_MAX], const char *form,
                           ...) {
    va_list args;
    const int n = snprintf(what, SCENE_WHAT_MAX, "%s: ", r->path);
    va_start(args, form);
    if (n > 0 && n < SCENE_WHAT_MAX)
        vsnprintf(what + n, (size_t)(SCENE_WHAT_MAX - n), form, args);
    va_end(args);
    return what;
}

status scene_unknown(const char *what, const char *key, const char *known, bool flags) {
    return status_describe(ST_USAGE, "%s: there is no \"%s\" (keys: %s%s)", what, key, known,
                           flags ? ", and flags" : "");
}

bool scene_is_flag(const char *key, bool of_one) {
    bool repeats;
    view_value takes;
    const int flag = view_options_key(key, &repeats, &takes);
    return flag && view_options_of_one(flag) == of_one;
}

status scene_find_file(const scene_reading *r, const char *name, const char *what, char **out) {
    mem m = r->m;
    char why[STATUS_TEXT_MAX];
    const status st = named_file_find(&m, r->path, name, r->follow_links, out);
    if (st == ST_OK)
        return ST_OK;
    snprintf(why, sizeof why, "%s", status_text());
    return status_describe(st, "%s: %s", what, why);
}

static bool is_map(const scene_reading *r, const char *name) {
    transfer_list map = {.m = (mem *)(uintptr_t)&r->m};
    const bool is = colour_map_named(name, &map) == ST_OK;
    transfer_list_release(&map);
    return is;
}

/* Let the name of a transfer function or map lead where the scene file says, unless `is` one that
 * is known by name. FILE#NAME is a map in a file. */
static status lead(const scene_reading *r, char name[MEDIUM_NAME_MAX], bool is, const char *what) {
    char first[MEDIUM_NAME_MAX], rest[MEDIUM_NAME_MAX], *path = NULL;
    mem m = r->m;
    if (!name[0] || is)
        return ST_OK;
    const size_t length = strcspn(name, "#");
    snprintf(first, sizeof first, "%.*s", (int)length, name);
    snprintf(rest, sizeof rest, "%s", name + length);
    status st = scene_find_file(r, first, what, &path);
    if (st == ST_OK && strlen(path) + strlen(rest) >= MEDIUM_NAME_MAX)
        st = status_describe(ST_USAGE, "%s: a name of more than %d bytes: %s", what,
                             MEDIUM_NAME_MAX - 1, path);
    if (st == ST_OK)
        snprintf(name, MEDIUM_NAME_MAX, "%s%s", path, rest);
    mem_free(&m, path);
    return st;
}

status scene_lead_medium(const scene_reading *r, medium_options *medium, const char *what) {
    status st = lead(r, medium->tf, transfer_preset_is(medium->tf), what);
    return st == ST_OK ? lead(r, medium->colour_map, is_map(r, medium->colour_map), what) : st;
}
