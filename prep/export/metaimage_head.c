#include "prep/export/metaimage_head.h"

#include <string.h>

#include "formats/base/vec3.h"
#include "prep/export/head_text.h"

status metaimage_head_check(const grid *g) {
    if (!grid_is_rectilinear(g))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "MetaImage has samples at equal distances; this grid's axes are uneven, "
                           "which .vtr and .nrrd can hold");
}

const char *metaimage_head_loses(const grid *g) {
    const char *unit = world_frame_unit(&g->frame);
    return !unit[0] || strcmp(unit, "mm") == 0 ? NULL
                                               : "MetaImage has no unit, and other programs take "
                                                 "its lengths for mm; .nrrd keeps it";
}

static const char *type_name(sample_type type) {
    switch (type) {
    case SAMPLE_U8: return "MET_UCHAR";
    case SAMPLE_I8: return "MET_CHAR";
    case SAMPLE_U16: return "MET_USHORT";
    case SAMPLE_I16: return "MET_SHORT";
    default: return "MET_FLOAT";
    }
}

static void add_numbers(head_text *h, const char *key, const double *values, int count) {
    head_text_add(h, "%s =", key);
    for (int i = 0; i < count; i++) {
        head_text_add(h, " ");
        head_text_number(h, values[i]);
    }
    head_text_add(h, "\n");
}

/* Row a of the direction matrix holds the direction of axis a. */
static void add_place(head_text *h, const grid *g) {
    double direction[9], origin[3], spacing[3];
    for (int a = 0; a < 3; a++) {
        const double column[3] = {g->to_world[0][a], g->to_world[1][a], g->to_world[2][a]};
        spacing[a] = vec3_length(column);
        origin[a] = g->to_world[a][3];
        for (int row = 0; row < 3; row++)
            direction[3 * a + row] = column[row] / spacing[a] + 0.0;
    }
    add_numbers(h, "TransformMatrix", direction, 9);
    add_numbers(h, "Offset", origin, 3);
    head_text_add(h, "CenterOfRotation = 0 0 0\n");
    add_numbers(h, "ElementSpacing", spacing, 3);
}

status metaimage_head(mem *m, out_stream *out, const grid *g) {
    head_text h = {.m = m};
    grid turned = *g;
    (void)world_axes_turn(g->frame.axes, WORLD_LPS, turned.to_world);
    head_text_add(
        &h, "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
            "CompressedData = False\n");
    add_place(&h, &turned);
    head_text_add(&h, "DimSize = %u %u %u\nElementType = %s\nElementDataFile = LOCAL\n", g->dims[0],
                  g->dims[1], g->dims[2], type_name(g->type));
    status st = h.st == ST_OK ? out_stream_write(out, h.text, h.size) : h.st;
    head_text_release(&h);
    return st;
}
