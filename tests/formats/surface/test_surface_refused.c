/* test_surface_refused.c - surfaces with mistakes: what is left out is counted, what is wrong is
 * refused with its place; polygons, strips and nodes that are rarely seen.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/scratch.h"
#include "tests/support/surface_files.h"

static void refused(const char *name, const char *text, status st, const char *said) {
    surface_files_refused(scratch_text(name, text), NULL, st, said);
}

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define PLY(vertices, faces)                                                         \
    "ply\nformat ascii 1.0\nelement vertex " vertices "\n" XYZ "element face " faces \
    "\nproperty list uchar int vertex_indices\nend_header\n"
#define SQUARE "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"

static void test_ply(void **state) {
    (void)state;
    refused("a.ply", "plx\n", ST_CORRUPT, "a.ply: line 1: \"plx\", expected ply");
    refused("a.ply", "ply\nformat ascii 2.0\n", ST_CORRUPT, "line 2: \"2.0\", expected 1.0");
    refused("a.ply", "ply\nformat words 1.0\n", ST_CORRUPT, "expected ascii, binary_little");
    refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n", ST_CORRUPT,
            "expected vertices with properties x, y and z");
    refused("a.ply", "ply\nformat ascii 1.0\nproperty float x\n", ST_CORRUPT,
            "expected an element before its properties");
    refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n", ST_CORRUPT,
            "\"real\", expected a type of PLY");
    refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 0\n" XYZ "element face 1\nend_header\n",
            ST_CORRUPT, "faces without a list vertex_indices");
    refused("a.ply",
            "ply\nformat ascii 1.0\nelement vertex 0\n" XYZ
            "element face 1\nproperty list float int vertex_indices\nend_header\n",
            ST_CORRUPT, "expected a count of whole numbers");
    refused("a.ply", PLY("4294967296", "0"), ST_CORRUPT,
            "the header says 4294967296 of \"vertex\", of 6 bytes or more each, but only 0 bytes");
    refused("a.ply", PLY("1", "0") "0 0    \n", ST_CORRUPT, "nothing more here, expected a number");
    refused("a.ply", PLY("1", "0") "0 0 1e39\n", ST_CORRUPT, "point 0 (counted from 0) lies at");
    refused("a.ply", PLY("1", "0") "0 0 1 7\n", ST_CORRUPT, "\"7\", expected the end");
    refused("a.ply", PLY("4", "1") SQUARE "-1 0 1\n", ST_CORRUPT,
            "a list of -1, expected a whole number");
    refused("a.ply",
            "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" XYZ
            "end_header\n12345678901",
            ST_CORRUPT, "says 1 of \"vertex\", of 12 bytes or more each, but only 11 bytes");
    const surface_copy *a =
        surface_files_good(scratch_text("a.ply", PLY("4", "6") SQUARE
                                        "3 0 1 2\n3 0 1 4\n3 -1 1 2\n3 0 1 1\n2 0 1\n4 0 1 2 3\n"),
                           NULL);
    assert_int_equal(a->report.tets, 3);
    assert_int_equal(a->report.bad_indices, 2);
    assert_int_equal(a->report.repeated, 1);
    assert_int_equal(a->report.skipped, 1);
    assert_int_equal(a->report.polygons, 1);
    assert_int_equal(a->report.fanned, 0);
    /* Half a vertex is none; half a corner is no count. */
    a = surface_files_good(scratch_text("a.ply", PLY("4", "2") SQUARE "3 0 1 2\n3 0 1.5 2\n"),
                           NULL);
    assert_int_equal(a->report.tets, 1);
    assert_int_equal(a->report.bad_indices, 1);
    refused("a.ply", PLY("4", "1") SQUARE "3.5 0 1 2 3\n", ST_CORRUPT, "a list of 3.5, expected");
    /* A strip behind faces with values has none. */
    a = surface_files_good(
        scratch_text("a.ply", "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ
                              "element face 1\nproperty float q\n"
                              "property list uchar int vertex_indices\nelement tristrips 1\n"
                              "property list int int vertex_indices\nend_header\n" SQUARE
                              "7 3 0 1 2\n4 0 1 3 2\n"),
        NULL);
    assert_int_equal(a->report.tets, 3);
    assert_true(a->values[0][0] == 7.0F && isnan(a->values[0][3]) && isnan(a->values[0][8]));
}

