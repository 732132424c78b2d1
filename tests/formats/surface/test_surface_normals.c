/* test_surface_normals.c - normals of points from files of each format: a corner of a cube, whose
 * three faces have a point each with its own normal, or share points; codes of normals and how far
 * they are off; normals made of triangles.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/triangle_normal.h"
#include "formats/surface/vertex_normals.h"
#include "tests/support/fields.h"
#include "tests/support/scratch.h"
#include "tests/support/surface_files.h"

/* ---- codes ---- */

static double degrees_between(const double a[3], const double b[3]) {
    const double cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                             a[0] * b[1] - a[1] * b[0]};
    const double sine = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
    return atan2(sine, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * 57.29577951308232;
}

/* Directions all about, of any length, come back within 0.004 degrees. */
static void test_codes(void **state) {
    enum { COUNT = 200000 };
    (void)state;
    field_random r = {FIELD_SEED};
    double worst = 0.0, sum = 0.0;
    for (int i = 0; i < COUNT; i++) {
        double n[3], back[3], length = 0.0;
        for (int a = 0; a < 3; a++) {
            n[a] = field_random_in(&r, -1.0, 1.0);
            length += n[a] * n[a];
        }
        length = sqrt(length);
        const double by = ldexp(1.0, i % 1900 - 950);
        const double given[3] = {n[0] * by, n[1] * by, n[2] * by};
        const uint32_t code = triangle_normal_encode(given);
        assert_true(triangle_normal_is_code(code));
        assert_true(triangle_normal_decode(code, back));
        for (int a = 0; a < 3; a++)
            n[a] /= length;
        const double off = degrees_between(n, back);
        worst = off > worst ? off : worst;
        sum += off;
        /* At the rim two codes are one direction. */
        double again[3];
        assert_true(triangle_normal_decode(triangle_normal_encode(back), again));
        assert_memory_equal(back, again, sizeof back);
    }
    print_message("off by %.5f degrees on average, %.5f at most\n", sum / COUNT, worst);
    assert_true(worst < 0.004);
}

static void test_odd_codes(void **state) {
    (void)state;
    const double inf = (double)INFINITY, nan = (double)NAN;
    const double none[][3] = {{0, 0, 0}, {inf, 0, 0}, {0, nan, 1}, {-0.0, 0, -0.0}, {inf, -inf, 1}};
    const double exact[][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const uint32_t odd[] = {0x80008000, 0x80000000, 0x00008000, 0x8000ffff};
    double unit[3] = {7, 7, 7};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        assert_int_equal(triangle_normal_encode(none[i]), TRIANGLE_NO_NORMAL);
    for (size_t i = 0; i < sizeof exact / sizeof *exact; i++) {
        assert_true(triangle_normal_decode(triangle_normal_encode(exact[i]), unit));
        for (int a = 0; a < 3; a++)
            assert_true(unit[a] == exact[i][a]);
    }
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        assert_false(triangle_normal_decode(odd[i], unit));
        assert_true(triangle_normal_is_code(odd[i]) == (i == 0));
    }
    /* Largest denormals, and the largest numbers. */
    assert_true(triangle_normal_decode(triangle_normal_encode((double[3]){0, 5e-324, 0}), unit) &&
                unit[1] == 1.0);
    assert_true(triangle_normal_decode(triangle_normal_encode((double[3]){0, 0, -1e308}), unit) &&
                unit[2] == -1.0);
}

/* ---- files ---- */

static const char *write_text(const char *name, const char *text) {
    return scratch_write(name, text, strlen(text));
}

/* Two triangles at an edge: points 0 to 3; the first in the plane z = 0, the second in y = 0. */
#define PLY_HEAD(more)                                                                             \
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float " \
    "z\n" more
#define PLY_FACES "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
#define VTK_HEAD                                                                                 \
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 " \
    "0 0 1\nPOLYGONS 2 8\n3 0 1 2\n3 0 3 1\nPOINT_DATA 4\n"
#define VTP_HEAD "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData>"
#define VTP_PIECE(data)                                                                            \
    "<Piece NumberOfPoints=\"4\" NumberOfPolys=\"2\">" data                                        \
    "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 " \
    "1 0 0 0 1</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" "        \
    "format=\"ascii\">0 1 2 0 3 1</DataArray><DataArray type=\"Int32\" Name=\"offsets\" "          \
    "format=\"ascii\">3 6</DataArray></Polys></Piece>"
#define VTP_ARRAY(name, numbers)               \
    "<DataArray type=\"Float32\" Name=\"" name \
    "\" NumberOfComponents=\"3\" format=\"ascii\">" numbers "</DataArray>"
#define VTP_TAIL "</PolyData></VTKFile>\n"
#define NUMBERS  "0 0 1 0 3 4 0 0 0 -1 0 0"
#define OBJ_HEAD "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"

