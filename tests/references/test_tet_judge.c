/* test_tet_judge.c - meshes from files, and what the judge of pictures of them lets pass. */
/* marks: long, plain */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "formats/mesh/mesh_stream.h"
#include "tests/support/scratch.h"
#include "tests/support/tet_judge.h"
#include "tests/support/tet_load.h"
#include "tests/support/tet_meshes.h"

enum { SEED = 5, SIDE = 5 };

/* ---- meshes from files ---- */

static void write_stream(const char *path, const tet_ref_mesh *raw) {
    mem m;
    mesh_stream_writer *w = NULL;
    mesh_stream_header h = {.name = "lab", .field = "f"};
    h.points = raw->point_count;
    h.tets = raw->tet_count;
    mem_init(&m, 0);
    assert_int_equal(mesh_stream_create(&m, path, true, &h, &w), ST_OK);
    assert_int_equal(mesh_stream_points(w, raw->point_count, raw->points), ST_OK);
    assert_int_equal(mesh_stream_values(w, raw->point_count, raw->values), ST_OK);
    assert_int_equal(mesh_stream_tets(w, raw->tet_count, raw->tets), ST_OK);
    assert_int_equal(mesh_stream_commit(w), ST_OK);
}

static void streams_are_read_as_written(void **state) {
    (void)state;
    lab_mesh m;
    assert_true(lab_mesh_make(&m, "no-data", SIDE, SEED));
    tet_ref_mesh raw = lab_mesh_reference(&m), read;
    const char *path = scratch_path("lab.mesh"), *why;
    write_stream(path, &raw);
    assert_true(tet_load_stream(path, &read, &why));
    assert_int_equal(read.point_count, raw.point_count);
    assert_int_equal(read.tet_count, raw.tet_count);
    assert_memory_equal(read.points, raw.points, raw.point_count * sizeof raw.points[0]);
    assert_memory_equal(read.values, raw.values, raw.point_count * sizeof raw.values[0]);
    assert_memory_equal(read.tets, raw.tets, raw.tet_count * sizeof raw.tets[0]);
    tet_unload(&read);
    /* Any other length is refused. */
    size_t size;
    char *bytes = scratch_read(path, &size);
    for (size_t n = 0; n <= size + 1; n += n < 80 || n >= size - 1 ? 1 : 97) {
        const char *cut = scratch_write("cut.mesh", bytes, n < size ? n : size);
        if (n > size) {
            FILE *more = fopen(cut, "ab");
            assert_non_null(more);
            fputc(0, more);
            fclose(more);
        }
        if (tet_load_stream(cut, &read, &why) != (n == size))
            fail_msg("%zu of %zu bytes", n, size);
        tet_unload(&read);
    }
    free(bytes);
    lab_mesh_release(&m);
}

/* The volumes of a mesh's tets: negative, zero, positive. */
static void count_volumes(const tet_ref_mesh *m, size_t count[3]) {
    memset(count, 0, 3 * sizeof count[0]);
    for (size_t i = 0; i < m->tet_count; i++) {
        double e[3][3], v = 0;
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                e[k][a] = (double)m->points[m->tets[i][k + 1]][a] - m->points[m->tets[i][0]][a];
        for (int a = 0; a < 3; a++)
            v += e[0][a] *
                 (e[1][(a + 1) % 3] * e[2][(a + 2) % 3] - e[1][(a + 2) % 3] * e[2][(a + 1) % 3]);
        count[(v >= 0) + (v > 0)]++;
    }
}

/* As the list beside the data tells them. */
static void arrays_are_what_their_list_says(void **state) {
    (void)state;
    static const struct {
        const char *points, *values, *tets;
        size_t point_count, tet_count, negative, zero;
    } sets[] = {
        {"tet_turb_degenerate/points_f32x3.raw.zst", "tet_turb_degenerate/tur_mu_f32.raw.zst",
         "tet_turb_degenerate/tets_i32x4.raw.zst", 21813, 60672, 690, 8248},
        {"tet_artery_series/points_f64x3.raw.zst", "tet_artery_series/speed_t0200_f32.raw.zst",
         "tet_artery_series/tets_i32x4.raw.zst", 5508, 30136, 15117, 0},
    };
    for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
        char *path[3];
        const char *const names[3] = {sets[i].points, sets[i].values, sets[i].tets}, *why;
        bool here = true;
        for (int k = 0; k < 3; k++) {
            const char *found = scratch_data(names[k]);
            path[k] = found ? strdup(found) : NULL;
            here = here && path[k];
        }
        const tet_arrays from = {path[0], path[1], path[2]};
        tet_ref_mesh m;
        size_t volumes[3];
        if (here) {
            assert_true(tet_load_arrays(&from, &m, &why));
            assert_int_equal(m.point_count, sets[i].point_count);
            assert_int_equal(m.tet_count, sets[i].tet_count);
            count_volumes(&m, volumes);
            /* Which of the flat ones are negative by rounding is anyone's guess. */
            assert_true(volumes[0] <= sets[i].negative &&
                        sets[i].negative <= volumes[0] + volumes[1]);
            assert_true(llabs((long long)volumes[1] - (long long)sets[i].zero) < 500);
            tet_unload(&m);
        }
        for (int k = 0; k < 3; k++)
            free(path[k]);
    }
}