static void test_stl(void **state) {
    (void)state;
    char bytes[200] = "binary";
    refused("a.stl", "solid a\nfacet normal 0 0\n", ST_CORRUPT, "expected a number of the normal");
    refused("a.stl", "solid a\nfacets\n", ST_CORRUPT, "line 2: \"facets\", expected \"facet\" or");
    refused("a.stl", "solid a\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 endloop",
            ST_CORRUPT, "line 2: \"endloop\", expected \"vertex\"");
    refused("a.stl", "solid a\nendsolid a\nsolids", ST_CORRUPT, "expected \"solid\" or the end");
    refused("a.stl", "tiny", ST_CORRUPT, "ends at byte 4, expected a header of 84 bytes");
    bytes[80] = 3;
    surface_files_refused(scratch_write("a.stl", bytes, 84 + 100), NULL, ST_CORRUPT,
                          "says 3 triangles of 50 bytes, but only 100 bytes follow");
    bytes[80] = 1;
    surface_files_refused(scratch_write("a.stl", bytes, 84 + 60), NULL, ST_CORRUPT,
                          "more bytes at 134, expected the end behind 1 triangles");
}

static void test_obj(void **state) {
    (void)state;
    refused("a.obj", "# nothing\n", ST_CORRUPT, "a.obj: ends at line 1, expected vertices");
    refused("a.obj", "f 1 2 3\n", ST_CORRUPT, "line 1: a face, expected a vertex before");
    refused("a.obj", "v 0 0\n", ST_CORRUPT, "line 1: 2 numbers of a vertex");
    refused("a.obj", "v 0 0 0 1 1\n", ST_CORRUPT, "line 1: 5 numbers of a vertex");
    refused("a.obj", "v 0 zero 0\n", ST_CORRUPT, "line 1: \"zero\", expected v and 3 numbers");
    refused("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", ST_CORRUPT, "line 3: a face of 2 corners");
    refused("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 x\n", ST_CORRUPT,
            "line 3: \"x\", expected the number");
    refused("a.obj", "v 0 0 0\nf 1/a 2 3\n", ST_CORRUPT, "line 2: \"1/a\", expected the number");
    refused("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\nf 1 2 4\nv 0 1 0\n", ST_CORRUPT,
            "a.obj: line 4: a face of vertex 4, but there are 3");
    /* Forward references, a weight, numbers that count back too far, points and lines. */
    const surface_copy *a = surface_files_good(
        scratch_text("a.obj", "\nv 0 0 0 0.5\nf 1 2 3\nf -1 -2 -3\nv 1 0 0\nv 0 1 0\nf 3 2 1\n"
                              "f 1 1 2\nf 0 1 2\np 1 2\nl 1 \\\n2\\\n3\ncstype bezier\n"),
        NULL);
    assert_int_equal(a->report.points, 3);
    assert_int_equal(a->report.tets, 2);
    assert_int_equal(a->report.bad_indices, 2);
    assert_int_equal(a->report.repeated, 1);
    assert_int_equal(a->report.skipped, 2);
    /* A colour behind a weight; a vertex without one; rounding to bytes. */
    a = surface_files_good(scratch_text("a.obj", "v 0 0 0 1 0.5 0.25 2\nv 1 0 0\nv 0 1 0 0 0 1\n"
                                                 "f 1 2 3"),
                           NULL);
    assert_string_equal(a->report.field, "rgb");
    assert_true(a->values[0][0] == 128 * 65536 + 64 * 256 + 255 && a->values[0][1] == 0xffffff);
    assert_true(a->values[0][2] == 255);
    const char *const twice[] = {"rgb", "rgb"};
    assert_int_equal(surface_files_read(scratch_path("a.obj"), NULL, twice, 2, &a), ST_UNSUPPORTED);
}

