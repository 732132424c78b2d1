/* test_export_hexes.c - cells that are hexahedra exported, and their isosurfaces: closed in
 * whatever shapes of cells, vertices on the interpolant's surface, the same of a grid and of its
 * hexahedra as a mesh; cells come out as they went in, whatever the threads and the memory.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/base/vec3.h"
#include "prep/export/hex_solids.h"
#include "tests/support/curvilinear_file.h"
#include "tests/support/export_lab.h"
#include "tests/support/fixture.h"
#include "tests/support/mixed_file.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

enum { TREELET = 60, SEEDS = SLOW ? 2 : 6 };

static cell_mix mix;

/* ---- files ---- */

static const char *file_of_mix(void) {
    mesh_result result;
    (void)mixed_file_write(mix.cell, mix.count, scratch_path("mix.vtk"));
    mixed_file_convert(scratch_path("mix.vtk"), scratch_path("mix.leaf"), TREELET,
                       UINT64_C(1) << 32, &result);
    return scratch_path("mix.leaf");
}

static const char *file_of_zone(const curvilinear_zone *zone) {
    const leaf_image image = curvilinear_file(zone, 1);
    const char *path = scratch_write("grid.leaf", image.bytes, image.size);
    free(image.bytes);
    return path;
}

static const char *file_of_lab(const hex_lab *s) {
    const curvilinear_zone zone = {{HEX_LAB_NODES, HEX_LAB_NODES, HEX_LAB_NODES},
                                   (const float(*)[3])s->p,
                                   (const float *)s->value,
                                   NULL};
    return file_of_zone(&zone);
}

/* ---- surfaces ---- */

/* Outside of the mesh is outside of the surface, so that it is closed. noise: inside, values follow
 * from places, any beside any. */
static void set_values(double iso, bool noise) {
    for (int i = 0; i < mix.count; i++) {
        cell_mix_cell *c = &mix.cell[i];
        for (int v = 0; v < cell_shape_vertices(c->shape); v++) {
            if (noise)
                c->value[v] = iso - 1 + (double)(hash_bytes(c->p[v], sizeof c->p[v]) % 1024) / 512;
            if (c->sides[v])
                c->value[v] = iso - 1;
        }
    }
}

/* The interpolant's value at the vertices. Points on a collapsed or folded cell's side may be in
 * several cells, whose values differ there. */
static void check_values(const char *path, const ply_surface *s, const hex_lab *lab) {
    leafcast *v = fixture_open(path, NULL);
    leafcast_sample *samples = calloc(s->vertices, sizeof *samples);
    size_t off = 0;
    assert_non_null(samples);
    assert_int_equal(leafcast_sample_points(v, (const double(*)[3])s->at, s->vertices, samples),
                     LEAFCAST_OK);
    for (size_t i = 0; i < s->vertices; i++)
        off += samples[i].inside && !(fabs(samples[i].value - lab->iso) < 1e-6);
    if (off > (lab->may_be_folded || lab->closed ? s->vertices / 10 : 0))
        fail_msg("%s: %zu of %zu vertices are off the surface", lab->name, off, s->vertices);
    free(samples);
    leafcast_close(v);
}

static void test_mixes(void **state) {
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++)
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            cell_mix_make(&mix, n, FIELD_SEED + seed);
            const double iso = mix.lab.iso;
            set_values(iso, seed % 2 == 1);
            const char *path = file_of_mix();
            const export_how h = export_lab_plain(iso);
            ply_surface s = export_lab_surface(path, &h);
            ply_sides sides = ply_surface_sides(&s);
            /* Where cells have collapsed, values differ at one place; folded ones are turned by
             * their middle alone. */
            const bool whole = !mix.lab.closed && !mix.lab.may_be_folded;
            if (whole && sides.open + sides.repeated > 0)
                fail_msg("%s: %zu sides are open, %zu there twice", mix.lab.name, sides.open,
                         sides.repeated);
            assert_true(s.triangles > 100);
            check_values(path, &s, &mix.lab);
            free(sides.rim);
            ply_surface_release(&s);
        }
}

/* A grid's surface is that of its hexahedra as a mesh: the same points, as many triangles. */
static void test_grids(void **state) {
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab lab;
        ply_surface s[2];
        hex_lab_make(&lab, n, FIELD_SEED);
        cell_mix_whole(&mix, &lab);
        const export_how h = export_lab_plain(lab.iso);
        s[0] = export_lab_surface(file_of_lab(&lab), &h);
        s[1] = export_lab_surface(file_of_mix(), &h);
        assert_true(s[0].vertices > 0);
        if (s[0].vertices != s[1].vertices)
            fail_msg("%s: %zu vertices, %zu", lab.name, s[0].vertices, s[1].vertices);
        assert_int_equal(s[0].triangles, s[1].triangles);
        for (int i = 0; i < 2; i++)
            qsort(s[i].at, s[i].vertices, sizeof *s[i].at, export_lab_by_point);
        assert_memory_equal(s[0].at, s[1].at, s[0].vertices * sizeof *s[0].at);
        for (int i = 0; i < 2; i++)
            ply_surface_release(&s[i]);
    }
}