static int compare_faces(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* All faces of a mesh, vertices ascending, in order. */
static uint32_t (*faces_of(const tet_ref_mesh *m))[3] {
    uint32_t(*face)[3] = malloc(4 * m->tet_count * sizeof *face);
    assert_non_null(face);
    for (size_t i = 0; i < 4 * m->tet_count; i++) {
        int n = 0;
        for (size_t k = 0; k < 4; k++)
            if (k != i % 4)
                face[i][n++] = m->tets[i / 4][k];
        for (int a = 1; a < 3; a++)
            for (int b = a; b > 0 && face[i][b] < face[i][b - 1]; b--) {
                uint32_t swap = face[i][b];
                face[i][b] = face[i][b - 1];
                face[i][b - 1] = swap;
            }
    }
    qsort(face, 4 * m->tet_count, sizeof *face, compare_faces);
    return face;
}

/* The paper's own set: 39 x 31 x 31 cells, six tetrahedra each, consistent over their faces. */
static void blunt_fin_is_split(void **state) {
    (void)state;
    char *xyz = NULL, command[4096];
    const char *tools = getenv("LEAFCAST_BUILD"), *found = scratch_data("bluntfin/bluntfinxyz.bin");
    if (!found || !tools)
        skip();
    xyz = strdup(found);
    const char *q = scratch_data("bluntfin/bluntfinq.bin"), *path = scratch_path("fin.mesh"), *why;
    assert_non_null(q);
    snprintf(command, sizeof command, "'%s/tests/tool_split_plot3d' '%s' '%s' '%s'", tools, xyz, q,
             path);
    free(xyz);
    assert_int_equal(system(command), 0);
    tet_ref_mesh m;
    assert_true(tet_load_stream(path, &m, &why));
    assert_int_equal(m.point_count, 40960);
    assert_int_equal(m.tet_count, 224874);
    float least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < m.point_count; i++) {
        least = fminf(least, m.values[i]);
        most = fmaxf(most, m.values[i]);
    }
    assert_true(fabsf(least - 0.1926f) < 1e-4f && fabsf(most - 4.9775f) < 1e-4f);
    uint32_t(*face)[3] = faces_of(&m);
    size_t alone = 0, count = 4 * m.tet_count;
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && compare_faces(face[i], face[end]) == 0;)
            end++;
        assert_true(end - i <= 2);
        alone += end - i == 1;
    }
    assert_int_equal(alone, 2 * 2 * (39 * 31 + 39 * 31 + 31 * 31));
    free(face);
    tet_unload(&m);
}

/* ---- the judge ---- */

static void judge_tells_right_from_wrong(void **state) {
    (void)state;
    lab_mesh m;
    assert_true(lab_mesh_make(&m, "sphere", 16, SEED));
    tet_ref_mesh raw = lab_mesh_reference(&m);
    tet_ref *r = tet_ref_create(&raw);
    assert_non_null(r);
    const double iso = m.iso;
    field_random random = {SEED};
    ref_tally tally = {0};
    uint64_t hits = 0, misses = 0;
    for (int n = 0; n < 400; n++) {
        ref_ray ray = lab_mesh_ray(&m, LAB_RAY_RANDOM, &random);
        ref_hit hit;
        bool is_hit = tet_ref_trace(r, &ray, &iso, 1, NULL, &hit, 1) > 0;
        double edge = is_hit ? 1 / hit.cells_per_t : 0, t = is_hit ? hit.t : INFINITY;
        if (tet_judge_grazing(r, &ray, &iso, 1, NULL, 1))
            continue;
        const struct {
            double t;
            ref_verdict verdict;
        } said[] = {
            {t, REF_SAME},
            {t + 0.9e-5 * edge, REF_SAME},
            {is_hit ? t + 1.1e-5 * edge : 1, is_hit ? REF_TOO_FAR : REF_FALSE_HIT},
            {is_hit ? t - 1.1e-5 * edge : 0, is_hit ? REF_TOO_FAR : REF_FALSE_HIT},
            {is_hit ? INFINITY : 1e9, is_hit ? REF_MISSED : REF_FALSE_HIT},
            {NAN, is_hit ? REF_TOO_FAR : REF_FALSE_HIT},
        };
        for (size_t i = 0; i < sizeof said / sizeof said[0]; i++)
            assert_int_equal(tet_judge_pixel(&tally, r, &ray, &iso, 1, NULL, said[i].t),
                             said[i].verdict);
        hits += is_hit;
        misses += !is_hit;
    }
    assert_true(hits > 100 && misses > 50);
    assert_int_equal(tally.missed, hits);
    assert_int_equal(tally.too_far, 3 * hits);
    assert_int_equal(tally.false_hits, 4 * misses);
    assert_int_equal(tally.grazing, 0);
    tet_ref_destroy(r);
    lab_mesh_release(&m);
}

