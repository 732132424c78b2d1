#include "tests/support/surface_model.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/scratch.h"

enum { POINTS = SURFACE_MODEL_POINTS, TRIANGLES = SURFACE_MODEL_TRIANGLES };

const float surface_model_xyz[POINTS][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                            {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1.5f}};
const uint32_t surface_model_triangles[TRIANGLES][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7},
                                                        {0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5},
                                                        {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};

float surface_model_value(uint32_t point) {
    return 0.5f + 2 * (float)point;
}

float surface_model_face(uint32_t face) {
    return 100 - (float)face;
}

/* Bytes of colours: 0 or 255, which no rule of sRGB changes. */
static unsigned byte(uint32_t point, int c) {
    return point >> c & 1 ? 255 : 0;
}

float surface_model_colour(uint32_t point) {
    return (float)(65536 * byte(point, 0) + 256 * byte(point, 1) + byte(point, 2));
}

/* ---- bytes ---- */

static bool big; /* the order of bytes */

static void put(FILE *f, uint64_t bits, int size) {
    for (int i = 0; i < size; i++)
        fputc((int)(bits >> 8 * (big ? size - 1 - i : i) & 0xff), f);
}

static void put_float(FILE *f, float v) {
    uint32_t bits;
    memcpy(&bits, &v, 4);
    put(f, bits, 4);
}

static void put_points(FILE *f) {
    for (int i = 0; i < POINTS; i++)
        for (int a = 0; a < 3; a++)
            put_float(f, surface_model_xyz[i][a]);
}

static void text_points(FILE *f) {
    for (int i = 0; i < POINTS; i++)
        fprintf(f, "%g %g %g\n", (double)surface_model_xyz[i][0], (double)surface_model_xyz[i][1],
                (double)surface_model_xyz[i][2]);
}

/* ---- PLY ---- */

static void ply_head(FILE *f, const char *coding, bool strips) {
    fprintf(f,
            "ply\nformat %s 1.0\ncomment a cube\nelement vertex %d\nproperty float x\nproperty "
            "float y\nproperty float z\nproperty float nx\nproperty float heat\nproperty uchar "
            "red\nproperty uchar green\nproperty uchar blue\nelement other 1\nproperty list uchar "
            "short what\n",
            coding, POINTS);
    if (strips)
        fprintf(f, "element tristrips 1\nproperty list int int vertex_indices\nend_header\n");
    else
        fprintf(f,
                "element face %d\nproperty float part\nproperty list uchar int "
                "vertex_indices\nend_header\n",
                TRIANGLES);
}

static void ply_text(FILE *f) {
    ply_head(f, "ascii", false);
    for (uint32_t i = 0; i < POINTS; i++)
        fprintf(f, "%g %g %g 7 %g %u %u %u\n", (double)surface_model_xyz[i][0],
                (double)surface_model_xyz[i][1], (double)surface_model_xyz[i][2],
                (double)surface_model_value(i), byte(i, 0), byte(i, 1), byte(i, 2));
    fprintf(f, "2 -5 7\n");
    for (uint32_t i = 0; i < TRIANGLES; i++)
        fprintf(f, "%g 3 %u %u %u\n", (double)surface_model_face(i), surface_model_triangles[i][0],
                surface_model_triangles[i][1], surface_model_triangles[i][2]);
}

static void ply_vertices(FILE *f) {
    for (uint32_t i = 0; i < POINTS; i++) {
        for (int a = 0; a < 3; a++)
            put_float(f, surface_model_xyz[i][a]);
        put_float(f, 7);
        put_float(f, surface_model_value(i));
        for (int c = 0; c < 3; c++)
            put(f, byte(i, c), 1);
    }
    put(f, 1, 1);
    put(f, 9, 2);
}

static void ply_binary(FILE *f) {
    ply_head(f, big ? "binary_big_endian" : "binary_little_endian", false);
    ply_vertices(f);
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        put_float(f, surface_model_face(i));
        put(f, 3, 1);
        for (int c = 0; c < 3; c++)
            put(f, surface_model_triangles[i][c], 4);
    }
}