/* ---- a ball ---- */

enum { BALL = 41 };

static float ball_place[BALL * BALL * BALL][3], ball_value[BALL * BALL * BALL];
static uint8_t ball_blank[BALL * BALL * BALL];

static float ball_depth(const float p[3]) {
    double away = 0;
    for (int a = 0; a < 3; a++)
        away += pow((double)p[a] - 6, 2);
    return (float)(6 - sqrt(away));
}

/* A warped box of 0 to 12 about a ball in the middle; mirrored: left-handed. */
static curvilinear_zone ball_zone(bool mirrored) {
    for (int n = 0; n < BALL * BALL * BALL; n++) {
        const int at[3] = {n % BALL, n / BALL % BALL, n / (BALL * BALL)};
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = 0.3 * (a == 0 && mirrored ? BALL - 1 - at[0] : at[a]);
        for (int a = 0; a < 3; a++)
            ball_place[n][a] = (float)(p[a] + 0.2 * sin(p[(a + 1) % 3]));
        ball_value[n] = ball_depth(ball_place[n]);
        ball_blank[n] = 1;
    }
    return (curvilinear_zone){{BALL, BALL, BALL}, (const float(*)[3])ball_place, ball_value, NULL};
}

static void test_ball(void **state) {
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        const curvilinear_zone zone = ball_zone(mirrored);
        const export_how h = export_lab_plain(1.7);
        ply_surface s = export_lab_surface(file_of_zone(&zone), &h);
        export_lab_check_ball(&s, 6, 4.3, 0.01);
        ply_surface_release(&s);
    }
}

/* ---- cells as they are ---- */

static uint64_t sum_of(const float at[3], float value) {
    const float all[4] = {at[0], at[1], at[2], value};
    return hash_bytes(all, sizeof all);
}

static int by_number(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Export all cells with the first field named "f". */
static char *export_cells(const char *path, piece_info *info) {
    static const char *const names[] = {"f"};
    const uint32_t first = 0;
    const export_how h = {.format = "vtu", .threads = 3};
    mem m;
    leaf_file *f;
    piece_source source;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    const cell_choice choice = {.f = f, .fields = &first, .count = 1};
    *info = (piece_info){.fields = names, .field_count = 1, .floats = true};
    assert_int_equal(hex_solids_create(&m, &choice, 3, &source), ST_OK);
    if (export_lab_pieces(&m, &h, &source, info) != ST_OK)
        fail_msg("%s", status_text());
    piece_source_release(&source);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return scratch_read(scratch_path("surface"), NULL);
}

/* The volume of a cell's edges at its first vertex. */
static double turn_of(int vtk, const float p[][3]) {
    static const int ends[15][3] = {
        [10] = {1, 2, 3}, [12] = {1, 3, 4}, [13] = {1, 2, 3}, [14] = {1, 3, 4}};
    double edge[3][3];
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
            edge[i][a] = (double)p[ends[vtk][i]][a] - (double)p[0][a];
    return vec3_det(edge[0], edge[1], edge[2]);
}

/* Each cell is of the shape that it went in with, of the same points with the same values. */
static void test_shapes(void **state) {
    static const uint8_t vtk[CELL_SHAPES] = {
        [CELL_HEXAHEDRON] = 12, [CELL_WEDGE] = 13, [CELL_PYRAMID] = 14, [CELL_TET] = 10};
    static uint64_t want[CELL_MIX_CELLS], got[CELL_MIX_CELLS];
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        piece_info info;
        cell_mix_make(&mix, n, FIELD_SEED);
        if (mix.lab.closed)
            continue; /* collapsed cells become others */
        char *bytes = export_cells(file_of_mix(), &info);
        const char *at = export_lab_array(bytes, "Points"), *values = export_lab_array(bytes, "f"),
                   *corners = export_lab_array(bytes, "connectivity"),
                   *ends = export_lab_array(bytes, "offsets"),
                   *types = export_lab_array(bytes, "types");
        assert_int_equal(info.cells, mix.count);
        int64_t corner = 0;
        for (int i = 0; i < mix.count; i++) {
            const cell_mix_cell *c = &mix.cell[i];
            int64_t end;
            want[i] = vtk[c->shape];
            for (int v = 0; v < cell_shape_vertices(c->shape); v++)
                want[i] +=
                    sum_of((float[3]){(float)c->p[v][0], (float)c->p[v][1], (float)c->p[v][2]},
                           (float)c->value[v]);
            got[i] = (uint8_t)types[i];
            memcpy(&end, ends + i * (int)sizeof end, sizeof end);
            float point[HEX_CORNERS][3];
            for (int k = 0; corner < end; corner++, k++) {
                int64_t v;
                float value;
                memcpy(&v, corners + corner * (int)sizeof v, sizeof v);
                assert_true(k < HEX_CORNERS && v >= 0 && (uint64_t)v < info.vertices);
                memcpy(point[k], at + v * 12, sizeof point[k]);
                memcpy(&value, values + v * 4, sizeof value);
                got[i] += sum_of(point[k], value);
            }
            assert_true(mix.lab.may_be_folded || turn_of(types[i], (const float(*)[3])point) > 0);
        }
        assert_int_equal(corner, info.corners);
        qsort(want, (size_t)mix.count, sizeof *want, by_number);
        qsort(got, (size_t)mix.count, sizeof *got, by_number);
        assert_memory_equal(want, got, (size_t)mix.count * sizeof *want);
        free(bytes);
    }
}

