/* test_surface_convert.c - conversions of surfaces: what the file holds is what the inputs do,
 * whatever the budget and the threads, whether it was interrupted or not, at once or step by step;
 * files that are no further step are refused by name; bad, repeated and flat triangles are counted.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "formats/leaf/leaf_grow.h"
#include "formats/leaf/leaf_verify.h"
#include "prep/leafcast_prep.h"
#include "prep/mesh/triangle_treelet.h"
#include "tests/support/naive_surface.h"
#include "tests/support/scratch.h"
#include "tests/support/surface_movie.h"
#include "tests/support/watched.h"

enum { SIDE = 200 };

static mem m;

static void convert(const surface_movie *v, const char *name, mesh_result *r) {
    if (surface_movie_convert(&m, v, scratch_path(name), NULL, false, r) != ST_OK)
        fail_msg("%s: %s", name, status_text());
}

static void compress(surface_movie *v, int zstd) {
    v->options.file.codec = zstd ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
    v->options.file.zstd_level = 1;
}

static void verify(const char *name) {
    leaf_file *f = NULL;
    mem_init(&m, 0);
    if (leaf_file_open(&m, scratch_path(name), &f) != ST_OK || leaf_verify(&m, f, 2, NULL) != ST_OK)
        fail_msg("%s: %s", name, status_text());
    leaf_file_close(f);
}

/* ---- budgets and threads ---- */

/* As little memory as the plan asks for. */
static void squeeze(surface_movie *v) {
    mesh_result r;
    assert_int_equal(surface_movie_convert(&m, v, scratch_path("none.leaf"), NULL, true, &r),
                     ST_OK);
    v->options.memory = r.plan.memory_least + (1 << 17);
}

/* Without normals, with those of the files, and made of the triangles. */
enum { MODES = 3 };

static void choose_normals(surface_movie *v, int mode) {
    v->options.normals = mode == 2 ? NORMALS_SMOOTH : NORMALS_FILE;
    if (mode == 1)
        surface_movie_give_normals(v, "sheet");
}

static void test_budgets(void **state) {
    (void)state;
    for (int mode = 0; mode < MODES; mode++) {
        const int zstd = mode != 1;
        mesh_result r;
        surface_movie v = surface_movie_make(SIDE, 2, 3, true, "sheet");
        choose_normals(&v, mode);
        const uint64_t much = v.options.memory;
        compress(&v, zstd);
        convert(&v, "whole.leaf", &r);
        assert_int_equal(r.plan.spill_bytes, 0);
        assert_int_equal(r.header.tets, v.triangles);
        assert_int_equal(r.header.vertices, v.points);
        assert_int_equal(r.header.flat, 1);
        assert_int_equal(r.header.repeated, 1);
        assert_int_equal(r.header.bad, 1);
        surface_movie_check(&v, scratch_path("whole.leaf"));
        verify("whole.leaf");
        for (int threads = 1; threads <= 4; threads *= 2)
            for (int little = 0; little < 2; little++) {
                v.options.threads = threads;
                v.options.memory = much;
                if (little)
                    squeeze(&v);
                convert(&v, "again.leaf", &r);
                assert_int_equal(r.plan.spill_bytes > 0, little);
                scratch_same("budget", scratch_path("whole.leaf"), scratch_path("again.leaf"));
            }
        v.options.memory = 1 << 20;
        assert_int_equal(surface_movie_convert(&m, &v, scratch_path("again.leaf"), NULL, false, &r),
                         ST_NOMEM);
        surface_movie_release(&v);
    }
}

/* ---- conversions that end early ---- */

typedef struct question {
    long asked, end; /* from question number `end` on: stop; 0: never */
} question;

static bool is_enough(void *ctx) {
    question *q = ctx;
    const long asked = __atomic_add_fetch(&q->asked, 1, __ATOMIC_RELAXED);
    return q->end > 0 && asked >= q->end;
}