static void ply_big(FILE *f) {
    big = true;
    ply_binary(f);
    big = false;
}

/* Each pair of triangles is a strip. */
static void strip_of(int pair, uint32_t ids[4]) {
    const uint32_t *t = surface_model_triangles[2 * pair],
                   *u = surface_model_triangles[2 * pair + 1];
    /* (a b c), (a c d): the strip b, c, a, d turns (b c a) and (a c d). */
    ids[0] = t[1];
    ids[1] = t[2];
    ids[2] = t[0];
    ids[3] = u[2];
    if (u[1] != t[2]) { /* (a b c), (a d b): c, a, b, d turns (c a b) and (b a d) */
        ids[0] = t[2];
        ids[1] = t[0];
        ids[2] = t[1];
        ids[3] = u[1];
    }
}

static void ply_strips(FILE *f) {
    ply_head(f, "binary_little_endian", true);
    ply_vertices(f);
    put(f, 5 * TRIANGLES / 2 - 1, 4);
    for (int i = 0; i < TRIANGLES / 2; i++) {
        uint32_t ids[4];
        strip_of(i, ids);
        for (int c = 0; c < 4; c++)
            put(f, ids[c], 4);
        if (i + 1 < TRIANGLES / 2)
            put(f, UINT32_MAX, 4);
    }
}

/* ---- STL, OBJ, OFF ---- */

static void stl_binary(FILE *f) {
    fprintf(f, "%-80s", "solid in name only");
    put(f, TRIANGLES, 4);
    for (int i = 0; i < TRIANGLES; i++) {
        for (int a = 0; a < 3; a++)
            put_float(f, 0);
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++)
                put_float(f, surface_model_xyz[surface_model_triangles[i][c]][a]);
        put(f, 0, 2);
    }
}

static void stl_text(FILE *f) {
    for (int i = 0; i < TRIANGLES; i++) {
        if (i % 6 == 0)
            fprintf(f, "solid half a cube\n");
        fprintf(f, "  facet normal 0 0 0\n    outer loop\n");
        for (int c = 0; c < 3; c++) {
            const float *p = surface_model_xyz[surface_model_triangles[i][c]];
            fprintf(f, "      vertex %g %g %g\n", (double)p[0], (double)p[1], (double)p[2]);
        }
        fprintf(f, "    endloop\n  endfacet\n");
        if (i % 6 == 5)
            fprintf(f, "endsolid half a cube\n");
    }
}

