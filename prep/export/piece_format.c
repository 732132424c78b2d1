#include "prep/export/piece_format.h"

#include <endian.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "prep/export/piece_bytes.h"

enum { STL_TITLE = 80, ARRAYS = 7 };

void piece_layout_release(piece_layout *l) {
    for (int i = 0; i < l->count; i++)
        head_text_release(&l->arrays[i].before);
    mem_free(l->m, l->arrays);
    head_text_release(&l->tail);
    *l = (piece_layout){.m = l->m};
}

static status begin(mem *m, const piece_info *info, piece_layout *l) {
    *l = (piece_layout){.m = m, .tail = {.m = m}};
    l->arrays = mem_array(m, ARRAYS + (size_t)info->field_count, sizeof *l->arrays);
    return l->arrays ? ST_OK : ST_NOMEM;
}

/* Append an array. Returns the text before it, for the caller to fill. */
static head_text *add(piece_layout *l, piece_array a) {
    a.before = (head_text){.m = l->m};
    l->arrays[l->count] = a;
    return &l->arrays[l->count++].before;
}

static size_t point_bytes(const piece_info *info) {
    return 3 * (info->floats ? sizeof(float) : sizeof(double));
}

static status finish(const piece_layout *l) {
    for (int i = 0; i < l->count; i++)
        if (l->arrays[i].before.st != ST_OK)
            return l->arrays[i].before.st;
    return l->tail.st;
}

/* ---- PLY ---- */

static size_t given_bytes(const piece_info *info) {
    size_t bytes = point_bytes(info) + (info->normals ? 3 * sizeof(float) : 0);
    for (uint32_t i = 0; i < info->field_count; i++)
        bytes += piece_bytes_is_colour(info, i) ? 3 : sizeof(float);
    return bytes;
}

/* Names in a header of PLY have no blanks. */
static void add_property(head_text *h, const piece_info *info, uint32_t i) {
    if (piece_bytes_is_colour(info, i)) {
        head_text_add(h, "property uchar red\nproperty uchar green\nproperty uchar blue\n");
        return;
    }
    char name[80];
    snprintf(name, sizeof name, "%s", info->fields[i]);
    for (char *c = name; *c; c++)
        if (*c == ' ' || *c == '\t')
            *c = '_';
    head_text_add(h, "property float %s\n", name);
}

static status lay_out_ply(mem *m, const piece_info *info, piece_layout *l) {
    status st = begin(m, info, l);
    if (st != ST_OK)
        return st;
    if (info->vertices > (uint64_t)UINT32_MAX + 1)
        return status_describe(ST_UNSUPPORTED,
                               "%llu vertices are more than PLY can number; .vtp can hold them",
                               (unsigned long long)info->vertices);
    const char *type = info->floats ? "float" : "double";
    const bool many = info->isovalues > 1;
    const size_t record = point_bytes(info) + 3 * sizeof(float) + (many ? sizeof(double) : 0);
    head_text *h =
        add(l, info->given ? (piece_array){.stride = given_bytes(info), .encode = piece_bytes_given}
                           : (piece_array){.stride = record, .encode = piece_bytes_records});
    head_text_add(h, "ply\nformat binary_little_endian 1.0\ncomment leafcast %s\n",
                  info->given ? "surface" : "isosurface");
    if (info->name[0])
        head_text_add(h, "comment of %s\n", info->name);
    head_text_add(h, "element vertex %llu\n", (unsigned long long)info->vertices);
    for (int a = 0; a < 3; a++)
        head_text_add(h, "property %s %c\n", type, "xyz"[a]);
    for (int a = 0; a < 3 && (!info->given || info->normals); a++)
        head_text_add(h, "property float n%c\n", "xyz"[a]);
    if (many)
        head_text_add(h, "property double isovalue\n");
    for (uint32_t i = 0; i < info->field_count && info->given; i++)
        add_property(h, info, i);
    head_text_add(h, "element face %llu\nproperty list uchar %s vertex_indices\nend_header\n",
                  (unsigned long long)info->cells,
                  info->vertices > (uint64_t)INT32_MAX + 1 ? "uint" : "int");
    add(l, (piece_array){
               .stride = 1 + 3 * sizeof(uint32_t), .of = PIECE_CELLS, .encode = piece_bytes_faces});
    return finish(l);
}

/* ---- STL ---- */

static status lay_out_stl(mem *m, const piece_info *info, piece_layout *l) {
    char title[STL_TITLE + 1] = {0};
    status st = begin(m, info, l);
    if (st != ST_OK)
        return st;
    if (info->cells > UINT32_MAX)
        return status_describe(ST_UNSUPPORTED,
                               "%llu triangles are more than STL can count; .vtp can hold them",
                               (unsigned long long)info->cells);
    const uint32_t count = htole32((uint32_t)info->cells);
    head_text *h = add(l, (piece_array){.stride = 12 * sizeof(float) + 2,
                                        .of = PIECE_CELLS,
                                        .encode = piece_bytes_facets});
    snprintf(title, sizeof title, "leafcast %s %.40s", info->given ? "surface" : "isosurface",
             info->name);
    head_text_bytes(h, title, STL_TITLE);
    head_text_bytes(h, &count, sizeof count);
    return finish(l);
}

/* ---- VTK's XML ---- */

/* VTK arrays in the order of their declaration: each begins where the previous one ends. */
typedef struct vtk_file {
    piece_layout *l;
    const piece_info *info;
    head_text *h;
    uint64_t offset;
} vtk_file;

uint64_t piece_elements(const piece_info *info, piece_domain of) {
    const uint64_t counts[PIECE_DOMAINS] = {info->vertices, info->cells, info->corners};
    return counts[of];
}