/* With what an earlier run has kept, and keeping what it has done. */
static status go_on(surface_movie *v, const char *name, question *q) {
    const progress p = {.stop = is_enough, .ctx = q};
    const char *path = scratch_path(name);
    convert_job text = {0};
    mesh_result r;
    mem own; /* of the folder */
    q->asked = 0;
    mem_init(&own, 0);
    v->options.job = &text;
    assert_int_equal(convert_job_init(&text, &own, path), ST_OK);
    assert_int_equal(work_folder_open(&own, path, WORK_RESUME, 0, &v->options.work), ST_OK);
    const status st = surface_movie_convert(&m, v, path, &p, false, &r);
    (void)work_folder_close(v->options.work, st != ST_OK);
    convert_job_release(&text);
    v->options.work = NULL;
    v->options.job = NULL;
    assert_int_equal(mem_used(&own), 0);
    return st;
}

static void test_resumed(void **state) {
    enum { TIMES = WATCHED ? 5 : 10 };
    (void)state;
    for (int how = 0; how < 2 * MODES; how++) {
        const int little = how % 2;
        mesh_result r;
        question q = {0};
        surface_movie v = surface_movie_make(SIDE, 1, 3, true, "sheet");
        choose_normals(&v, how / 2);
        convert(&v, "whole.leaf", &r);
        if (little)
            squeeze(&v);
        assert_int_equal(go_on(&v, "again.leaf", &q), ST_OK);
        scratch_same("kept", scratch_path("whole.leaf"), scratch_path("again.leaf"));
        const long all = q.asked;
        long stopped = 0;
        assert_true(all > TIMES);
        for (int k = 1; k < TIMES; k++) {
            assert_int_equal(remove(scratch_path("again.leaf")), 0);
            q.end = 1 + k * all / TIMES;
            stopped += go_on(&v, "again.leaf", &q) == ST_STOPPED;
            q.end = 0;
            if (go_on(&v, "again.leaf", &q) != ST_OK)
                fail_msg("after %d of %d: %s", k, TIMES, status_text());
            scratch_same("resumed", scratch_path("whole.leaf"), scratch_path("again.leaf"));
        }
        assert_true(stopped > TIMES / 2);
        assert_int_equal(remove(scratch_path("again.leaf")), 0);
        surface_movie_release(&v);
    }
}

/* ---- normals ---- */

/* The sum of the normals of the triangles at a point, each times twice its area. */
static void sum_triangles(const surface_movie *v, uint32_t step, double (*sum)[3]) {
    for (uint32_t i = 0; i < v->triangles; i++) {
        const uint32_t *t = v->corner[i];
        double e[2][3], n[3];
        for (int k = 0; k < 2; k++)
            for (int a = 0; a < 3; a++)
                e[k][a] = (double)v->xyz[step][t[k + 1]][a] - (double)v->xyz[step][t[0]][a];
        vec3_cross(e[0], e[1], n);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                sum[t[k]][a] += n[a];
    }
}

/* Compare normals with those that each point must have, which has no other at its x and y. */
static void check_normals(const surface_movie *v, uint32_t side, uint32_t step,
                          const naive_surface *n, const double (*want)[3]) {
    for (long t = 0; t < n->treelets; t++) {
        const naive_patch *p = &n->patch[t];
        assert_true(p->smooth);
        for (long i = 0; i < p->vertices; i++) {
            const uint32_t point =
                (uint32_t)(p->xyz[p->vertices + i] * (float)(side + 1) + p->xyz[i]);
            const float *got = p->normal[(n->places > 1 ? step : 0) * p->vertices + i];
            double unit[3] = {0, 0, 0};
            assert_true(point < v->points);
            (void)vec3_unit(want[point], unit);
            for (int a = 0; a < 3; a++)
                if (fabs((double)got[a] - unit[a]) > 1e-4)
                    fail_msg("step %u, point %u: %g, expected %g", step, point, (double)got[a],
                             unit[a]);
        }
    }
}