static void test_off(void **state) {
    (void)state;
    refused("a.off", "OFF BINARY\n", ST_UNSUPPORTED, "binary OFF, expected OFF in text");
    refused("a.off", "4OFF\n1 0 0\n", ST_UNSUPPORTED, "4OFF, of other dimensions");
    refused("a.off", "FOO\n", ST_CORRUPT, "line 1: \"FOO\", expected OFF, COFF");
    refused("a.off", "OFF\n-1 0 0\n", ST_CORRUPT, "\"-1\", expected the number of vertices");
    refused("a.off", "OFF\n1000000 0 0\n", ST_CORRUPT,
            "says 1000000 vertices and 0 faces, but only");
    refused("a.off", "OFF\n1 0 0\n0 0\n  ", ST_CORRUPT, "expected a coordinate");
    refused("a.off", "COFF\n1 0 0\n0 0 0 1 1\n", ST_CORRUPT, "expected a number of a colour");
    refused("a.off", "NOFF\n1 0 0\n0 0 0 1 1\n", ST_CORRUPT, "expected a number of a normal");
    refused("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", ST_CORRUPT,
            "expected the number of a vertex");
    const surface_copy *a = surface_files_good(
        scratch_text("a.off", "STCNOFF 3 2 0\n0 0 0  0 0 1  1.0 0 0 1  0 0\n"
                              "1 0 0  0 0 1  0. 1 0 1  0 0\n"
                              "0 1 0  0 0 1  0 0 0.5 1  0 0\n3 0 1 2 7\n3 0 1 3\n"),
        NULL);
    assert_int_equal(a->report.tets, 1);
    assert_int_equal(a->report.bad_indices, 1);
    assert_true(a->values[0][0] == 255 * 65536 && a->values[0][1] == 255 * 256);
    assert_true(a->values[0][2] == 128);
}

#define VTK        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n"
#define VTK_SQUARE VTK "POINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 0\n"

