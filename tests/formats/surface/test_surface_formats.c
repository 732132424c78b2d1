/* test_surface_formats.c - one model in every format of surfaces: the same triangles, values and
 * colours, from files and pipes, whole and in pieces; files that are cut or damaged; lack of memory
 * and failing reads.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "formats/input_open.h"
#include "formats/surface/surface_input_kind.h"
#include "tests/support/scratch.h"
#include "tests/support/surface_files.h"
#include "tests/support/surface_model.h"

enum { TRIANGLES = SURFACE_MODEL_TRIANGLES };

/* Returns the number of the model's triangle that a triangle is, from whichever corner on. */
static int find_triangle(const surface_copy *a, const uint32_t t[3]) {
    for (int i = 0; i < TRIANGLES; i++)
        for (int from = 0; from < 3; from++) {
            bool same = true;
            for (int c = 0; c < 3; c++)
                same = same && memcmp(a->xyz[t[(c + from) % 3]],
                                      surface_model_xyz[surface_model_triangles[i][c]], 12) == 0;
            if (same)
                return i;
        }
    return -1;
}

static void check_shape(const char *what, const surface_copy *a) {
    if (a->report.tets != TRIANGLES)
        fail_msg("%s: %llu triangles", what, (unsigned long long)a->report.tets);
    for (int i = 0; i < TRIANGLES; i++)
        if (find_triangle(a, a->triangles[i]) != i)
            fail_msg("%s: triangle %d is number %d of the model", what, i,
                     find_triangle(a, a->triangles[i]));
    assert_int_equal(a->report.bad_indices + a->report.repeated + a->report.skipped, 0);
    assert_int_equal(a->report.ghosts + a->report.polygons + a->report.fanned, 0);
}

/* The model's point at a place. */
static uint32_t point_at(const float xyz[3]) {
    uint32_t i = 0;
    while (memcmp(surface_model_xyz[i], xyz, 12) != 0)
        assert_true(++i < SURFACE_MODEL_POINTS);
    return i;
}

static void check_values(const char *what, const surface_copy *a, uint32_t k,
                         float (*value)(uint32_t)) {
    for (size_t i = 0; i < a->report.points; i++)
        if (a->values[k][i] != (value ? value(point_at(a->xyz[i])) : 0))
            fail_msg("%s: the value of point %zu is %g", what, i, (double)a->values[k][i]);
}

static void test_same(void **state) {
    (void)state;
    for (const surface_model_form *f = surface_model_forms; f->name; f++) {
        const surface_copy *a = surface_files_good(surface_model_write(f), NULL);
        check_shape(f->name, a);
        assert_string_equal(a->report.field, f->values ? f->scalar : f->colours ? f->rgb : "");
        check_values(f->name, a, 0,
                     f->values    ? surface_model_value
                     : f->colours ? surface_model_colour
                                  : NULL);
        if (f->apart)
            assert_int_equal(a->report.points, 3 * TRIANGLES);
        else if (strcmp(f->name, "a.vtp") != 0)
            assert_int_equal(a->report.points, SURFACE_MODEL_POINTS);
    }
}

static void test_colours(void **state) {
    (void)state;
    for (const surface_model_form *f = surface_model_forms; f->name; f++)
        if (f->colours) {
            const surface_copy *a =
                surface_files_good(surface_model_write(f), &(mesh_hints){.field = f->rgb});
            check_shape(f->name, a);
            assert_string_equal(a->report.field, f->rgb);
            check_values(f->name, a, 0, surface_model_colour);
        } else if (!f->colours)
            surface_files_refused(surface_model_write(f), &(mesh_hints){.field = "rgb"}, ST_USAGE,
                                  "no field \"rgb\" of the surface");
}

/* Values of faces: three points a triangle, exactly its value. */
static void test_faces(void **state) {
    (void)state;
    for (const surface_model_form *f = surface_model_forms; f->name; f++) {
        if (!f->faces)
            continue;
        const surface_copy *a =
            surface_files_good(surface_model_write(f), &(mesh_hints){.field = f->of_faces});
        check_shape(f->name, a);
        assert_int_equal(a->report.points, 3 * TRIANGLES);
        for (uint32_t i = 0; i < 3 * TRIANGLES; i++)
            assert_true(a->values[0][a->triangles[i / 3][i % 3]] == surface_model_face(i / 3));
    }
}

/* Fields of points, of faces, and colours at once. */
static void test_several(void **state) {
    (void)state;
    for (const surface_model_form *f = surface_model_forms; f->name; f++) {
        const char *const names[] = {f->scalar, f->of_faces, f->rgb};
        const surface_copy *a;
        if (!f->faces)
            continue;
        assert_int_equal(surface_files_read(surface_model_write(f), NULL, names, 3, &a), ST_OK);
        check_shape(f->name, a);
        assert_int_equal(a->report.points, 3 * TRIANGLES);
        check_values(f->name, a, 0, surface_model_value);
        check_values(f->name, a, 2, surface_model_colour);
        for (uint32_t i = 0; i < 3 * TRIANGLES; i++)
            assert_true(a->values[1][a->triangles[i / 3][i % 3]] == surface_model_face(i / 3));
        assert_int_equal(surface_files_read(surface_model_write(f), NULL,
                                            (const char *const[]){f->scalar, f->rgb}, 2, &a),
                         ST_OK);
        check_values(f->name, a, 0, surface_model_value);
        check_values(f->name, a, 1, surface_model_colour);
    }
}