static void obj_text(FILE *f) {
    fprintf(f, "# a cube\nmtllib none.mtl\no cube\n");
    for (uint32_t i = 0; i < POINTS; i++)
        fprintf(f, "v %g %g %g %u %u.0 %u\nvt 0 0\nvn 0 0 1\n", (double)surface_model_xyz[i][0],
                (double)surface_model_xyz[i][1], (double)surface_model_xyz[i][2], byte(i, 0) / 255,
                byte(i, 1) / 255, byte(i, 2) / 255);
    fprintf(f, "g sides\ns off\n");
    for (int i = 0; i < TRIANGLES; i++) {
        const uint32_t *t = surface_model_triangles[i];
        switch (i % 4) {
        case 0: fprintf(f, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1); break;
        case 1: fprintf(f, "f %u/1 %u/2/3 \\\n  %u//4\r\n", t[0] + 1, t[1] + 1, t[2] + 1); break;
        case 2: fprintf(f, "f %d %d/-1 %u # last\n", (int)t[0] - 8, (int)t[1] - 8, t[2] + 1); break;
        default: fprintf(f, "  f\t%u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
        }
    }
}

static void off_text(FILE *f) {
    fprintf(f, "COFF # a cube\n# counts\n%d %d 0\n", POINTS, TRIANGLES);
    for (uint32_t i = 0; i < POINTS; i++)
        fprintf(f, "%g %g %g %u %u %u 255\n", (double)surface_model_xyz[i][0],
                (double)surface_model_xyz[i][1], (double)surface_model_xyz[i][2], byte(i, 0),
                byte(i, 1), byte(i, 2));
    for (int i = 0; i < TRIANGLES; i++)
        fprintf(f, "3 %u %u %u  0.5 0.5 0.5\n", surface_model_triangles[i][0],
                surface_model_triangles[i][1], surface_model_triangles[i][2]);
}

/* ---- VTK ---- */

static void vtk_head(FILE *f, const char *version, bool text) {
    fprintf(f, "# vtk DataFile Version %s\na cube\n%s\nDATASET POLYDATA\nPOINTS %d float\n",
            version, text ? "ASCII" : "BINARY", POINTS);
    if (text)
        text_points(f);
    else
        put_points(f);
    fprintf(f, "\n");
}

static void vtk_text_data(FILE *f, int cells) {
    fprintf(f, "\nCELL_DATA %d\nSCALARS part float 1\nLOOKUP_TABLE default\n", cells);
    for (int i = 0; i < cells; i++)
        fprintf(f, "%g ", (double)surface_model_face((uint32_t)(i + TRIANGLES - cells)));
    fprintf(f, "\nPOINT_DATA %d\nCOLOR_SCALARS paint 3\n", POINTS);
    for (uint32_t i = 0; i < POINTS; i++)
        fprintf(f, "%u %u %u\n", byte(i, 0) / 255, byte(i, 1) / 255, byte(i, 2) / 255);
    fprintf(f, "NORMALS n float\n");
    text_points(f);
    fprintf(f, "FIELD f 1\nheat 1 %d float\n", POINTS);
    for (uint32_t i = 0; i < POINTS; i++)
        fprintf(f, "%g ", (double)surface_model_value(i));
    fprintf(f, "\n");
}

static void vtk_text(FILE *f) {
    vtk_head(f, "3.0", true);
    fprintf(f, "POLYGONS %d %d\n", TRIANGLES, 4 * TRIANGLES);
    for (int i = 0; i < TRIANGLES; i++)
        fprintf(f, "3 %u %u %u\n", surface_model_triangles[i][0], surface_model_triangles[i][1],
                surface_model_triangles[i][2]);
    vtk_text_data(f, TRIANGLES);
}

static void vtk_text_5(FILE *f) {
    vtk_head(f, "5.1", true);
    fprintf(f, "POLYGONS %d %d\nOFFSETS vtktypeint64\n", TRIANGLES + 1, 3 * TRIANGLES);
    for (int i = 0; i <= TRIANGLES; i++)
        fprintf(f, "%d ", 3 * i);
    fprintf(f, "\nCONNECTIVITY vtktypeint64\n");
    for (int i = 0; i < TRIANGLES; i++)
        fprintf(f, "%u %u %u\n", surface_model_triangles[i][0], surface_model_triangles[i][1],
                surface_model_triangles[i][2]);
    vtk_text_data(f, TRIANGLES);
}

static void vtk_binary(FILE *f) {
    big = true;
    vtk_head(f, "3.0", false);
    fprintf(f, "TRIANGLE_STRIPS %d %d\n", TRIANGLES / 2, 5 * TRIANGLES / 2);
    for (int i = 0; i < TRIANGLES / 2; i++) {
        uint32_t ids[4];
        strip_of(i, ids);
        put(f, 4, 4);
        for (int c = 0; c < 4; c++)
            put(f, ids[c], 4);
    }
    fprintf(f, "\nPOINT_DATA %d\nSCALARS heat float\nLOOKUP_TABLE default\n", POINTS);
    for (uint32_t i = 0; i < POINTS; i++)
        put_float(f, surface_model_value(i));
    fprintf(f, "\nCOLOR_SCALARS paint 4\n");
    for (uint32_t i = 0; i < POINTS; i++)
        for (int c = 0; c < 4; c++)
            put(f, c < 3 ? byte(i, c) : 255, 1);
    fprintf(f, "\n");
    big = false;
}

/* Two pieces of 6 triangles, each with all points. */
static void vtp_text(FILE *f) {
    fprintf(f, "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\">"
               "<PolyData>\n");
    for (uint32_t piece = 0; piece < 2; piece++) {
        fprintf(f,
                "<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"0\" NumberOfPolys=\"6\">\n"
                "<PointData Scalars=\"heat\"><DataArray type=\"Float32\" Name=\"heat\" "
                "format=\"ascii\">\n",
                POINTS);
        for (uint32_t i = 0; i < POINTS; i++)
            fprintf(f, "%g ", (double)surface_model_value(i));
        fprintf(f, "</DataArray>\n<DataArray type=\"UInt8\" Name=\"paint\" "
                   "NumberOfComponents=\"3\" format=\"ascii\">\n");
        for (uint32_t i = 0; i < POINTS; i++)
            fprintf(f, "%u %u %u ", byte(i, 0), byte(i, 1), byte(i, 2));
        fprintf(f, "</DataArray></PointData>\n<CellData><DataArray type=\"Float64\" "
                   "Name=\"part\" format=\"ascii\">\n");
        for (uint32_t i = 0; i < 6; i++)
            fprintf(f, "%g ", (double)surface_model_face(6 * piece + i));
        fprintf(f, "</DataArray></CellData>\n<Points><DataArray type=\"Float32\" "
                   "NumberOfComponents=\"3\" format=\"ascii\">\n");
        text_points(f);
        fprintf(f, "</DataArray></Points>\n<Polys><DataArray type=\"Int32\" "
                   "Name=\"connectivity\" format=\"ascii\">\n");
        for (uint32_t i = 6 * piece; i < 6 * piece + 6; i++)
            fprintf(f, "%u %u %u ", surface_model_triangles[i][0], surface_model_triangles[i][1],
                    surface_model_triangles[i][2]);
        fprintf(f, "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" "
                   "format=\"ascii\">3 6 9 12 15 18</DataArray></Polys></Piece>\n");
    }
    fprintf(f, "</PolyData></VTKFile>\n");
}

static void vtp_array(FILE *f, const char *type, const char *name, int components, int *at,
                      int size) {
    fprintf(f,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" "
            "offset=\"%d\"/>\n",
            type, name, components, *at);
    *at += 4 + size;
}

static void vtp_appended(FILE *f) {
    int at = 0;
    fprintf(f,
            "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\"><PolyData>"
            "<Piece NumberOfPoints=\"%d\" NumberOfPolys=\"%d\">\n<Points>",
            POINTS, TRIANGLES);
    vtp_array(f, "Float32", "Points", 3, &at, 12 * POINTS);
    fprintf(f, "</Points><Polys>");
    vtp_array(f, "Int32", "connectivity", 1, &at, 12 * TRIANGLES);
    vtp_array(f, "UInt8", "offsets", 1, &at, TRIANGLES);
    fprintf(f, "</Polys><PointData>");
    vtp_array(f, "Float32", "heat", 1, &at, 4 * POINTS);
    fprintf(f, "</PointData></Piece></PolyData><AppendedData encoding=\"raw\">\n_");
    put(f, 12 * POINTS, 4);
    put_points(f);
    put(f, 12 * TRIANGLES, 4);
    for (int i = 0; i < 3 * TRIANGLES; i++)
        put(f, surface_model_triangles[i / 3][i % 3], 4);
    put(f, TRIANGLES, 4);
    for (int i = 1; i <= TRIANGLES; i++)
        put(f, (uint64_t)(3 * i), 1);
    put(f, 4 * POINTS, 4);
    for (uint32_t i = 0; i < POINTS; i++)
        put_float(f, surface_model_value(i));
    fprintf(f, "</AppendedData></VTKFile>\n");
}

/* ---- glTF ---- */

/* The cube scaled by 1/2, which its node undoes. */
static const char gltf_json[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[1]}],"
    "\"nodes\":[{\"mesh\":0,\"scale\":[2,2,2],\"translation\":[-1,0,0]},"
    "{\"children\":[0],\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,1,0,0,1]}],"
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1},\"indices\":2}]}],"
    "\"accessors\":["
    "{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"},"
    "{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5121,\"normalized\":true,\"count\":8,"
    "\"type\":\"VEC4\"},"
    "{\"bufferView\":1,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":128,\"byteStride\":16},"
    "{\"buffer\":0,\"byteOffset\":128,\"byteLength\":72}],"
    "\"buffers\":[{%s\"byteLength\":200}]}";