static void declare(vtk_file *f, const char *type, const char *name, int components,
                    piece_array a) {
    const uint64_t size = piece_elements(f->info, a.of) * a.stride, little = htole64(size);
    head_text_add(f->h, "<DataArray type=\"%s\" Name=\"", type);
    head_text_xml(f->h, name);
    head_text_add(f->h, "\"");
    if (components > 1)
        head_text_add(f->h, " NumberOfComponents=\"%d\"", components);
    head_text_add(f->h, " format=\"appended\" offset=\"%llu\"/>\n", (unsigned long long)f->offset);
    f->offset += sizeof size + size;
    head_text *before = add(f->l, a);
    head_text_bytes(before, &little, sizeof little);
}

static void begin_vtk(vtk_file *f, const char *kind, const char *cells) {
    head_text_add(f->h,
                  "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" "
                  "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<%s>\n",
                  kind, kind);
    if (f->info->time) {
        head_text_add(f->h, "<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" "
                            "NumberOfTuples=\"1\" format=\"ascii\">");
        head_text_number(f->h, *f->info->time);
        head_text_add(f->h, "</DataArray>\n</FieldData>\n");
    }
    head_text_add(f->h, "<Piece NumberOfPoints=\"%llu\" %s=\"%llu\">\n",
                  (unsigned long long)f->info->vertices, cells, (unsigned long long)f->info->cells);
}

static void declare_points(vtk_file *f) {
    head_text_add(f->h, "<Points>\n");
    declare(f, f->info->floats ? "Float32" : "Float64", "Points", 3,
            (piece_array){.stride = point_bytes(f->info), .encode = piece_bytes_points});
    head_text_add(f->h, "</Points>\n");
}

static void declare_cells(vtk_file *f) {
    declare(f, "Int64", "connectivity", 1,
            (piece_array){
                .stride = sizeof(int64_t), .of = PIECE_CORNERS, .encode = piece_bytes_corners});
    declare(
        f, "Int64", "offsets", 1,
        (piece_array){.stride = sizeof(int64_t), .of = PIECE_CELLS, .encode = piece_bytes_offsets});
}

/* Put the declarations before the first array, ahead of its size. */
static status end_vtk(vtk_file *f, const char *kind) {
    head_text_add(f->h, "</Piece>\n</%s>\n<AppendedData encoding=\"raw\">\n_", kind);
    head_text *first = &f->l->arrays[0].before;
    head_text_bytes(f->h, first->text, first->st == ST_OK ? first->size : 0);
    const status st = first->st;
    head_text_release(first);
    *first = *f->h;
    *f->h = (head_text){.m = f->l->m};
    head_text_add(&f->l->tail, "\n</AppendedData>\n</VTKFile>\n");
    return st == ST_OK ? finish(f->l) : st;
}

static void declare_normals(vtk_file *f) {
    declare(f, "Float32", "Normals", 3,
            (piece_array){.stride = 3 * sizeof(float), .encode = piece_bytes_normals});
}

/* The fields of all vertices, and their beginning. */
static void declare_values(vtk_file *f) {
    head_text_add(f->h, "<PointData Scalars=\"");
    head_text_xml(f->h, f->info->fields[0]);
    head_text_add(f->h, f->info->normals ? "\" Normals=\"Normals\">\n" : "\">\n");
    if (f->info->normals)
        declare_normals(f);
    for (uint32_t i = 0; i < f->info->field_count; i++)
        declare(f, "Float32", f->info->fields[i], 1,
                (piece_array){.stride = sizeof(float), .field = i, .encode = piece_bytes_values});
}

static status lay_out_vtp(mem *m, const piece_info *info, piece_layout *l) {
    head_text h = {.m = m};
    vtk_file f = {.l = l, .info = info, .h = &h};
    status st = begin(m, info, l);
    if (st != ST_OK)
        return st;
    begin_vtk(&f, "PolyData", "NumberOfPolys");
    declare_points(&f);
    if (info->given) {
        declare_values(&f);
    } else {
        head_text_add(&h, "<PointData Normals=\"Normals\">\n");
        declare_normals(&f);
    }
    if (info->isovalues > 1)
        declare(&f, "Float64", "isovalue", 1,
                (piece_array){.stride = sizeof(double), .encode = piece_bytes_isovalues});
    head_text_add(&h, "</PointData>\n<Polys>\n");
    declare_cells(&f);
    head_text_add(&h, "</Polys>\n");
    return end_vtk(&f, "PolyData");
}

static status lay_out_vtu(mem *m, const piece_info *info, piece_layout *l) {
    head_text h = {.m = m};
    vtk_file f = {.l = l, .info = info, .h = &h};
    status st = begin(m, info, l);
    if (st != ST_OK)
        return st;
    begin_vtk(&f, "UnstructuredGrid", "NumberOfCells");
    declare_points(&f);
    declare_values(&f);
    head_text_add(&h, "</PointData>\n<Cells>\n");
    declare_cells(&f);
    declare(&f, "UInt8", "types", 1,
            (piece_array){.stride = 1, .of = PIECE_CELLS, .encode = piece_bytes_shapes});
    head_text_add(&h, "</Cells>\n");
    return end_vtk(&f, "UnstructuredGrid");
}

const piece_format piece_formats[] = {
    {"ply", ".ply", false, false, lay_out_ply},
    {"stl", ".stl", false, true, lay_out_stl},
    {"vtp", ".vtp", false, false, lay_out_vtp},
    {"vtu", ".vtu", true, false, lay_out_vtu},
};
const int piece_format_count = sizeof piece_formats / sizeof *piece_formats;