/* The mean of a point's faces, where the user asks for that. */
static void test_averages(void **state) {
    (void)state;
    const mesh_hints averaged = {.cells_to_points = true};
    for (const surface_model_form *f = surface_model_forms; f->name; f++) {
        if (!f->faces) {
            surface_files_refused(surface_model_write(f), &averaged, ST_USAGE,
                                  "no field of numbers of the surface's faces");
            continue;
        }
        const surface_copy *a = surface_files_good(surface_model_write(f), &averaged);
        const uint32_t halves = strcmp(f->name, "a.vtp") == 0 ? 2 : 1;
        check_shape(f->name, a);
        assert_string_equal(a->report.field, f->of_faces);
        assert_int_equal(a->report.points, SURFACE_MODEL_POINTS * halves);
        for (uint32_t p = 0; p < a->report.points; p++) {
            double sum = 0, count = 0;
            for (uint32_t i = 0; i < TRIANGLES; i++)
                for (int c = 0; c < 3; c++)
                    if (a->triangles[i][c] == p) {
                        sum += (double)surface_model_face(i);
                        count++;
                    }
            if (count > 0)
                assert_true(a->values[0][p] == (float)(sum / count));
        }
        surface_files_refused(f->name[0] ? scratch_path(f->name) : "",
                              &(mesh_hints){.cells_to_points = true, .field = f->scalar}, ST_USAGE,
                              "no field \"heat\" of the surface's faces");
    }
}

/* The kind of input that a file is, and its format; opened as convert and info do. */
static void test_recognised(void **state) {
    (void)state;
    for (const surface_model_form *f = surface_model_forms; f->name; f++) {
        mem m;
        input in;
        mem_init(&m, 0);
        assert_int_equal(input_open(&m, surface_model_write(f), NULL, &in), ST_OK);
        assert_true(in.kind == &surface_input_kind);
        assert_string_equal(in.kind->format(in.own), f->format);
        uint64_t points, cells;
        const bool counted = strcmp(f->name, "b.stl") != 0 && strcmp(f->name, "a.obj") != 0;
        assert_true(mesh_input_counts(in.own, &points, &cells) == counted);
        if (counted && !strchr("dc", f->name[0]))
            assert_int_equal(cells, TRIANGLES);
        input_close(&in);
        assert_int_equal(mem_used(&m), 0);
    }
}

static void test_pipes(void **state) {
    (void)state;
    static const size_t pieces[] = {1, 7, 4096};
    for (const surface_model_form *f = surface_model_forms; f->name; f++)
        for (size_t i = 0; f->piped && i < sizeof pieces / sizeof *pieces; i++) {
            const char *path = surface_model_write(f), *dot = strchr(f->name, '.');
            char pipe[32];
            snprintf(pipe, sizeof pipe, "pipe%s", dot);
            check_shape(f->name, surface_files_pipe(path, pipe, pieces[i]));
        }
}

static void test_cut(void **state) {
    (void)state;
    for (const surface_model_form *f = surface_model_forms; f->name; f++) {
        const char *path = surface_model_write(f), *dot = strrchr(f->name, '.');
        /* Text may end within its last number or line; XML within its last tags. */
        if (strcmp(dot, ".obj") != 0 && strcmp(f->name, "b.stl") != 0 && strcmp(dot, ".vtk") != 0 &&
            strcmp(dot, ".off") != 0)
            surface_files_truncate(path, NULL, strcmp(dot, ".vtp") == 0 ? 40 : 2);
    }
}

static void test_damage(void **state) {
    (void)state;
    for (const surface_model_form *f = surface_model_forms; f->name; f++) {
        surface_files_damage(surface_model_write(f), NULL);
        if (f->faces)
            surface_files_damage(surface_model_write(f), &(mesh_hints){.field = f->of_faces});
    }
}

static void test_faults(void **state) {
    (void)state;
    for (const surface_model_form *f = surface_model_forms; f->name; f++) {
        if (strcmp(strrchr(f->name, '.'), ".gltf") == 0 || strcmp(f->name, "a.glb") == 0)
            continue; /* jansson's allocations are its own */
        surface_files_faults(surface_model_write(f), NULL);
        if (f->faces)
            surface_files_faults(surface_model_write(f), &(mesh_hints){.field = f->of_faces});
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same),     cmocka_unit_test(test_colours),
        cmocka_unit_test(test_faces),    cmocka_unit_test(test_several),
        cmocka_unit_test(test_averages), cmocka_unit_test(test_recognised),
        cmocka_unit_test(test_pipes),    cmocka_unit_test(test_cut),
        cmocka_unit_test(test_damage),   cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
