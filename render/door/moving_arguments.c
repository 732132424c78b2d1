#include "render/door/moving_arguments.h"

#include <string.h>

#include "formats/base/colour_field.h"
#include "formats/leaf/triangle_geometry.h"

static const public_field triangles_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_triangles),
    PUBLIC_NUMBER(leafcast_triangles, vertex_count, 1, LEAFCAST_TRIANGLES_MAX, 0),
    PUBLIC_NUMBER(leafcast_triangles, triangle_count, 1, LEAFCAST_TRIANGLES_MAX, 0),
    {PUBLIC_MEMBER(leafcast_triangles, vertices), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "vertex_count"},
    {PUBLIC_MEMBER(leafcast_triangles, triangles), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "triangle_count"},
    PUBLIC_PLACE(leafcast_triangles, values, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_triangles, colours, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_triangles, field, PUBLIC_OR_NULL),
    PUBLIC_FLAG(leafcast_triangles, smooth),
};

/* Vertices are checked where they are copied. */
static status triangles_together(const void *of) {
    const leafcast_triangles *s = of;
    if (s->field && strcmp(s->field, COLOUR_FIELD) == 0)
        return status_describe(ST_USAGE, "leafcast_triangles.field is \"%s\", the name of colours",
                               s->field);
    for (uint32_t i = 0; i < s->triangle_count; i++)
        for (int k = 0; k < TRIANGLE_CORNERS; k++)
            if (s->triangles[i][k] >= s->vertex_count)
                return status_describe(
                    ST_USAGE, "leafcast_triangles.triangles[%u][%d] is %u: vertices are 0 to %u", i,
                    k, s->triangles[i][k], s->vertex_count - 1);
    return ST_OK;
}

const public_fields moving_arguments_table =
    PUBLIC_TABLE(leafcast_triangles, triangles_rows, .together = triangles_together);

status moving_arguments_check(const leafcast_triangles *triangles) {
    return public_fields_check(&moving_arguments_table, triangles);
}
