#include "prep/export/piece_bytes.h"

#include <endian.h>
#include <string.h>

#include "formats/base/colour_field.h"
#include "formats/base/vec3.h"
#include "formats/leaf/triangle_geometry.h"

static char *put32(char *to, uint32_t value) {
    const uint32_t little = htole32(value);
    memcpy(to, &little, sizeof little);
    return to + sizeof little;
}

static char *put64(char *to, uint64_t value) {
    const uint64_t little = htole64(value);
    memcpy(to, &little, sizeof little);
    return to + sizeof little;
}

static char *put_float(char *to, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put32(to, bits);
}

static char *put_double(char *to, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put64(to, bits);
}

static char *put_floats(char *to, const double values[3]) {
    for (int i = 0; i < 3; i++)
        to = put_float(to, (float)values[i]);
    return to;
}

static char *put_point(const piece_view *v, const piece_vertex *x, char *to) {
    if (v->info->floats)
        return put_floats(to, x->at);
    for (int i = 0; i < 3; i++)
        to = put_double(to, x->at[i]);
    return to;
}

/* ---- of vertices ---- */

char *piece_bytes_points(const piece_view *v, const piece_array *a, char *to) {
    (void)a;
    for (uint32_t i = 0; i < v->owned; i++)
        to = put_point(v, &v->p->vertex[v->order[i]], to);
    return to;
}

char *piece_bytes_records(const piece_view *v, const piece_array *a, char *to) {
    (void)a;
    for (uint32_t i = 0; i < v->owned; i++) {
        const piece_vertex *x = &v->p->vertex[v->order[i]];
        to = put_floats(put_point(v, x, to), x->normal);
        if (v->info->isovalues > 1)
            to = put_double(to, v->p->isovalue);
    }
    return to;
}

bool piece_bytes_is_colour(const piece_info *info, uint32_t field) {
    return strcmp(info->fields[field], COLOUR_FIELD) == 0;
}

/* Of a value that is no colour: black. */
static char *put_colour(char *to, float value) {
    const uint32_t rgb = value >= 0.0F && value <= (float)0xffffff ? (uint32_t)value : 0;
    for (int shift = 16; shift >= 0; shift -= 8)
        *to++ = (char)(unsigned char)(rgb >> shift);
    return to;
}

char *piece_bytes_given(const piece_view *v, const piece_array *a, char *to) {
    (void)a;
    for (uint32_t i = 0; i < v->owned; i++) {
        const uint32_t n = v->order[i];
        to = put_point(v, &v->p->vertex[n], to);
        if (v->info->normals)
            to = put_floats(to, v->p->vertex[n].normal);
        for (uint32_t k = 0; k < v->info->field_count; k++)
            to = piece_bytes_is_colour(v->info, k) ? put_colour(to, v->p->values[k][n])
                                                   : put_float(to, v->p->values[k][n]);
    }
    return to;
}

char *piece_bytes_normals(const piece_view *v, const piece_array *a, char *to) {
    (void)a;
    for (uint32_t i = 0; i < v->owned; i++)
        to = put_floats(to, v->p->vertex[v->order[i]].normal);
    return to;
}

char *piece_bytes_isovalues(const piece_view *v, const piece_array *a, char *to) {
    (void)a;
    for (uint32_t i = 0; i < v->owned; i++)
        to = put_double(to, v->p->isovalue);
    return to;
}

char *piece_bytes_values(const piece_view *v, const piece_array *a, char *to) {
    for (uint32_t i = 0; i < v->owned; i++)
        to = put_float(to, v->p->values[a->field][v->order[i]]);
    return to;
}

/* ---- of cells ---- */

char *piece_bytes_faces(const piece_view *v, const piece_array *a, char *to) {
    (void)a;
    for (uint32_t c = 0; c < v->p->cells; c++) {
        *to++ = 3;
        for (int i = 0; i < 3; i++)
            to = put32(to, (uint32_t)v->numbers[v->p->corner[3 * (size_t)c + i]]);
    }
    return to;
}

/* The facet's normal, by the order of its corners; 0 0 0 if they lie on a line. */
static void facet_normal(const double *const at[3], double normal[3]) {
    double one[3], other[3];
    vec3_sub(at[1], at[0], one);
    vec3_sub(at[2], at[0], other);
    vec3_cross(one, other, normal);
    if (!vec3_unit(normal, normal))
        memset(normal, 0, 3 * sizeof *normal);
}

char *piece_bytes_facets(const piece_view *v, const piece_array *a, char *to) {
    (void)a;
    for (uint32_t c = 0; c < v->p->cells; c++) {
        const double *at[3];
        double normal[3];
        for (int i = 0; i < 3; i++)
            at[i] = v->p->vertex[v->p->corner[3 * (size_t)c + i]].at;
        facet_normal(at, normal);
        to = put_floats(to, normal);
        for (int i = 0; i < 3; i++)
            to = put_floats(to, at[i]);
        memset(to, 0, 2);
        to += 2;
    }
    return to;
}

char *piece_bytes_corners(const piece_view *v, const piece_array *a, char *to) {
    (void)a;
    for (uint32_t i = 0; i < v->p->corners; i++)
        to = put64(to, v->numbers[v->p->corner[i]]);
    return to;
}

char *piece_bytes_offsets(const piece_view *v, const piece_array *a, char *to) {
    (void)a;
    uint64_t next = v->first_corner;
    for (uint32_t c = 0; c < v->p->cells; c++) {
        next += (uint64_t)piece_corners(v->p, c);
        to = put64(to, next);
    }
    return to;
}

char *piece_bytes_shapes(const piece_view *v, const piece_array *a, char *to) {
    static const char vtk[CELL_SHAPES] = {
        [CELL_TET] = 10,   [CELL_VOXEL] = 11,   [CELL_HEXAHEDRON] = 12,
        [CELL_WEDGE] = 13, [CELL_PYRAMID] = 14, [CELL_QUADRATIC_TET] = 24};
    (void)a;
    for (uint32_t c = 0; c < v->p->cells; c++)
        *to++ = vtk[v->p->shape[c]];
    return to;
}