static void test_vtk(void **state) {
    (void)state;
    refused("a.vtk", VTK, ST_CORRUPT, "without POINTS");
    refused("a.vtk", VTK_SQUARE "CELLS 1 4\n3 0 1 2\n", ST_CORRUPT,
            "\"CELLS\", expected a keyword");
    refused("a.vtk", VTK_SQUARE "POLYGONS 1\n", ST_CORRUPT, "expected \"POLYGONS n size\"");
    refused("a.vtk", VTK_SQUARE "POLYGONS 1 4\n3 0 1 2\nPOLYGONS 1 4\n3 0 1 2\n", ST_CORRUPT,
            "POLYGONS comes twice");
    refused("a.vtk", VTK_SQUARE "POLYGONS 1 5\n3 0 1 2 3\n", ST_CORRUPT,
            "POLYGONS: 5 numbers, but its cells have 4");
    refused("a.vtk", VTK_SQUARE "POLYGONS 2 4\n3 0 1 2\n", ST_CORRUPT, "a.vtk: byte");
    refused("a.vtk", VTK_SQUARE "POLYGONS 1 4\n3 0 1 2\nCELL_DATA 2\n", ST_CORRUPT,
            "CELL_DATA of 2, expected 1");
    /* Vertices and lines come first, in the data of cells, too. */
    const char *path = scratch_text(
        "a.vtk", VTK_SQUARE "VERTICES 1 2\n1 0\nLINES 2 6\n2 0 1\n2 1 2\nPOLYGONS 2 9\n4 0 1 2 3\n"
                            "3 0 1 4\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\nCELL_DATA 6\n"
                            "SCALARS part int\nLOOKUP_TABLE default\n0 1 2 30 40 50\n"
                            "FIELD f 1\nvtkGhostType 1 6 unsigned_char\n0 0 0 0 0 0\n");
    const surface_copy *a = surface_files_good(path, NULL);
    assert_string_equal(a->report.field, "part");
    assert_int_equal(a->report.tets, 4);
    assert_int_equal(a->report.points, 12);
    assert_int_equal(a->report.skipped, 3);
    assert_int_equal(a->report.bad_indices, 1);
    assert_int_equal(a->report.polygons, 1);
    assert_true(a->values[0][a->triangles[1][0]] == 30 && a->values[0][a->triangles[3][2]] == 50);
    /* Cells of other parts, and hidden ones. */
    path = scratch_text("a.vtk", VTK_SQUARE
                        "POLYGONS 3 12\n3 0 1 2\n3 0 2 3\n3 0 1 3\nCELL_DATA 3\nFIELD f 1\n"
                        "vtkGhostType 1 3 unsigned_char\n1 0 32\n");
    a = surface_files_good(path, NULL);
    assert_int_equal(a->report.ghosts, 2);
    assert_int_equal(a->report.tets, 1);
    assert_string_equal(a->report.field, "");
    assert_int_equal(a->triangles[0][1], 2);
    /* A vector is taken if asked for. */
    path = scratch_text("a.vtk", VTK_SQUARE "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 4\n"
                                            "VECTORS v float\n3 4 0 0 0 0 1 2 2 0 0 0\n");
    assert_string_equal(surface_files_good(path, NULL)->report.field, "");
    a = surface_files_good(path, &(mesh_hints){.field = "v"});
    assert_true(a->values[0][0] == 5 && a->values[0][2] == 3);
    a = surface_files_good(path, &(mesh_hints){.component = 2});
    assert_true(a->values[0][0] == 4 && a->values[0][2] == 2);
    surface_files_refused(path, &(mesh_hints){.field = "v", .component = 4}, ST_USAGE,
                          "has no component 4");
    surface_files_refused(path, &(mesh_hints){.step = 1}, ST_USAGE, "no step 1");
}

static void test_vtp(void **state) {
    (void)state;
    static const char head[] = "<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='3' "
                               "NumberOfPolys='1'>";
    char text[1000];
    refused("a.vtp", "<VTKFile type='PolyData'><PolyData/></VTKFile>", ST_CORRUPT,
            "expected a Piece in PolyData");
    refused("a.vtp", "nonsense", ST_CORRUPT, "line 1");
    refused("a.vtp", "<VTKFile type='PolyData'><PolyData><Piece NumberOfPolys='1'/>", ST_CORRUPT,
            "expected the attribute NumberOfPoints");
    snprintf(text, sizeof text, "%s</Piece></PolyData></VTKFile>", head);
    refused("a.vtp", text, ST_CORRUPT, "expected the offsets of its cells");
    snprintf(text, sizeof text,
             "%s<Polys><DataArray type='Int8' Name='offsets' format='ascii'>3</DataArray></Polys>"
             "</Piece></PolyData></VTKFile>",
             head);
    refused("a.vtp", text, ST_CORRUPT, "expected the ids of its polygons");
    snprintf(text, sizeof text,
             "%s<Polys><DataArray type='Int8' Name='offsets' format='ascii'>3</DataArray>"
             "<DataArray type='Int8' Name='connectivity' format='ascii'>0 1 2</DataArray></Polys>"
             "</Piece></PolyData></VTKFile>",
             head);
    refused("a.vtp", text, ST_CORRUPT, "expected the positions of 3 points");
}

/* ---- glTF ---- */

/* Write a .glb of this JSON and bytes. */
static const char *write_glb(const char *json, const void *bin, uint32_t size) {
    static char file[8192];
    const uint32_t length = (uint32_t)strlen(json);
    uint32_t head[5] = {0x46546c67, 2, 28 + length + size, length, 0x4e4f534a};
    const uint32_t chunk[2] = {size, 0x004e4942};
    memcpy(file, head, 20);
    memcpy(file + 20, json, length);
    memcpy(file + 20 + length, chunk, 8);
    memcpy(file + 28 + length, bin, size);
    return scratch_write("a.glb", file, 28 + length + size);
}

