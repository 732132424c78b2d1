/* test_mesh_series.c - meshes of several steps and fields: what the file holds is what the inputs
 * do, whatever the budget and the threads; steps that are unlike the first are refused. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_verify.h"
#include "tests/support/fields.h"
#include "tests/support/mesh_movies.h"
#include "tests/support/mesh_truth.h"
#include "tests/support/naive_mesh.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

static status convert(mesh_movie *v, const char *name, mesh_result *r, bool dry) {
    const status st = mesh_movies_convert(&m, v, scratch_path(name), r, dry);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static void convert_sound(mesh_movie *v, const char *name, mesh_result *r) {
    if (convert(v, name, r, false) != ST_OK)
        fail_msg("%s: %s", name, status_text());
}

/* ---- what is in the file ---- */

/* The input's point that is a treelet's vertex; first-step places are all different. */
static size_t point_of(const mesh_movie *v, const float at[3]) {
    const mesh_case *c = &v->c;
    for (size_t i = 0; i < c->point_count; i++)
        if (memcmp(c->points[i], at, sizeof *c->points) == 0)
            return i;
    fail_msg("a vertex at %g %g %g that is no point", (double)at[0], (double)at[1], (double)at[2]);
    return 0;
}

static void check_vertices(const mesh_movie *v, const naive_mesh *loaded, const naive_part *p) {
    for (long i = 0; i < p->vertices; i++) {
        const size_t id = point_of(v, p->positions[i]);
        for (uint32_t s = 0; s < v->steps; s++) {
            const float *at = p->positions[(loaded->places > 1 ? s : 0) * p->vertices + i];
            assert_memory_equal(at, v->points[s][id], sizeof(float[3]));
            for (uint32_t f = 0; f < v->fields; f++)
                assert_memory_equal(&p->values[(f * v->steps + s) * p->vertices + i],
                                    &v->values[s][f][id], sizeof(float));
        }
    }
}

/* Each field's at each step, of the tets as they stand at that step. */
static void check_gradients(const mesh_movie *v, const naive_mesh *loaded) {
    for (uint32_t f = 0; f < v->fields; f++) {
        for (uint32_t s = 0; s < v->steps; s++) {
            mesh_case c = v->c;
            c.points = v->points[s];
            c.values = v->values[s][f];
            mesh_truth *all = mesh_truth_gradients(&c);
            for (long t = 0; t < loaded->treelets; t++) {
                const naive_part *p = &loaded->part[t];
                const float(*got)[3] = (const float(*)[3])p->gradients;
                assert_non_null(got);
                for (long i = 0; i < p->vertices; i++) {
                    const size_t id = point_of(v, p->positions[i]);
                    mesh_truth_check(&all[id], got[(f * v->steps + s) * p->vertices + i], id);
                }
            }
            free(all);
        }
    }
}

static void check_file(const mesh_movie *v, const char *name, bool moving) {
    naive_mesh loaded;
    if (!naive_mesh_load(&loaded, scratch_path(name)))
        fail_msg("%s: %s", name, loaded.why);
    assert_int_equal(loaded.steps, v->steps);
    assert_int_equal(loaded.fields, v->fields);
    assert_int_equal(loaded.places, moving ? v->steps : 1);
    assert_int_equal(loaded.tets, v->c.tet_count);
    for (uint32_t f = 0; f < v->fields; f++)
        assert_string_equal(loaded.names[f], v->names[f]);
    if (v->steps > 1)
        assert_memory_equal(loaded.times, v->times, v->steps * sizeof *v->times);
    for (long t = 0; t < loaded.treelets; t++)
        check_vertices(v, &loaded, &loaded.part[t]);
    if (v->c.options.gradients)
        check_gradients(v, &loaded);
    naive_mesh_release(&loaded);
    leaf_file *f;
    assert_int_equal(leaf_file_open(&m, scratch_path(name), &f), ST_OK);
    if (leaf_verify(&m, f, 2, NULL) != ST_OK)
        fail_msg("%s: %s", name, status_text());
    leaf_file_close(f);
}