typedef struct given {
    const char *name, *text;
    int points;          /* 0: without normals */
    double normal[8][3]; /* of each point */
} given;

#define OF_ALL                                 \
    {                                          \
        {0, 0, 1}, {0, 0.6, 0.8}, {0, 0, 0}, { \
            -1, 0, 0                           \
        }                                      \
    }

static const given files[] = {
    {"a.ply",
     PLY_HEAD("property float nx\nproperty double ny\nproperty float nz\n") PLY_FACES
     "0 0 0 0 0 1\n1 0 0 0 3 4\n0 1 0 0 0 0\n0 0 1 -1 0 0\n3 0 1 2\n3 0 3 1\n",
     4, OF_ALL},
    {"two.ply",
     PLY_HEAD("property float nx\nproperty float ny\n") PLY_FACES
     "0 0 0 0 0\n1 0 0 0 3\n0 1 0 0 0\n0 0 1 -1 0\n3 0 1 2\n3 0 3 1\n",
     0,
     {{0}}},
    {"nan.ply",
     PLY_HEAD("property float nz\nproperty float ny\nproperty float nx\n") PLY_FACES
     "0 0 0 1 0 0\n1 0 0 nan 0 0\n0 1 0 0 inf 0\n0 0 1 0 0 -2\n3 0 1 2\n3 0 3 1\n",
     4,
     {{0, 0, 1}, {0, 0, 0}, {0, 0, 0}, {-1, 0, 0}}},
    {"a.vtk", VTK_HEAD "NORMALS n float\n" NUMBERS "\n", 4, OF_ALL},
    {"b.vtk", VTK_HEAD "VECTORS n float\n" NUMBERS "\n", 0, {{0}}},
    {"c.vtk", VTK_HEAD "VECTORS Normals float\n" NUMBERS "\n", 4, OF_ALL},
    {"a.vtp",
     VTP_HEAD VTP_PIECE("<PointData Normals=\"across\">" VTP_ARRAY(
         "Normals", "1 0 0 1 0 0 1 0 0 1 0 0") VTP_ARRAY("across", NUMBERS) "</PointData>")
         VTP_TAIL,
     4, OF_ALL},
    {"b.vtp",
     VTP_HEAD VTP_PIECE("<PointData>" VTP_ARRAY("Normals", NUMBERS) "</PointData>") VTP_TAIL, 4,
     OF_ALL},
    {"c.vtp",
     VTP_HEAD VTP_PIECE("<CellData></CellData>")
         VTP_PIECE("<PointData>" VTP_ARRAY("Normals", NUMBERS) "</PointData>") VTP_TAIL,
     8,
     {{0}, {0}, {0}, {0}, {0, 0, 1}, {0, 0.6, 0.8}, {0, 0, 0}, {-1, 0, 0}}},
    /* A normal a vertex: points stay. */
    {"a.obj", OBJ_HEAD "vn 0 0 1\nvn 0 3 4\nvn -1 0 0\nf 1//1 2//2 3\nf 1//-3 4/7/3 2//2\n", 4,
     OF_ALL},
    /* Points 4, 5 are vertices 0, 1 with the second normal. */
    {"b.obj",
     OBJ_HEAD "vn 0 0 1\nvn 0 -1 0\nf 1//1 2//1 3//1\nf 1//2 4//2 2//2\n",
     6,
     {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}}},
    /* Another vertex behind these. */
    {"c.obj",
     OBJ_HEAD
     "vn 0 0 1\nvn 0 -1 0\nf 1//1 2//1 3//1\nf 1//2 4//2 2//2\nv 2 0 0\nf 2//1 5//2 -3//1\n",
     7,
     {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}}},
    {"d.obj", OBJ_HEAD "f 1 2 3\nf 1 4 2\n", 0, {{0}}},
    {"e.obj",
     OBJ_HEAD "f 1 2 3\nvn 0 0 1\nf 1 4//1 2\n",
     4,
     {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 1}}},
    {"a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 3 1\n", 0, {{0}}},
};

static void check(const given *f, const surface_copy *a) {
    assert_int_equal(a->report.normals, f->points);
    for (int i = 0; i < f->points; i++) {
        double unit[3] = {0, 0, 0};
        (void)triangle_normal_decode(a->normals[i], unit);
        for (int k = 0; k < 3; k++)
            if (fabs(unit[k] - f->normal[i][k]) > 1e-4)
                fail_msg("%s: point %d: normal %g %g %g", f->name, i, unit[0], unit[1], unit[2]);
    }
}

static void test_files(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const char *path = write_text(files[i].name, files[i].text);
        surface_files_take_normals(true);
        check(&files[i], surface_files_good(path, NULL));
        surface_files_damage(path, NULL);
        surface_files_faults(path, NULL);
        surface_files_take_normals(false);
        const surface_copy *a = surface_files_good(path, NULL);
        assert_int_equal(a->report.normals, 0);
        assert_true(a->report.points <= (strcmp(files[i].name, "c.vtp") == 0 ? 8 : 5));
    }
}