#define ASSET "{\"asset\":{\"version\":\"2.0\"},"
#define SCENE \
    "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}"
#define REST                                                                                  \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}," \
    "{\"bufferView\":1,\"componentType\":5121,\"count\":4,\"type\":\"SCALAR\"}],"             \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,"      \
    "\"byteLength\":4}],\"buffers\":[{\"byteLength\":52}]}"

static const struct {
    float xyz[4][3];
    uint8_t ids[4];
} square = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {0, 1, 2, 3}};

static void glb_refused(const char *json, status st, const char *said) {
    surface_files_refused(write_glb(json, &square, sizeof square), NULL, st, said);
}

static void test_gltf(void **state) {
    (void)state;
    refused("a.glb", "glTF", ST_CORRUPT, "byte 12: expected a chunk of JSON");
    glb_refused("{", ST_CORRUPT, "JSON: line 1");
    glb_refused("[]", ST_CORRUPT, "expected an object");
    glb_refused("{}", ST_CORRUPT, "expected an \"asset\"");
    glb_refused("{\"asset\":{\"version\":\"1.0\"}}", ST_UNSUPPORTED, "glTF 1.0, expected 2.0");
    glb_refused(ASSET "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}", ST_UNSUPPORTED,
                "requires KHR_draco_mesh_compression");
    glb_refused(ASSET "\"buffers\":[{\"byteLength\":4,\"uri\":\"x.bin\"}]}", ST_UNSUPPORTED,
                "a .glb with a buffer outside of it, \"x.bin\"");
    glb_refused(ASSET "\"buffers\":[{\"byteLength\":53}]}", ST_CORRUPT,
                "buffer 0 of 53 bytes, but the BIN chunk has 52");
    glb_refused(ASSET
                "\"nodes\":[{\"children\":[1]},{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]}",
                ST_CORRUPT, "node 0: expected one of 2 nodes, each at most once");
    glb_refused(ASSET SCENE ",\"indices\":7}]}]," REST, ST_CORRUPT,
                "\"indices\": number 7 of \"accessors\", which has 2");
    glb_refused(ASSET SCENE ",\"mode\":7}]}]," REST, ST_CORRUPT, "a whole number in 0 .. 6");
    glb_refused(ASSET SCENE "}]}]," REST, ST_CORRUPT, "triangles of 4 corners");
    glb_refused(ASSET SCENE ",\"mode\":5}]}],\"accessors\":[{\"sparse\":{}}]}", ST_UNSUPPORTED,
                "\"POSITION\" is a sparse accessor");
    glb_refused(ASSET SCENE
                "}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":"
                "\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}],\"buffers\":[{"
                "\"byteLength\":52}]}",
                ST_CORRUPT, "5 elements from byte 0 on, expected them in a bufferView of 48 bytes");
    surface_files_refused(
        scratch_text("a.gltf", ASSET "\"buffers\":[{\"byteLength\":4,\"uri\":\"data:,abcd\"}]}"),
        NULL, ST_UNSUPPORTED, "a buffer as a data: URI");
    surface_files_refused(
        scratch_text("a.gltf", ASSET "\"buffers\":[{\"byteLength\":4,\"uri\":\"/etc/passwd\"}]}"),
        NULL, ST_UNSUPPORTED, "passwd");
}

static void check_ids(const surface_copy *a, const uint32_t (*want)[3], size_t count) {
    assert_int_equal(a->report.tets, count);
    assert_memory_equal(a->triangles, want, count * sizeof *want);
}