/* Of what is in all payloads. */
static uint64_t sum_of_file(const char *path) {
    mem m;
    leaf_file *f;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    const uint64_t sum = hash_bytes(f->checksums, f->layout.payloads * sizeof *f->checksums);
    leaf_file_close(f);
    return sum;
}

/* Exported and converted again, right-handed cells make the same treelets, of a grid and of a mesh;
 * left-handed ones are turned. */
static void test_round(void **state) {
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab lab;
        uint64_t sum[3];
        piece_info info;
        mesh_result result;
        hex_lab_make(&lab, n, FIELD_SEED);
        cell_mix_whole(&mix, &lab);
        const char *const paths[2] = {file_of_mix(), file_of_lab(&lab)};
        sum[2] = sum_of_file(paths[0]);
        for (int i = 0; i < 2; i++) {
            free(export_cells(paths[i], &info));
            assert_int_equal(rename(scratch_path("surface"), scratch_path("again.vtu")), 0);
            mixed_file_convert(scratch_path("again.vtu"), scratch_path("again.leaf"), TREELET,
                               UINT64_C(1) << 32, &result);
            sum[i] = sum_of_file(scratch_path("again.leaf"));
        }
        const bool turned = strcmp(lab.name, "mirrored") == 0;
        if (!lab.may_be_folded && !lab.closed && (sum[0] == sum[2]) == turned)
            fail_msg("%s: %s", lab.name, turned ? "not turned" : "other treelets");
        assert_int_equal(sum[0], sum[1]);
    }
}

/* Cells that are blanked are left out, and so are nodes that no other has; the others keep their
 * values. */
static void test_blanked(void **state) {
    enum { GONE = 10, HIDDEN = 30 };
    (void)state;
    piece_info info;
    curvilinear_zone zone = ball_zone(false);
    zone.blank = ball_blank;
    for (int k = 0; k < BALL; k++)
        for (int j = 0; j < BALL; j++)
            for (int i = 0; i < BALL; i++)
                ball_blank[i + BALL * (j + BALL * k)] = i < GONE ? 0 : i < HIDDEN ? 1 : 3;
    const char *path = file_of_zone(&zone);
    char *bytes = export_cells(path, &info);
    assert_int_equal(info.cells, (HIDDEN - GONE) * (BALL - 1) * (BALL - 1));
    assert_int_equal(info.vertices, (HIDDEN + 1 - GONE) * BALL * BALL);
    const char *at = export_lab_array(bytes, "Points"), *values = export_lab_array(bytes, "f");
    for (uint64_t i = 0; i < info.vertices; i++) {
        float p[3], value;
        memcpy(p, at + i * sizeof p, sizeof p);
        memcpy(&value, values + i * sizeof value, sizeof value);
        assert_true(value == ball_depth(p));
    }
    free(bytes);
    const export_how h = export_lab_plain(1.7);
    ply_surface s = export_lab_surface(path, &h);
    for (size_t i = 0; i < s.vertices; i++) {
        const double *x = s.at[i];
        assert_true(x[0] > 0.3 * GONE - 0.3 && x[0] < 0.3 * HIDDEN + 0.3);
        assert_true(fabs((double)ball_depth((float[3]){(float)x[0], (float)x[1], (float)x[2]}) -
                         1.7) < 0.01);
    }
    ply_surface_release(&s);
}

/* ---- the same bytes, and hostile ones ---- */

static void test_same(void **state) {
    static const char *const formats[] = {"ply", "stl", "vtp"};
    (void)state;
    cell_mix_make(&mix, 0, FIELD_SEED);
    const char *path = file_of_mix();
    for (int i = 0; i < 3; i++)
        export_lab_check_same(path, mix.lab.iso, formats[i], 4 << 20);
}

static void test_malice(void **state) {
    (void)state;
    cell_mix_make(&mix, 0, FIELD_SEED);
    const export_how h = export_lab_plain(mix.lab.iso);
    export_lab_malice(file_of_mix(), &h, 1, 300);
    export_lab_malice(file_of_lab(&mix.lab), &h, 2, 300);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mixes), cmocka_unit_test(test_grids),
        cmocka_unit_test(test_ball),  cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_round), cmocka_unit_test(test_blanked),
        cmocka_unit_test(test_same),  cmocka_unit_test(test_malice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
