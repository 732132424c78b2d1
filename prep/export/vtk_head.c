#include "prep/export/vtk_head.h"

#include <endian.h>
#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "prep/export/head_text.h"

static const char *type_name(sample_type type) {
    switch (type) {
    case SAMPLE_U8: return "UInt8";
    case SAMPLE_I8: return "Int8";
    case SAMPLE_U16: return "UInt16";
    case SAMPLE_I16: return "Int16";
    default: return "Float32";
    }
}

static void put_size(head_text *h, uint64_t size) {
    const uint64_t little = htole64(size);
    head_text_bytes(h, &little, sizeof little);
}

static void put_extent(head_text *h, const char *key, const grid *g) {
    head_text_add(h, " %s=\"0 %u 0 %u 0 %u\"", key, g->dims[0] - 1, g->dims[1] - 1, g->dims[2] - 1);
}

static void put_numbers(head_text *h, const char *key, const double *values, int count) {
    head_text_add(h, " %s=\"", key);
    for (int i = 0; i < count; i++) {
        head_text_add(h, i > 0 ? " " : "");
        head_text_number(h, values[i]);
    }
    head_text_add(h, "\"");
}

static void begin(head_text *h, const char *kind) {
    head_text_add(h,
                  "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" "
                  "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<%s",
                  kind, kind);
}

/* Declare the array of samples. Its size stands at `offset` of the appended data. */
static void put_samples(head_text *h, const grid *g, uint64_t offset) {
    const char *name = g->name[0] ? g->name : "value";
    head_text_add(h, "<PointData Scalars=\"");
    head_text_xml(h, name);
    head_text_add(h, "\">\n<DataArray type=\"%s\" Name=\"", type_name(g->type));
    head_text_xml(h, name);
    head_text_add(h, "\" format=\"appended\" offset=\"%llu\"/>\n</PointData>\n",
                  (unsigned long long)offset);
}

static status write_head(head_text *h, out_stream *out) {
    status st = h->st == ST_OK ? out_stream_write(out, h->text, h->size) : h->st;
    head_text_release(h);
    return st;
}

/* ---- images ---- */

status vtk_head_image_check(const grid *g) {
    if (!grid_is_rectilinear(g))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "a .vti has samples at equal distances; this grid's axes are uneven, "
                           "which .vtr and .nrrd can hold");
}

/* A column of the map is spacing times direction. If it lies along an axis, its direction is exact.
 */
static void part_map(const grid *g, double spacing[3], double direction[9], double origin[3]) {
    for (int a = 0; a < 3; a++) {
        double column[3];
        for (int row = 0; row < 3; row++)
            column[row] = g->to_world[row][a];
        const double sum = vec3_size(column);
        double largest = 0;
        for (int row = 0; row < 3; row++)
            largest = fmax(largest, fabs(column[row]));
        spacing[a] = sum == largest ? largest
                                    : largest * sqrt((column[0] / largest) * (column[0] / largest) +
                                                     (column[1] / largest) * (column[1] / largest) +
                                                     (column[2] / largest) * (column[2] / largest));
        for (int row = 0; row < 3; row++)
            direction[3 * row + a] = column[row] / spacing[a];
        origin[a] = g->to_world[a][3];
    }
}

status vtk_head_image(mem *m, out_stream *out, const grid *g) {
    head_text h = {.m = m};
    double spacing[3], direction[9], origin[3];
    part_map(g, spacing, direction, origin);
    begin(&h, "ImageData");
    put_extent(&h, "WholeExtent", g);
    put_numbers(&h, "Origin", origin, 3);
    put_numbers(&h, "Spacing", spacing, 3);
    put_numbers(&h, "Direction", direction, 9);
    head_text_add(&h, ">\n<Piece");
    put_extent(&h, "Extent", g);
    head_text_add(&h, ">\n");
    put_samples(&h, g, 0);
    head_text_add(&h, "</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_");
    put_size(&h, grid_samples(g) * sample_size(g->type));
    return write_head(&h, out);
}

/* ---- rectilinear grids ---- */

status vtk_head_axes_check(const grid *g) {
    for (int a = 0; a < 3; a++)
        for (int row = 0; row < 3; row++)
            if (row != a && g->to_world[row][a] != 0)
                return status_describe(ST_UNSUPPORTED,
                                       "a .vtr has axes along x, y and z; this grid is turned "
                                       "against them, which .nrrd can hold");
    return ST_OK;
}

static double coordinate(const grid *g, int a, uint32_t i) {
    const double steps = g->axis[a] ? g->axis[a][i] : i;
    return g->to_world[a][a] * steps + g->to_world[a][3];
}

static void put_axes(head_text *h, const grid *g) {
    for (int a = 0; a < 3; a++) {
        put_size(h, g->dims[a] * sizeof(double));
        for (uint32_t i = 0; i < g->dims[a]; i++) {
            const double at = coordinate(g, a, i);
            uint64_t bits;
            memcpy(&bits, &at, sizeof bits);
            put_size(h, bits);
        }
    }
}

status vtk_head_axes(mem *m, out_stream *out, const grid *g) {
    head_text h = {.m = m};
    uint64_t offset = 0;
    begin(&h, "RectilinearGrid");
    put_extent(&h, "WholeExtent", g);
    head_text_add(&h, ">\n<Piece");
    put_extent(&h, "Extent", g);
    head_text_add(&h, ">\n<Coordinates>\n");
    for (int a = 0; a < 3; a++) {
        head_text_add(
            &h, "<DataArray type=\"Float64\" Name=\"%c\" format=\"appended\" offset=\"%llu\"/>\n",
            "xyz"[a], (unsigned long long)offset);
        offset += sizeof(uint64_t) + g->dims[a] * sizeof(double);
    }
    head_text_add(&h, "</Coordinates>\n");
    put_samples(&h, g, offset);
    head_text_add(&h, "</Piece>\n</RectilinearGrid>\n<AppendedData encoding=\"raw\">\n_");
    put_axes(&h, g);
    put_size(&h, grid_samples(g) * sample_size(g->type));
    return write_head(&h, out);
}

status vtk_head_tail(out_stream *out) {
    return out_stream_text(out, "\n</AppendedData>\n</VTKFile>\n");
}