static void test_normals(void **state) {
    enum { COUNT = 24 };
    (void)state;
    for (int how = 0; how < 8; how++) {
        const int mode = 1 + how % 2, moves = how / 2 % 2;
        surface_movie v = surface_movie_make(COUNT, 1, 3, moves, "sheet");
        double(*want)[3] = malloc(v.points * sizeof *want);
        naive_surface n;
        mesh_result r;
        assert_non_null(want);
        choose_normals(&v, mode);
        compress(&v, how / 4);
        convert(&v, "normals.leaf", &r);
        assert_int_equal(r.report.normals, mode == 1 ? v.points : 0);
        verify("normals.leaf");
        surface_movie_check(&v, scratch_path("normals.leaf"));
        if (!naive_surface_load(&n, scratch_path("normals.leaf")))
            fail_msg("%s", n.why);
        for (uint32_t s = 0; s < (moves ? v.steps : 1); s++) {
            memset(want, 0, v.points * sizeof *want);
            for (uint32_t i = 0; i < v.points && mode == 1; i++) {
                float normal[3];
                surface_movie_normal(&v, s, i, normal);
                for (int a = 0; a < 3; a++)
                    want[i][a] = (double)normal[a];
            }
            if (mode == 2)
                sum_triangles(&v, s, want);
            check_normals(&v, COUNT, s, &n, (const double(*)[3])want);
        }
        naive_surface_release(&n);
        /* --normals flat leaves out those of the file. */
        v.options.normals = NORMALS_FLAT;
        convert(&v, "flat.leaf", &r);
        assert_int_equal(r.report.normals, 0);
        assert_true(naive_surface_load(&n, scratch_path("flat.leaf")));
        assert_false(n.patch[0].smooth);
        naive_surface_release(&n);
        surface_movie_release(&v);
        free(want);
    }
}

/* A later step without them is refused. */
static void test_lost_normals(void **state) {
    (void)state;
    mesh_result r;
    surface_movie v = surface_movie_make(10, 1, 2, true, "sheet"),
                  bare = surface_movie_make(10, 1, 2, true, "bare");
    surface_movie_give_normals(&v, "sheet");
    const char *kept = v.paths[1];
    v.paths[1] = bare.paths[1];
    assert_int_equal(surface_movie_convert(&m, &v, scratch_path("x.leaf"), NULL, false, &r),
                     ST_CORRUPT);
    assert_non_null(strstr(status_text(), "expected 121 normals"));
    v.paths[1] = kept;
    surface_movie_release(&v);
    surface_movie_release(&bare);
}

/* ---- steps ---- */

/* Steps whose points stay cost values alone, and may come later. */
static void test_grown(void **state) {
    (void)state;
    for (int zstd = 0; zstd < 2; zstd++) {
        mesh_result r;
        uint64_t size[2];
        surface_movie v = surface_movie_make(30, 2, 3, false, "sheet");
        const char *const *paths = v.paths;
        compress(&v, zstd);
        convert(&v, "all.leaf", &r);
        surface_movie_check(&v, scratch_path("all.leaf"));
        v.options.grows = true;
        for (uint32_t s = 0; s < 3; s++) {
            surface_movie one = v;
            one.series.of.sets.steps = one.steps = 1;
            one.paths[0] = paths[s];
            mem grow;
            mem_init(&grow, 0);
            if (s)
                assert_int_equal(
                    leaf_grow_open(&grow, scratch_path("grown.leaf"), &one.options.grow), ST_OK);
            if (surface_movie_convert(&m, &one, scratch_path("grown.leaf"), NULL, false, &r) !=
                ST_OK)
                fail_msg("step %u: %s", s, status_text());
            leaf_grow_close(one.options.grow);
            if (s < 2)
                size[s] = r.header.file_bytes;
        }
        assert_true(size[1] < size[0]);
        verify("grown.leaf");
        mem_init(&m, 0);
        leaf_file *f = NULL;
        assert_int_equal(leaf_file_open(&m, scratch_path("grown.leaf"), &f), ST_OK);
        assert_int_equal(f->header.steps, 3);
        leaf_file_close(f);
        surface_movie_release(&v);
    }
}