/* Points that move at once, late, from the middle of a step on, and never. */
static void test_series(void **state) {
    (void)state;
    static const struct {
        uint32_t fields, steps, moves;
        size_t same;
    } cases[] = {{1, 2, 1, 0}, {1, 4, 2, 101}, {1, 3, 9, 0}, {1, 8, 7, 383},
                 {3, 1, 9, 0}, {3, 2, 9, 0},   {2, 3, 1, 5}, {1, 1, 9, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i += WATCHED_THREADS ? 3 : 1) {
        mesh_case c = mesh_cases_kuhn(7, 7, 5);
        mesh_cases_shuffle(&c, i + 1);
        c.options.treelet_tets = i % 2 ? 200 : 4096;
        c.options.gradients = i > 0;
        c.options.file.codec = i % 3 ? LEAF_CODEC_RAW : LEAF_CODEC_ZSTD;
        c.options.file.zstd_level = 1;
        mesh_movie v =
            mesh_movies_make(c, cases[i].fields, cases[i].steps, cases[i].moves, cases[i].same);
        mesh_result r;
        mesh_movies_write(&v);
        convert_sound(&v, "series.leaf", &r);
        check_file(&v, "series.leaf", cases[i].moves < cases[i].steps);
        mesh_movies_release(&v);
    }
}

/* ---- the same bytes ---- */

static void check_same(const char *a, const char *b) {
    size_t sizes[2];
    char *x = scratch_read(scratch_path(a), &sizes[0]),
         *y = scratch_read(scratch_path(b), &sizes[1]);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(x, y, sizes[0]);
    free(x);
    free(y);
}

/* As little memory as will do, where all goes through scratch files; and threads. */
static void test_same_bytes(void **state) {
    (void)state;
    mesh_case c = mesh_cases_kuhn(30, 30, 30);
    mesh_cases_shuffle(&c, 3);
    c.options.treelet_tets = 300;
    mesh_movie v = mesh_movies_make(c, 1, 4, 1, 999);
    mesh_result r;
    mesh_movies_write(&v);
    convert_sound(&v, "first.leaf", &r);
    assert_int_equal(r.plan.spill_bytes, 0);
    bool spilled = false;
    for (int threads = 1; threads < 5; threads += 3) {
        v.c.options.threads = threads;
        v.c.options.memory = (uint64_t)1 << 30;
        convert_sound(&v, "again.leaf", &r);
        check_same("first.leaf", "again.leaf");
        assert_int_equal(convert(&v, "", &r, true), ST_OK);
        v.c.options.memory = r.plan.memory_least + (1 << 18);
        convert_sound(&v, "again.leaf", &r);
        check_same("first.leaf", "again.leaf");
        spilled |= r.plan.spill_points;
    }
    assert_true(spilled);
    mesh_movies_release(&v);
}

/* ---- what is refused ---- */

static void check_refused(mesh_movie *v, status want, const char *said, const char *also) {
    mesh_result r;
    const size_t before = scratch_count();
    const status st = convert(v, "refused.leaf", &r, false);
    if (st != want || !strstr(status_text(), said) || !strstr(status_text(), also))
        fail_msg("expected \"%s\" and \"%s\", found %d: %s", said, also, st,
                 st ? status_text() : "");
    assert_int_equal(scratch_count(), before);
}

static void test_refused(void **state) {
    (void)state;
    skip_under_thread();
    mesh_movie v = mesh_movies_make(mesh_cases_kuhn(12, 12, 12), 1, 3, 2, 50);
    mesh_movie other = mesh_movies_make(mesh_cases_kuhn(12, 12, 11), 1, 3, 9, 0);
    mesh_movies_write(&v);
    /* A tet with its vertices in another order; the last one, too; one less. */
    for (int last = 0; last < 2; last++) {
        const size_t tet = last ? v.c.tet_count - 1 : 5432;
        char said[64];
        uint32_t *ids = v.c.tets[tet], first = ids[0];
        ids[0] = ids[1];
        ids[1] = first;
        snprintf(said, sizeof said, "tet %zu has the vertices %u, %u", tet, ids[0], ids[1]);
        v.paths[1] = mesh_movies_stream(&v, 1, "other.mesh", v.c.tet_count);
        check_refused(&v, ST_CORRUPT, said, "other.mesh: ");
        ids[1] = ids[0];
        ids[0] = first;
    }
    v.paths[1] = mesh_movies_stream(&v, 1, "other.mesh", v.c.tet_count - 1);
    check_refused(&v, ST_CORRUPT, "expected 10368 tets", "found 10367");
    v.paths[1] = mesh_movies_stream(&other, 1, "other.mesh", other.c.tet_count);
    check_refused(&v, ST_CORRUPT, "expected 2197 points", "step0.mesh has, found 2028");
    v.paths[0] = v.paths[1];
    v.paths[1] = mesh_movies_stream(&v, 1, "more.mesh", v.c.tet_count);
    check_refused(&v, ST_CORRUPT, "more.mesh: expected 2028 points", "found more");
    mesh_movies_write(&v);
    v.names[0] = "none";
    check_refused(&v, ST_USAGE, "\"none\"", "step0.mesh");
    v.series.of.sets.names = NULL;
    v.paths[2] = scratch_text("x.mesh", "LEAFCAST MESH 1\npoints: 0\ntets: 0\n\n");
    check_refused(&v, ST_USAGE, "\"one\"", "x.mesh");
    v.paths[2] = scratch_path("not-there.mesh");
    check_refused(&v, ST_IO, "not-there.mesh", "");
    v.paths[2] = "-";
    check_refused(&v, ST_USAGE, "standard input", "");
    v.paths[2] = v.paths[0];
    v.times[2] = v.times[1];
    check_refused(&v, ST_USAGE, "must ascend", "step 2");
    mesh_movies_release(&v);
    mesh_movies_release(&other);
}

static void test_twice(void **state) {
    (void)state;
    skip_under_thread();
    mesh_movie v = mesh_movies_make(mesh_cases_kuhn(2, 2, 2), 3, 1, 9, 0);
    mesh_movies_write(&v);
    v.names[2] = v.names[1];
    check_refused(&v, ST_USAGE, "\"another\" is given twice", "");
    v.series.of.sets.fields = 300;
    v.series.of.sets.steps = 300;
    check_refused(&v, ST_UNSUPPORTED, "300 fields at 300 steps", "");
    mesh_movies_release(&v);
}

/* Points that no tet has may have any value: the file has nothing of them. */
static void test_unused(void **state) {
    (void)state;
    skip_under_thread();
    mesh_movie v = mesh_movies_make(mesh_cases_kuhn(3, 3, 3), 1, 2, 9, 0);
    mesh_result r;
    leaf_file *f;
    v.c.tet_count = 6; /* of the first cell */
    for (uint32_t s = 0; s < v.steps; s++)
        for (size_t i = 2; i < v.c.point_count; i++)
            if (i != 4 && i != 5 && i != 16 && i != 17 && i != 20 && i != 21)
                v.values[s][0][i] = i % 2 ? NAN : INFINITY;
    v.values[1][0][5] = NAN;
    mesh_movies_write(&v);
    convert_sound(&v, "unused.leaf", &r);
    assert_int_equal(r.header.vertices, 8);
    assert_int_equal(r.header.non_finite, 1);
    assert_int_equal(leaf_file_open(&m, scratch_path("unused.leaf"), &f), ST_OK);
    assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_OK);
    leaf_file_close(f);
    mesh_movies_release(&v);
}