static void test_gltf_modes(void **state) {
    (void)state;
    static const uint32_t strip[2][3] = {{0, 1, 2}, {2, 1, 3}}, fan[2][3] = {{0, 1, 2}, {0, 2, 3}},
                          turned[2][3] = {{0, 2, 1}, {2, 3, 1}};
    const surface_copy *a = surface_files_good(
        write_glb(ASSET SCENE ",\"mode\":5,\"indices\":1}]}]," REST, &square, sizeof square), NULL);
    check_ids(a, strip, 2);
    a = surface_files_good(write_glb(ASSET SCENE ",\"mode\":6}]}]," REST, &square, sizeof square),
                           NULL);
    check_ids(a, fan, 2);
    a = surface_files_good(write_glb(ASSET SCENE ",\"mode\":1}]}]," REST, &square, sizeof square),
                           NULL);
    assert_int_equal(a->report.skipped, 2);
    assert_int_equal(a->report.tets, 0);
    /* Mirrored: the triangles turn, so that their front stays in front. A quarter turn about z. */
    a = surface_files_good(
        write_glb(ASSET "\"nodes\":[{\"mesh\":0,\"scale\":[-2,1,1],\"rotation\":[0,0,"
                        "0.70710678118654752,0.70710678118654752]}],\"meshes\":[{\"primitives\":[{"
                        "\"attributes\":{\"POSITION\":0},\"mode\":5}]}]," REST,
                  &square, sizeof square),
        NULL);
    check_ids(a, turned, 2);
    assert_true(fabsf(a->xyz[1][0]) < 1e-6f && fabsf(a->xyz[1][1] + 2) < 1e-6f);
    assert_true(fabsf(a->xyz[2][0] + 1) < 1e-6f && fabsf(a->xyz[2][1]) < 1e-6f);
}

/* Linear colours become sRGB: 0.5 is 188, and 0.001 is 3. */
static void test_gltf_colours(void **state) {
    (void)state;
    static const struct {
        float xyz[3][3], rgb[3][3];
    } bin = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
             {{1, 0.5f, 0}, {0.001f, 2, -1}, {0, 0, 0.2140411f}}};
    const char *path = write_glb(
        ASSET
        "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
        "\"COLOR_0\":1}},{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":0,"
        "\"byteOffset\":36,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":72}],\"buffers\":[{\"byteLength\":72}]}",
        &bin, sizeof bin);
    const surface_copy *a = surface_files_good(path, NULL);
    assert_int_equal(a->report.points, 6);
    assert_int_equal(a->triangles[1][0], 3);
    assert_true(a->values[0][0] == 255 * 65536 + 188 * 256);
    assert_true(a->values[0][1] == 3 * 65536 + 255 * 256);
    assert_true(a->values[0][2] == 127 || a->values[0][2] == 128);
    assert_true(a->values[0][5] == 0xffffff); /* white */
}

/* ---- polygons ---- */

static double area(const surface_copy *a, size_t i) {
    const float *p = a->xyz[a->triangles[i][0]], *q = a->xyz[a->triangles[i][1]],
                *r = a->xyz[a->triangles[i][2]];
    return ((double)(q[0] - p[0]) * (double)(r[1] - p[1]) -
            (double)(q[1] - p[1]) * (double)(r[0] - p[0])) /
           2;
}

/* A concave polygon: triangles that turn as it does and cover its area once; a fan would not. */
static void check_comb(const surface_copy *a, size_t triangles, double want) {
    double sum = 0;
    assert_int_equal(a->report.tets, triangles);
    for (size_t i = 0; i < triangles; i++) {
        assert_true(area(a, i) > 0);
        sum += area(a, i);
    }
    assert_true(fabs(sum - want) < 1e-5);
}

