#include "formats/mesh/mesh_choice.h"

#include <stdio.h>
#include <string.h>

void mesh_choice_add(mesh_choice_names *names, const char *name) {
    static const char more[] = ", ..";
    char quoted[MESH_CHOICE_TEXT];
    int length = snprintf(quoted, sizeof quoted, "%s\"%s\"", names->length ? ", " : "", name);
    if (names->full || strstr(names->text, names->length ? quoted + 2 : quoted))
        return;
    names->full = names->length + (size_t)length + sizeof more > sizeof names->text;
    strcpy(names->text + names->length, names->full ? more : quoted);
    names->length = strlen(names->text);
}

static const char *list(const mesh_choice_names *names) {
    return names->text[0] ? names->text : "none";
}

status mesh_choice_missing(const char *file, const mesh_hints *hints,
                           const mesh_choice_names *points, const mesh_choice_names *cells) {
    const char *name = hints->field, *quote = name ? "\"" : "";
    bool averaged = hints->cells_to_points;
    bool any = points->text[0] || cells->text[0];
    if (!name && !averaged && !any && hints->component == 0)
        return ST_OK;
    const mesh_choice_names *asked = averaged ? cells : points, *other = averaged ? points : cells;
    return status_describe(
        ST_USAGE, "%s: no array %s%s%s of the %s, which have %s; the %s have %s%s", file, quote,
        name ? name : "of numbers", quote, averaged ? "cells" : "points", list(asked),
        averaged ? "points" : "cells", list(other),
        averaged || !other->text[0] ? ""
                                    : " (--cells-to-points takes them, averaged to the points)");
}

status mesh_choice_component(const char *file, const mesh_hints *hints, const char *array,
                             int components) {
    if (hints->component >= 0 && hints->component <= components)
        return ST_OK;
    return status_describe(ST_USAGE, "%s: \"%s\" has no component %d but 1 to %d", file, array,
                           hints->component, components);
}
