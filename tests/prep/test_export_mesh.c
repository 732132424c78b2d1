/* test_export_mesh.c - meshes exported, and their isosurfaces: just the crossings of edges are
 * vertices, at the bits that the formula has; closed where the mesh is; tets, points and values are
 * the input's; the same bytes whatever the threads, the memory and the treelets.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/leaf/leaf_file.h"
#include "prep/export/tet_solids.h"
#include "tests/support/export_lab.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/scratch.h"

/* ---- surfaces ---- */

/* Ends from the lower to the higher vertex: point, value. Those that look the same are one. */
typedef struct mesh_edge {
    float end[2][4];
} mesh_edge;

static int by_ends(const void *a, const void *b) {
    return memcmp(a, b, sizeof(mesh_edge));
}

static mesh_edge edge_between(const lab_mesh *lab, uint32_t one, uint32_t other) {
    const uint32_t ends[2] = {one < other ? one : other, one < other ? other : one};
    mesh_edge e;
    for (int i = 0; i < 2; i++) {
        memcpy(e.end[i], lab->points[ends[i]], sizeof lab->points[0]);
        e.end[i][3] = lab->values[ends[i]];
    }
    return e;
}

/* Where the surface crosses edges of tets, each once; free it. */
static double (*mesh_crossings(const lab_mesh *lab, double iso, size_t *count))[3] {
    mesh_edge *edges = calloc(6 * lab->tet_count + 1, sizeof *edges);
    size_t n = 0;
    assert_non_null(edges);
    for (size_t t = 0; t < lab->tet_count; t++) {
        const uint32_t *v = lab->tets[t];
        bool sound = true;
        for (int i = 0; i < 4; i++) {
            sound &= v[i] < lab->point_count;
            for (int k = 0; k < i; k++)
                sound &= v[i] != v[k];
        }
        for (int i = 0; i < 4 && sound; i++)
            sound &= isfinite(lab->values[v[i]]);
        for (int i = 0; i < 4 && sound; i++)
            for (int k = i + 1; k < 4; k++)
                if (((double)lab->values[v[i]] >= iso) != ((double)lab->values[v[k]] >= iso))
                    edges[n++] = edge_between(lab, v[i], v[k]);
    }
    qsort(edges, n, sizeof *edges, by_ends);
    double(*at)[3] = calloc(n + 1, sizeof *at);
    assert_non_null(at);
    *count = 0;
    for (size_t i = 0; i < n; i++) {
        if (i > 0 && by_ends(&edges[i], &edges[i - 1]) == 0)
            continue;
        const float *low = edges[i].end[0], *high = edges[i].end[1];
        const double t = (iso - (double)low[3]) / ((double)high[3] - (double)low[3]);
        for (int a = 0; a < 3; a++) {
            const double p = (double)low[a], q = (double)high[a];
            at[*count][a] = t == 1 ? q : p + t * (q - p);
        }
        ++*count;
    }
    free(edges);
    return at;
}

static void check_mesh(const lab_mesh *lab, const ply_surface *s) {
    size_t count;
    double(*at)[3] = mesh_crossings(lab, lab->iso, &count);
    double(*found)[3] = calloc(s->vertices + 1, sizeof *found);
    assert_non_null(found);
    memcpy(found, s->at, s->vertices * sizeof *found);
    if (s->vertices != count)
        fail_msg("%s: %zu vertices, %zu edges are crossed", lab->name, s->vertices, count);
    qsort(at, count, sizeof *at, export_lab_by_point);
    qsort(found, count, sizeof *found, export_lab_by_point);
    assert_memory_equal(at, found, count * sizeof *at);
    ply_sides sides = ply_surface_sides(s);
    /* A tet that is there twice has its triangles twice. */
    if (lab->sound && strcmp(lab->name, "repeated") != 0) {
        if (sides.repeated > 0 || (lab->closed && sides.open > 0))
            fail_msg("%s: %zu sides are there twice, %zu open", lab->name, sides.repeated,
                     sides.open);
    }
    free(sides.rim);
    free(at);
    free(found);
}

static void test_meshes(void **state) {
    (void)state;
    for (int i = 0; i < lab_mesh_count(); i++) {
        lab_mesh lab;
        assert_true(lab_mesh_make(&lab, lab_mesh_name(i), 8, 1));
        for (uint32_t tets = 60; tets < 5000; tets *= 70) {
            const char *path = lab_leaf_make(&lab, tets, tets < 100);
            const export_how h = export_lab_plain(lab.iso);
            ply_surface s = export_lab_surface(path, &h);
            check_mesh(&lab, &s);
            ply_surface_release(&s);
        }
        lab_mesh_release(&lab);
    }
}

