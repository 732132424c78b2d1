#include "formats/mesh/mesh_choice.h"

#include <stdio.h>
#include <string.h>

status mesh_choice_missing(const char *file, const mesh_hints *hints, const name_list *points,
                           const name_list *cells) {
    const char *name = hints->field, *quote = name ? "\"" : "";
    bool averaged = hints->cells_to_points;
    bool any = points->text[0] || cells->text[0];
    if (!name && !averaged && !any && hints->component == 0)
        return ST_OK;
    const name_list *asked = averaged ? cells : points, *other = averaged ? points : cells;
    return status_describe(
        ST_USAGE, "%s: no array %s%s%s of the %s, which have %s; the %s have %s%s", file, quote,
        name ? name : "of numbers", quote, averaged ? "cells" : "points", name_list_print(asked),
        averaged ? "points" : "cells", name_list_print(other),
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