/* Each operation fails once: an error and nothing left. */
static void test_faults(void **state) {
    (void)state;
    skip_under_thread();
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE, FAULT_READ, FAULT_THREAD};
    mesh_case c = mesh_cases_kuhn(14, 14, 14);
    c.options.treelet_tets = 64;
    c.options.threads = 1;
    mesh_movie v = mesh_movies_make(c, 1, 3, 2, 50);
    mesh_result r;
    mesh_movies_write(&v);
    assert_int_equal(convert(&v, "", &r, true), ST_OK);
    v.c.options.memory = r.plan.memory_least + (1 << 16);
    for (size_t n = 0; n < sizeof kinds / sizeof kinds[0]; n++) {
        long step = 1;
        for (long k = 1;; k += step) {
            const size_t before = scratch_count();
            fault_arm(kinds[n], k);
            const status st = convert(&v, "fault.leaf", &r, false);
            const bool fired = fault_fired(kinds[n]);
            fault_arm(kinds[n], 0);
            assert_true(st == ST_OK || fired);
            if (st == ST_OK)
                assert_int_equal(remove(scratch_path("fault.leaf")), 0);
            assert_int_equal(scratch_count(), before);
            if (!fired)
                break;
            /* Thousands of reads are alike. */
            step += k > 60 ? 1 + k / 8 : 0;
        }
    }
    mesh_movies_release(&v);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_series, set_up),
        cmocka_unit_test_setup(test_same_bytes, set_up),
        cmocka_unit_test_setup(test_refused, set_up),
        cmocka_unit_test_setup(test_twice, set_up),
        cmocka_unit_test_setup(test_unused, set_up),
        cmocka_unit_test_setup(test_faults, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