static void test_concave(void **state) {
    (void)state;
    /* A comb of three teeth, its first corner where a fan leaves it. */
    static const char *const points =
        "0 0 0\n5 0 0\n5 2 0\n4 2 0\n4 1 0\n3 1 0\n3 2 0\n2 2 0\n2 1 0\n"
        "1 1 0\n1 2 0\n0 2 0\n";
    char text[1000];
    snprintf(text, sizeof text, "OFF\n12 1 0\n%s12 0 1 2 3 4 5 6 7 8 9 10 11\n", points);
    const surface_copy *a = surface_files_good(scratch_text("a.off", text), NULL);
    check_comb(a, 10, 8);
    assert_int_equal(a->report.polygons, 1);
    assert_int_equal(a->report.fanned, 0);
    /* The same where each triangle gets points of its own. */
    snprintf(text, sizeof text,
             "ply\nformat ascii 1.0\nelement vertex 12\n" XYZ
             "element face 1\nproperty list int int vertex_index\nproperty float f\nend_header\n"
             "%s12 0 1 2 3 4 5 6 7 8 9 10 11 7\n",
             points);
    a = surface_files_good(scratch_text("a.ply", text), NULL);
    check_comb(a, 10, 8);
    assert_int_equal(a->report.polygons, 1);
    assert_true(a->values[0][29] == 7);
    /* Corners that come later are not known: a fan, which is told. */
    a = surface_files_good(scratch_text("a.obj", "v 0 0 0\nf 1 2 3 4\nv 2 0 0\nv 2 2 0\nv 0 2 0\n"),
                           NULL);
    assert_int_equal(a->report.tets, 2);
    assert_int_equal(a->report.polygons, 1);
    assert_int_equal(a->report.fanned, 1);
    /* An arrow in another plane, far from the origin. */
    a = surface_files_good(scratch_text("a.obj", "v 9 1000 1000\nv 9 1001 1000.5\nv 9 1002 1000\n"
                                                 "v 9 1001 1003\nf 1 2 3 4\n"),
                           NULL);
    assert_int_equal(a->report.tets, 2);
    for (int i = 0; i < 2; i++) /* the corner that goes inwards is in both */
        assert_true(a->triangles[i][0] == 1 || a->triangles[i][1] == 1 || a->triangles[i][2] == 1);
}

/* Faces before their vertices, and several fields of a pipe, cannot have points of their own. */
static void test_apart(void **state) {
    (void)state;
    refused("a.ply",
            "ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_index\nproperty "
            "float f\nelement vertex 3\n" XYZ "end_header\n3 0 1 2 7\n0 0 0\n1 0 0\n0 1 0\n",
            ST_UNSUPPORTED, "faces in front of the vertices");
    const char *path =
        scratch_text("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ
                              "property uchar flags\nelement face 3\nproperty list int int "
                              "vertex_index\nproperty float f\nproperty uchar red\nproperty uchar "
                              "green\nproperty uchar blue\nend_header\n0 0 0 1\n1 0 0 2\n0 1 0 3\n"
                              "3 0 1 2 7 255 0 1\n3 0 1 3 8 0 0 0\n3 0 1 1 9 0 0 0\n");
    const surface_copy *a = surface_files_good(path, NULL);
    assert_string_equal(a->report.field, "f");
    assert_int_equal(a->report.points, 3);
    assert_int_equal(a->report.bad_indices, 1);
    assert_int_equal(a->report.repeated, 1);
    a = surface_files_good(path, &(mesh_hints){.field = "rgb"});
    assert_true(a->values[0][0] == 255 * 65536 + 1);
    a = surface_files_good(path, &(mesh_hints){.field = "flags"});
    assert_true(a->values[0][2] == 3);
    const char *const names[] = {"f", "flags"};
    assert_int_equal(surface_files_read(path, NULL, names, 2, &a), ST_OK);
    assert_int_equal(a->report.bad_indices, 1);
    assert_true(a->values[0][1] == 7 && a->values[1][1] == 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ply),          cmocka_unit_test(test_stl),
        cmocka_unit_test(test_obj),          cmocka_unit_test(test_off),
        cmocka_unit_test(test_vtk),          cmocka_unit_test(test_vtp),
        cmocka_unit_test(test_gltf),         cmocka_unit_test(test_gltf_modes),
        cmocka_unit_test(test_gltf_colours), cmocka_unit_test(test_concave),
        cmocka_unit_test(test_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