static void gltf_bytes(FILE *f) {
    for (uint32_t i = 0; i < POINTS; i++) {
        for (int a = 0; a < 3; a++)
            put_float(f, surface_model_xyz[i][a] / 2);
        for (int c = 0; c < 4; c++)
            put(f, c < 3 ? byte(i, c) : 255, 1);
    }
    for (int i = 0; i < 3 * TRIANGLES; i++)
        put(f, surface_model_triangles[i / 3][i % 3], 2);
}

static void glb(FILE *f) {
    char json[2000];
    const int length = snprintf(json, sizeof json, gltf_json, "");
    const uint64_t padded = ((uint64_t)length + 3) / 4 * 4;
    fprintf(f, "glTF");
    put(f, 2, 4);
    put(f, 12 + 8 + padded + 8 + 200, 4);
    put(f, padded, 4);
    fprintf(f, "JSON%-*s", (int)padded, json);
    put(f, 200, 4);
    fwrite("BIN", 1, 4, f);
    gltf_bytes(f);
}

static void gltf(FILE *f) {
    FILE *bytes = fopen(scratch_path("cu be.bin"), "wb");
    assert_non_null(bytes);
    gltf_bytes(bytes);
    fclose(bytes);
    fprintf(f, gltf_json, "\"uri\":\"cu%20be.bin\",");
}