/* Another surface, one that moves, one of more points: each is named. */
static void test_unlike(void **state) {
    (void)state;
    mesh_result r;
    surface_movie v = surface_movie_make(10, 1, 2, false, "sheet"),
                  other = surface_movie_make(11, 1, 1, false, "other"),
                  moves = surface_movie_make(10, 1, 2, true, "moves");
    const char *sound = v.paths[1];
    v.paths[1] = other.paths[0];
    assert_int_equal(surface_movie_convert(&m, &v, scratch_path("x.leaf"), NULL, false, &r),
                     ST_CORRUPT);
    assert_non_null(strstr(status_text(), other.paths[0]));
    v.paths[1] =
        scratch_text("turned.ply", "ply\nformat ascii 1.0\nelement vertex 121\nproperty float x\n"
                                   "property float y\nproperty float z\nproperty float f0\n"
                                   "element face 1\nproperty list uchar int vertex_indices\n"
                                   "end_header\n");
    assert_int_equal(surface_movie_convert(&m, &v, scratch_path("x.leaf"), NULL, false, &r),
                     ST_CORRUPT);
    assert_non_null(strstr(status_text(), "turned.ply"));
    v.paths[1] = sound;
    moves.options.grows = true;
    assert_int_equal(surface_movie_convert(&m, &moves, scratch_path("x.leaf"), NULL, false, &r),
                     ST_USAGE);
    assert_non_null(strstr(status_text(), "points that move"));
    surface_movie_release(&v);
    surface_movie_release(&other);
    surface_movie_release(&moves);
}

/* ---- by the library ---- */

static void test_library(void **state) {
    (void)state;
    mesh_result r;
    static const char *const names[] = {"f0", "f1"};
    surface_movie v = surface_movie_make(30, 2, 3, true, "sheet");
    const leafcast_convert_options plain = {.size = sizeof plain,
                                            .replace = true,
                                            .fields = names,
                                            .field_count = 2,
                                            .treelet_tets = 100};
    convert(&v, "cli.leaf", &r);
    assert_int_equal(leafcast_convert_steps(v.paths, 3, NULL, scratch_path("lib.leaf"), &plain),
                     LEAFCAST_OK);
    surface_movie_check(&v, scratch_path("lib.leaf"));
    verify("lib.leaf");
    assert_int_equal(leafcast_convert_path(v.paths[0], scratch_path("lib.leaf"), NULL),
                     LEAFCAST_EXISTS);
    leafcast_convert_options smooth = plain;
    smooth.normals = LEAFCAST_NORMALS_SMOOTH;
    v.options.normals = NORMALS_SMOOTH;
    convert(&v, "cli.leaf", &r);
    assert_int_equal(leafcast_convert_steps(v.paths, 3, NULL, scratch_path("lib.leaf"), &smooth),
                     LEAFCAST_OK);
    naive_surface a, b;
    assert_true(naive_surface_load(&a, scratch_path("cli.leaf")));
    assert_true(naive_surface_load(&b, scratch_path("lib.leaf")) && a.patch[0].smooth);
    assert_memory_equal(a.patch[0].normal, b.patch[0].normal,
                        (size_t)(3 * a.patch[0].vertices) * sizeof *a.patch[0].normal);
    naive_surface_release(&a);
    naive_surface_release(&b);
    leafcast_convert_options without[] = {plain, plain, plain, plain};
    without[0].gradients = without[1].coarse = without[2].whole_cells = true;
    without[3].leaf_tets = 12;
    static const char *const told[] = {"gradients", "coarse", "whole_cells", "leaf_tets"};
    for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
        assert_int_equal(leafcast_convert_path(v.paths[0], scratch_path("no.leaf"), &without[i]),
                         LEAFCAST_USAGE);
        assert_non_null(strstr(leafcast_error_text(), told[i]));
    }
    surface_movie_release(&v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_budgets), cmocka_unit_test(test_resumed),
        cmocka_unit_test(test_normals), cmocka_unit_test(test_lost_normals),
        cmocka_unit_test(test_grown),   cmocka_unit_test(test_unlike),
        cmocka_unit_test(test_library),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