static double ball_value(const double p[3]) {
    return 6 - sqrt((p[0] - 6) * (p[0] - 6) + (p[1] - 6) * (p[1] - 6) + (p[2] - 6) * (p[2] - 6));
}

static void test_mesh_ball(void **state) {
    (void)state;
    lab_mesh lab;
    lab_mesh_kuhn(&lab, (int[3]){24, 24, 24}, (double[3]){0, 0, 0}, 0.5, ball_value);
    for (int gradients = 0; gradients < 2; gradients++) {
        const export_how h = export_lab_plain(1.7);
        ply_surface s = export_lab_surface(lab_leaf_make(&lab, 300, gradients), &h);
        export_lab_check_ball(&s, 6, 4.3, gradients ? 0.01 : 0.05);
        ply_surface_release(&s);
    }
    lab_mesh_release(&lab);
}

/* ---- a mesh as it is ---- */

static uint64_t sum_of(const float at[3], float value) {
    float all[4] = {at[0], at[1], at[2], value};
    return hash_bytes(all, sizeof all);
}

static int by_number(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static void test_tets(void **state) {
    (void)state;
    lab_mesh lab;
    lab_mesh_kuhn(&lab, (int[3]){9, 8, 7}, (double[3]){-1, 5, 0}, 0.75, ball_value);
    const char *path = lab_leaf_make(&lab, 100, false);
    mem m;
    leaf_file *f;
    piece_source source;
    const uint32_t first = 0;
    const char *const names[] = {"f<\"x\">"};
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    const cell_choice choice = {.f = f, .fields = &first, .count = 1};
    assert_int_equal(tet_solids_create(&m, &choice, 3, &source), ST_OK);
    piece_info info = {.fields = names, .field_count = 1, .floats = true};
    const export_how h = {.format = "vtu", .threads = 3};
    assert_int_equal(export_lab_pieces(&m, &h, &source, &info), ST_OK);
    assert_int_equal(info.vertices, lab.point_count);
    assert_int_equal(info.cells, lab.tet_count);
    char *bytes = scratch_read(scratch_path("surface"), NULL);
    const float(*at)[3] = (const float(*)[3])(const void *)export_lab_array(bytes, "Points");
    const char *values = export_lab_array(bytes, "f&lt;&quot;x&quot;&gt;"),
               *corners = export_lab_array(bytes, "connectivity");
    uint64_t *want = calloc(lab.tet_count, sizeof *want), *got = calloc(lab.tet_count, sizeof *got);
    for (size_t t = 0; t < lab.tet_count; t++) {
        int64_t v[4];
        double p[4][3];
        memcpy(v, corners + t * sizeof v, sizeof v);
        for (int i = 0; i < 4; i++) {
            float point[3], value;
            memcpy(point, (const char *)at + v[i] * 12, sizeof point);
            memcpy(&value, values + v[i] * 4, sizeof value);
            got[t] += sum_of(point, value);
            want[t] += sum_of(lab.points[lab.tets[t][i]], lab.values[lab.tets[t][i]]);
            for (int a = 0; a < 3; a++)
                p[i][a] = (double)point[a] - (i > 0 ? p[0][a] : 0);
        }
        assert_true(p[1][0] * (p[2][1] * p[3][2] - p[2][2] * p[3][1]) +
                        p[1][1] * (p[2][2] * p[3][0] - p[2][0] * p[3][2]) +
                        p[1][2] * (p[2][0] * p[3][1] - p[2][1] * p[3][0]) >
                    0);
    }
    qsort(want, lab.tet_count, sizeof *want, by_number);
    qsort(got, lab.tet_count, sizeof *got, by_number);
    assert_memory_equal(want, got, lab.tet_count * sizeof *want);
    free(want);
    free(got);
    free(bytes);
    piece_source_release(&source);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    lab_mesh_release(&lab);
}

/* ---- the same bytes ---- */

static void test_same(void **state) {
    (void)state;
    static const char *const formats[] = {"ply", "stl", "vtp"};
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, "sphere", 20, 1));
    const char *mesh = lab_leaf_make(&lab, 40, false);
    for (int i = 0; i < 3; i++)
        export_lab_check_same(mesh, lab.iso, formats[i], 4 << 20);
    lab_mesh_release(&lab);
}

static void test_malice(void **state) {
    (void)state;
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, "sphere", 6, 1));
    for (int gradients = 0; gradients < 2; gradients++) {
        const export_how h = export_lab_plain(lab.iso);
        export_lab_malice(lab_leaf_make(&lab, 100, gradients), &h, 1 + (uint64_t)gradients, 300);
    }
    lab_mesh_release(&lab);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_meshes), cmocka_unit_test(test_mesh_ball),
        cmocka_unit_test(test_tets),   cmocka_unit_test(test_same),
        cmocka_unit_test(test_malice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