/* ---- all of them ---- */

const surface_model_form surface_model_forms[] = {
    {"a.ply", "PLY", true, true, true, false, true, "heat", "part", "rgb"},
    {"b.ply", "PLY", true, true, true, false, true, "heat", "part", "rgb"},
    {"c.ply", "PLY", true, true, true, false, true, "heat", "part", "rgb"},
    {"d.ply", "PLY", true, false, true, false, true, "heat", NULL, "rgb"},
    {"a.stl", "STL", false, false, false, true, true, NULL, NULL, NULL},
    {"b.stl", "STL", false, false, false, true, true, NULL, NULL, NULL},
    {"a.obj", "OBJ", false, false, true, false, true, NULL, NULL, "rgb"},
    {"a.off", "OFF", false, false, true, false, true, NULL, NULL, "rgb"},
    {"a.vtk", "VTK surface", true, true, true, false, false, "heat", "part", "paint"},
    {"b.vtk", "VTK surface", true, true, true, false, false, "heat", "part", "paint"},
    {"c.vtk", "VTK surface", true, false, true, false, false, "heat", NULL, "paint"},
    {"a.vtp", "VTP", true, true, true, false, false, "heat", "part", "paint"},
    {"b.vtp", "VTP", true, false, false, false, false, "heat", NULL, NULL},
    {"a.glb", "glTF binary", false, false, true, false, false, NULL, NULL, "rgb"},
    {"a.gltf", "glTF", false, false, true, false, false, NULL, NULL, "rgb"},
    {.name = NULL}};

static void (*const writers[])(FILE *f) = {
    ply_text, ply_binary, ply_big,    ply_strips, stl_binary,   stl_text, obj_text, off_text,
    vtk_text, vtk_text_5, vtk_binary, vtp_text,   vtp_appended, glb,      gltf};

_Static_assert(sizeof writers / sizeof *writers + 1 ==
                   sizeof surface_model_forms / sizeof *surface_model_forms,
               "a writer of each");

const char *surface_model_write(const surface_model_form *form) {
    const char *path = scratch_path(form->name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    writers[form - surface_model_forms](f);
    assert_int_equal(fclose(f), 0);
    return path;
}