/* Points of OBJ that stand for a vertex lie where it does, and triangles stay where they are. */
static void test_places(void **state) {
    (void)state;
    static const uint32_t want[3][3] = {{0, 1, 2}, {4, 3, 5}, {1, 6, 2}};
    const given *f = &files[11];
    assert_string_equal(f->name, "c.obj");
    surface_files_take_normals(true);
    const surface_copy *a = surface_files_good(write_text(f->name, f->text), NULL);
    assert_memory_equal(a->xyz[4], a->xyz[0], sizeof *a->xyz);
    assert_memory_equal(a->xyz[5], a->xyz[1], sizeof *a->xyz);
    assert_true(a->xyz[6][0] == 2.0f);
    assert_int_equal(a->report.tets, 3);
    assert_memory_equal(a->triangles, want, sizeof want);
    surface_files_take_normals(false);
}

/* Colours of points that were added. */
static void test_coloured(void **state) {
    (void)state;
    surface_files_take_normals(true);
    const surface_copy *a = surface_files_good(
        write_text("col.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvn 0 0 1\nvn 1 0 0\n"
                              "f 1//1 2//1 3//1\nf 1//2 3//2 2//2\n"),
        NULL);
    assert_int_equal(a->report.points, 6);
    for (int i = 0; i < 3; i++)
        assert_true(a->values[0][a->triangles[1][i]] ==
                    a->values[0][a->triangles[0][i == 0 ? 0 : 3 - i]]);
    surface_files_take_normals(false);
}

/* Each triangle has points of its own where a field of the faces is taken: with their normals. */
static void test_apart(void **state) {
    (void)state;
    const char *text = PLY_HEAD(
        "property float nx\nproperty float ny\nproperty float nz\n") "element face 2\nproperty "
                                                                     "float part\nproperty list "
                                                                     "uchar int "
                                                                     "vertex_indices\nend_header\n"
                                                                     "0 0 0 0 0 1\n1 0 0 0 3 4\n0 "
                                                                     "1 0 0 0 0\n0 0 1 -1 0 0\n5 3 "
                                                                     "0 1 2\n6 3 0 3 1\n";
    static const int of[6] = {0, 1, 2, 0, 3, 1};
    surface_files_take_normals(true);
    const surface_copy *a =
        surface_files_good(write_text("apart.ply", text), &(mesh_hints){.field = "part"});
    assert_int_equal(a->report.normals, 6);
    for (int i = 0; i < 6; i++) {
        double unit[3] = {0, 0, 0};
        (void)triangle_normal_decode(a->normals[i], unit);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(unit[k] - files[0].normal[of[i]][k]) < 1e-4);
    }
    surface_files_take_normals(false);
}

static void test_refused(void **state) {
    static const struct {
        const char *name, *text, *said;
    } bad[] = {
        {"a.obj", OBJ_HEAD "vn 0 0\nf 1//1 2//1 3//1\n", "line 5: \"\", expected vn and 3 numbers"},
        {"a.obj", OBJ_HEAD "vn 0 0 x\nf 1 2 3\n", "line 5: \"x\", expected vn"},
        {"a.obj", OBJ_HEAD "vn 0 0 1\nf 1//1 2//2 3//1\n",
         "line 6: normal 2 of a face, expected one of 1"},
        {"a.obj", OBJ_HEAD "vn 0 0 1\nf 1//1 2//-2 3//1\n", "line 6: normal -2"},
        {"a.obj", OBJ_HEAD "vn 0 0 1\nf 1//1 2//1 5//1\nv 1 1 1\n",
         "line 6: a face of vertex 5 of 4 so far"},
    };
    (void)state;
    surface_files_take_normals(true);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        surface_files_refused(write_text(bad[i].name, bad[i].text), NULL, ST_CORRUPT, bad[i].said);
    surface_files_take_normals(false);
}

/* ---- glTF: by the inverse transpose ---- */

static const char *write_gltf(const char *node, const char *normal) {
    static const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1};
    char text[1200];
    scratch_write("n.bin", (const char *)numbers, sizeof numbers);
    snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0,%s}],\"meshes\":[{"
        "\"primitives\":[{\"attributes\":{\"POSITION\":0%s}}]}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,"
        "\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,"
        "\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":36}],\"buffers\":[{"
        "\"uri\":\"n.bin\",\"byteLength\":72}]}",
        node, normal);
    return write_text("n.gltf", text);
}