static double ramp(const double p[3]) {
    return p[2];
}

static void band_is_as_wide_as_it_says(void **state) {
    (void)state;
    const int n[3] = {4, 4, 4};
    const double origin[3] = {0, 0, 0}, iso = 2.5;
    lab_mesh m;
    lab_mesh_kuhn(&m, n, origin, 1, ramp);
    tet_ref_mesh raw = lab_mesh_reference(&m);
    tet_ref *r = tet_ref_create(&raw);
    assert_non_null(r);
    const struct {
        ref_ray ray;
        bool grazing;
    } cases[] = {
        {{{1.3, 1.4, -1}, {0, 0, 1}}, false},      /* straight */
        {{{4 - 3e-6, 1.4, -1}, {0, 0, 1}}, false}, /* near the surface's end; nearer */
        {{{4 - 0.8e-6, 1.4, -1}, {0, 0, 1}}, true},
        {{{4 + 0.8e-6, 1.4, -1}, {0, 0, 1}}, true}, /* just beside it */
        {{{4 + 3e-6, 1.4, -1}, {0, 0, 1}}, false},
        {{{-1, 1.3, 2.4}, {1, 0, 0.05}}, false}, /* slanting, 1 in 20; 1 in 200 */
        {{{-1, 1.3, 2.49}, {1, 0, 0.005}}, true},
        {{{-1, 1.3, 2.5 + 3e-6}, {1, 0, 0}}, false}, /* along it */
        {{{-1, 1.3, 2.5 - 3e-6}, {1, 0, 0}}, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        if (tet_judge_grazing(r, &cases[i].ray, &iso, 1, NULL, 1) != cases[i].grazing)
            fail_msg("case %zu is not as it should be", i);
    tet_ref_destroy(r);
    lab_mesh_release(&m);
}

/* Tetrahedra around an edge along z, f = z, from angle `from` on; a ray along the edge. */
static void check_fan(double from, double to, bool grazing, bool excused) {
    enum { WEDGES = 20 };
    float points[WEDGES + 3][3] = {{0, 0, 0}, {0, 0, 1}}, values[WEDGES + 3] = {0, 1};
    uint32_t tets[WEDGES][4];
    for (uint32_t i = 0; i <= WEDGES; i++) {
        const double angle = (from + (to - from) * i / WEDGES) * acos(-1) / 180;
        points[i + 2][0] = (float)cos(angle);
        points[i + 2][1] = (float)sin(angle);
        points[i + 2][2] = values[i + 2] = 0.5f;
    }
    for (uint32_t i = 0; i < WEDGES; i++)
        memcpy(tets[i], (uint32_t[4]){0, 1, i + 2, i + 3}, sizeof tets[i]);
    const tet_ref_mesh raw = {.point_count = WEDGES + 3,
                              .tet_count = WEDGES,
                              .points = (const float(*)[3])points,
                              .values = values,
                              .tets = (const uint32_t(*)[4])tets};
    const ref_ray along = {{0, 0, -1}, {0, 0, 1}};
    const double iso = 0.25;
    tet_ref *r = tet_ref_create(&raw);
    assert_non_null(r);
    assert_int_equal(tet_judge_grazing(r, &along, &iso, 1, NULL, 2), grazing);
    assert_int_equal(tet_judge_excused(r, &along, &iso, 1, NULL, 2), excused);
    tet_ref_destroy(r);
}

/* The eight directions are 0, 45, 90, .. degrees. */
static void band_has_no_gaps(void **state) {
    (void)state;
    check_fan(0.01, 359.99, true, true); /* a hole at 0 */
    check_fan(25, 383, false, true);     /* holes of 2 degrees, and of 40 */
    check_fan(43, 363, false, true);
    check_fan(20, 380, false, false); /* none */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(streams_are_read_as_written),
        cmocka_unit_test(arrays_are_what_their_list_says),
        cmocka_unit_test(blunt_fin_is_split),
        cmocka_unit_test(judge_tells_right_from_wrong),
        cmocka_unit_test(band_is_as_wide_as_it_says),
        cmocka_unit_test(band_has_no_gaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