static void test_placed(void **state) {
    static const struct {
        const char *node;
        double first[3]; /* 1 1 0, which lies across 1 -1 0 */
    } placed[] = {
        {"\"scale\":[1,1,1]", {1, 1, 0}},
        {"\"scale\":[2,1,1]", {0.5, 1, 0}},
        {"\"scale\":[-2,1,3]", {-0.5, 1, 0}},
        {"\"scale\":[-1,-1,-1]", {-1, -1, 0}},
        {"\"rotation\":[0,0,0.70710678118654752,0.70710678118654752]", {-1, 1, 0}},
        {"\"matrix\":[1,0,0,0,1,1,0,0,0,0,1,0,5,6,7,1]", {1, 0, 0}},
    };
    (void)state;
    surface_files_take_normals(true);
    for (size_t i = 0; i < sizeof placed / sizeof *placed; i++) {
        const surface_copy *a =
            surface_files_good(write_gltf(placed[i].node, ",\"NORMAL\":1"), NULL);
        double unit[3], want[3], length = 0;
        assert_int_equal(a->report.normals, 3);
        assert_true(triangle_normal_decode(a->normals[0], unit));
        for (int k = 0; k < 3; k++)
            length += placed[i].first[k] * placed[i].first[k];
        for (int k = 0; k < 3; k++)
            want[k] = placed[i].first[k] / sqrt(length);
        if (degrees_between(unit, want) > 0.01)
            fail_msg("%s: %g %g %g", placed[i].node, unit[0], unit[1], unit[2]);
    }
    assert_int_equal(surface_files_good(write_gltf("\"scale\":[1,1,1]", ""), NULL)->report.normals,
                     0);
    surface_files_refused(write_gltf("\"scale\":[1,1,1]", ",\"NORMAL\":2"), NULL, ST_CORRUPT,
                          "NORMAL of 2 vertices, expected 3");
    surface_files_take_normals(false);
}

/* ---- made of triangles ---- */

static void put_quad(vertex_normals *v, const float p[4][3], const size_t numbers[4]) {
    static const int half[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (int h = 0; h < 2; h++) {
        float corner[3][3];
        size_t of[3];
        for (int k = 0; k < 3; k++) {
            memcpy(corner[k], p[half[h][k]], sizeof corner[k]);
            of[k] = numbers[half[h][k]];
        }
        vertex_normals_add(v, (const float(*)[3])corner, of);
    }
}

/* Areas weigh: of a square of side 3 and one of side 1 at an edge; and vertices at one place, one
 * of them at -0, are one, whether a triangle has them or not. */
static void test_made(void **state) {
    (void)state;
    mem m;
    vertex_normals v;
    const float large[4][3] = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}},
                small[4][3] = {{-0.0f, 0, 0}, {0, 0, -1}, {1, 0, -1}, {1, 0, 0}};
    mem_init(&m, 0);
    assert_int_equal(vertex_normals_init(&v, &m, 9), ST_OK);
    assert_true(mem_used(&m) <= vertex_normals_memory(9));
    for (int again = 0; again < 2; again++) {
        vertex_normals_begin(&v);
        for (int i = 0; i < 4; i++)
            vertex_normals_put(&v, large[i]);
        for (int i = 0; i < 4; i++)
            vertex_normals_put(&v, small[i]);
        vertex_normals_put(&v, (const float[3]){9, 9, 9});
        assert_int_equal(v.places, 8);
        put_quad(&v, large, (const size_t[]){0, 1, 2, 3});
        /* The second time, the small one's vertices are not numbered: they are found. */
        const size_t none = SIZE_MAX;
        put_quad(&v, small,
                 again ? (const size_t[]){none, none, none, none} : (const size_t[]){4, 5, 6, 7});
        /* Both triangles of a square have its first corner. The small one looks to -y. */
        double unit[3];
        const double want[3] = {0, -1 / sqrt(82.0), 9 / sqrt(82.0)};
        assert_true(triangle_normal_decode(vertex_normals_code(&v, 0), unit));
        if (degrees_between(unit, want) > 0.01)
            fail_msg("%g %g %g", unit[0], unit[1], unit[2]);
        assert_int_equal(vertex_normals_code(&v, 0), vertex_normals_code(&v, 4));
        assert_true(triangle_normal_decode(vertex_normals_code(&v, 2), unit) && unit[2] == 1.0);
        assert_true(triangle_normal_decode(vertex_normals_code(&v, 6), unit) && unit[1] == -1.0);
        assert_int_equal(vertex_normals_code(&v, 8), TRIANGLE_NO_NORMAL);
    }
    vertex_normals_release(&v);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_codes),    cmocka_unit_test(test_odd_codes),
        cmocka_unit_test(test_files),    cmocka_unit_test(test_places),
        cmocka_unit_test(test_coloured), cmocka_unit_test(test_apart),
        cmocka_unit_test(test_refused),  cmocka_unit_test(test_placed),
        cmocka_unit_test(test_made),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
