/* test_mesh_resume.c - conversions of meshes that end early, anywhere, and are gone on with: the
 * same bytes in the end. */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/partial.h"
#include "tests/support/disk_calls.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

static work_folder *open_work(const char *name, work_found found) {
    work_folder *w = NULL;
    if (work_folder_open(&m, scratch_path(name), found, 0, &w) != ST_OK)
        fail_msg("%s", status_text());
    return w;
}

static const char *work_path(const char *output, const char *part) {
    char name[64];
    snprintf(name, sizeof name, "%s.unfinished/%s", output, part);
    return scratch_path(name);
}

/* ---- conversions ---- */

enum { STEPS = 3 };

/* A mesh of some steps, in files. */
typedef struct job {
    mesh_case c;
    uint32_t steps;
    const char *paths[STEPS];
    mesh_series series;
    long asked, end; /* questions whether to go on; from number `end` on: no. 0: always */
} job;

static const char *write_step(const mesh_case *c, uint32_t step) {
    char name[32];
    snprintf(name, sizeof name, "step%u.mesh", step);
    const char *path = scratch_path(name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    fprintf(f, "LEAFCAST MESH 1\nname: it\nfield: one\npoints: %zu\ntets: %zu\n\n", c->point_count,
            c->tet_count);
    for (size_t i = 0; i < c->point_count; i++) {
        const float at[3] = {c->points[i][0], c->points[i][1],
                             c->points[i][2] + (step > 1 ? 0.1f * (float)step : 0)};
        assert_int_equal(fwrite(at, sizeof at, 1, f), 1);
    }
    for (size_t i = 0; i < c->point_count; i++) {
        const float value = c->values[i] + 3 * (float)step;
        assert_int_equal(fwrite(&value, sizeof value, 1, f), 1);
    }
    assert_int_equal(fwrite(c->tets, sizeof *c->tets, c->tet_count, f), c->tet_count);
    assert_int_equal(fclose(f), 0);
    return path;
}

static void make_job(job *j, uint32_t size, uint32_t steps, bool compressed) {
    *j = (job){.c = mesh_cases_kuhn(size, size, size), .steps = steps};
    mesh_cases_shuffle(&j->c, 3);
    for (uint32_t s = 0; s < steps; s++)
        j->paths[s] = write_step(&j->c, s);
    j->series = (mesh_series){.of = {.paths = j->paths, .sets = {.fields = 1, .steps = steps}}};
    mesh_options *o = &j->c.options;
    o->series = &j->series;
    o->treelet_tets = 300;
    o->gradients = true;
    if (compressed) {
        o->file.codec = LEAF_CODEC_ZSTD;
        o->file.zstd_level = 1;
    }
}

static void free_job(job *j) {
    for (uint32_t s = 0; s < j->steps; s++)
        assert_int_equal(remove(j->paths[s]), 0);
    mesh_cases_free(&j->c);
}

static bool is_enough(void *ctx) {
    job *j = ctx;
    const long asked = __atomic_add_fetch(&j->asked, 1, __ATOMIC_RELAXED);
    return j->end > 0 && asked >= j->end;
}

/* Convert to a scratch file, in one go or with what is there. */
static status convert(job *j, const char *name, bool kept, mesh_result *result) {
    const progress p = {.stop = is_enough, .ctx = j};
    const char *path = scratch_path(name);
    mesh_options o = j->c.options;
    convert_job text = {0};
    mesh_input *x = NULL;
    m.limit = (size_t)o.memory;
    j->asked = 0;
    status st = mesh_input_open(&m, j->paths[0], &j->series.hints, &x);
    if (st == ST_OK && kept) {
        o.job = &text;
        st = convert_job_init(&text, &m, path);
        if (st == ST_OK)
            st = work_folder_open(&m, path, WORK_RESUME, 0, &o.work);
    }
    if (st == ST_OK)
        st = mesh_convert_run(&m, x, path, &o, &p, result);
    (void)work_folder_close(o.work, st != ST_OK);
    convert_job_release(&text);
    mesh_input_close(x);
    assert_int_equal(mem_used(&m), 0);
    m.limit = 0;
    return st;
}

static void convert_whole(job *j, const char *name, bool kept) {
    mesh_result r;
    j->end = 0;
    if (convert(j, name, kept, &r) != ST_OK)
        fail_msg("%s: %s", name, status_text());
}

static void set_least_memory(job *j) {
    mesh_input *x = NULL;
    mesh_result r;
    assert_int_equal(mesh_input_open(&m, j->paths[0], &j->series.hints, &x), ST_OK);
    assert_int_equal(mesh_convert_dry(&m, x, &j->c.options, NULL, &r), ST_OK);
    mesh_input_close(x);
    j->c.options.memory = r.plan.memory_least + (3 << 17);
}

static void check_same(job *j, const char *what, long k) {
    char text[64];
    snprintf(text, sizeof text, "%s %ld", what, k);
    convert_whole(j, "y.leaf", true);
    scratch_same(text, scratch_path("whole.leaf"), scratch_path("y.leaf"));
    assert_int_equal(remove(scratch_path("y.leaf")), 0);
    assert_int_equal(scratch_count(), j->steps + 1);
}

static void prepare(job *j, uint32_t size, uint32_t steps, bool compressed) {
    make_job(j, size, steps, compressed);
    set_least_memory(j);
    convert_whole(j, "whole.leaf", false);
}

static void finish(job *j) {
    free_job(j);
    assert_int_equal(remove(scratch_path("whole.leaf")), 0);
    assert_int_equal(scratch_count(), 0);
}

/* Stopped at any question; then going on. */
static void test_stopped(void **state) {
    (void)state;
    for (uint32_t steps = WATCHED_THREADS ? STEPS : 1; steps <= STEPS; steps += 2) {
        job j;
        mesh_result r;
        prepare(&j, WATCHED ? 18 : 30, steps, steps > 1);
        int ends = 0, saved = 0;
        for (long k = 1;; k += 1 + k / (SLOW ? 3 : 6)) {
            j.end = k;
            if (convert(&j, "y.leaf", true, &r) == ST_OK)
                break;
            ends++;
            saved += access(work_path("y.leaf", "state-0"), F_OK) == 0;
            check_same(&j, "stopped at question", k);
        }
        assert_int_equal(remove(scratch_path("y.leaf")), 0);
        assert_true(ends > 6 && saved > 2 && r.plan.spill_bytes > 0);
        finish(&j);
    }
}

/* Stopped again and again, each time a bit later. What comes after the last treelet is not saved.
 */
static void test_by_and_by(void **state) {
    (void)state;
    skip_under_thread();
    job j;
    mesh_result r;
    prepare(&j, WATCHED ? 18 : 30, STEPS, true);
    convert_whole(&j, "y.leaf", true);
    const long all = j.asked;
    assert_int_equal(remove(scratch_path("y.leaf")), 0);
    int runs = 0;
    for (status st = ST_STOPPED; st != ST_OK; runs++) {
        j.end = all * (runs + 1) / 12;
        st = convert(&j, "y.leaf", true, &r);
        assert_true(runs < 12 && (st == ST_OK || st == ST_STOPPED));
    }
    assert_true(runs > 3);
    scratch_same("by and by", scratch_path("whole.leaf"), scratch_path("y.leaf"));
    assert_int_equal(remove(scratch_path("y.leaf")), 0);
    finish(&j);
}

/* Each operation fails once: while there is nothing yet, and while a run goes on. */
static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE, FAULT_READ, FAULT_THREAD};
    job j;
    mesh_result r;
    prepare(&j, 12, 2, false);
    convert_whole(&j, "y.leaf", true);
    const long all = j.asked;
    assert_int_equal(remove(scratch_path("y.leaf")), 0);
    for (size_t n = 0; n < sizeof kinds / sizeof kinds[0]; n++)
        for (long first = WATCHED_THREADS; first < (WATCHED ? 2 : 3); first++) {
            bool fired = true;
            for (long k = 1; fired; k += 1 + k / (WATCHED ? 1 : SLOW ? 2 : 6)) {
                if (first > 0) {
                    j.end = all * first / 3;
                    assert_int_equal(convert(&j, "y.leaf", true, &r), ST_STOPPED);
                }
                j.end = 0;
                fault_arm(kinds[n], k);
                const status st = convert(&j, "y.leaf", true, &r);
                fired = fault_fired(kinds[n]);
                fault_arm(kinds[n], 0);
                assert_true(st == ST_OK || fired);
                if (st == ST_OK)
                    assert_int_equal(remove(scratch_path("y.leaf")), 0);
                check_same(&j, "after fault", k);
            }
        }
    finish(&j);
}

/* ---- crashes ---- */

/* What a crash leaves is nothing, work that goes on to the same bytes, or the whole file. Returns
 * whether it was work. seed: 0: killed, else power was lost. */
static bool check_crash(job *j, size_t count, uint64_t seed) {
    mesh_result r;
    uint64_t bytes;
    bool goes_on = false;
    assert_int_equal(mkdir(scratch_path("crash"), 0777), 0);
    disk_log_replay(count, seed, scratch_path("crash"));
    if (access(scratch_path("crash/x.leaf"), F_OK) != 0) {
        work_folder *w = open_work("crash/x.leaf", WORK_RESUME);
        goes_on = work_folder_resumes(w);
        (void)work_folder_close(w, true);
        if (convert(j, "crash/x.leaf", true, &r) != ST_OK)
            fail_msg("after %zu calls, seed %llu: %s", count, (unsigned long long)seed,
                     status_text());
    }
    scratch_same("after a crash", scratch_path("whole.leaf"), scratch_path("crash/x.leaf"));
    assert_true(partial_remove_folder(scratch_path("crash"), &bytes));
    return goes_on;
}

static void test_crashes(void **state) {
    (void)state;
    skip_under_thread();
    enum { MOMENTS = SLOW ? 20 : 90, CHANCES = WATCHED ? 1 : 3 };
    for (uint32_t steps = 1; steps <= STEPS; steps += 2) {
        job j;
        uint64_t bytes, work = 0;
        prepare(&j, 16, steps, steps > 1);
        if (steps > 1)
            j.c.options.memory = (uint64_t)1 << 30;
        assert_int_equal(mkdir(scratch_path("disk"), 0777), 0);
        disk_log_begin(scratch_path("disk"));
        convert_whole(&j, "disk/x.leaf", true);
        const size_t calls = disk_log_end();
        assert_true(calls > MOMENTS);
        for (size_t n = 0; n <= MOMENTS; n++)
            for (uint64_t chance = 0; chance <= CHANCES; chance++)
                work += check_crash(&j, calls * n / MOMENTS, chance ? n * CHANCES + chance : 0);
        assert_true(work > MOMENTS);
        disk_log_release();
        assert_true(partial_remove_folder(scratch_path("disk"), &bytes));
        finish(&j);
    }
}

/* ---- files that have changed, other budgets ---- */

/* Damage a file of the unfinished work: half of it gone, or a quarter overwritten. */
static void damage(const char *part, int how) {
    char name[64];
    snprintf(name, sizeof name, "y.leaf.unfinished/%s", part);
    size_t size;
    char *bytes = scratch_read(scratch_path(name), &size);
    if (how > 0)
        memset(bytes + size / 2, how == 1 ? 0xff : 0, size / 4);
    (void)scratch_write(name, bytes, how > 0 ? size : size / 2);
    free(bytes);
}

/* An error or a file, but never a wild access. */
static void test_damaged(void **state) {
    (void)state;
    skip_under_thread();
    static const char *const files[] = {"points", "values", "tets", "runs", "gradients"};
    job j;
    mesh_result r;
    prepare(&j, 18, STEPS, false);
    convert_whole(&j, "y.leaf", true);
    const long all = j.asked;
    assert_int_equal(remove(scratch_path("y.leaf")), 0);
    int refused = 0;
    for (int part = 1; part < 16; part += WATCHED ? 4 : 2)
        for (size_t f = 0; f < sizeof files / sizeof files[0]; f++)
            for (int how = 0; how < 3; how++) {
                j.end = all * part / 16;
                assert_int_equal(convert(&j, "y.leaf", true, &r), ST_STOPPED);
                if (access(work_path("y.leaf", files[f]), F_OK) == 0)
                    damage(files[f], how);
                j.end = 0;
                const status st = convert(&j, "y.leaf", true, &r);
                assert_true(st == ST_OK || st == ST_CORRUPT);
                refused += st == ST_CORRUPT;
                if (st == ST_OK)
                    assert_int_equal(remove(scratch_path("y.leaf")), 0);
                (void)work_folder_close(open_work("y.leaf", WORK_REMOVE), false);
            }
    assert_true(refused > 10);
    finish(&j);
}

static void test_budgets(void **state) {
    (void)state;
    job j;
    mesh_result r;
    prepare(&j, 18, STEPS, false);
    const uint64_t memory = j.c.options.memory;
    convert_whole(&j, "y.leaf", true);
    const long all = j.asked;
    assert_int_equal(remove(scratch_path("y.leaf")), 0);
    for (int threads = WATCHED_THREADS ? 3 : 1; threads < 5; threads++) {
        j.end = all * 2 / 3;
        j.c.options.threads = 2;
        assert_int_equal(convert(&j, "y.leaf", true, &r), ST_STOPPED);
        j.c.options.memory = r.plan.memory - 1;
        assert_int_equal(convert(&j, "y.leaf", true, &r), ST_NOMEM);
        assert_non_null(strstr(status_text(), "is too small"));
        j.c.options.memory = threads % 2 ? memory : memory << 4;
        j.c.options.threads = threads;
        check_same(&j, "threads", threads);
        j.c.options.memory = memory;
    }
    finish(&j);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_stopped, set_up),
        cmocka_unit_test_setup(test_by_and_by, set_up),
        cmocka_unit_test_setup(test_faults, set_up),
        cmocka_unit_test_setup(test_crashes, set_up),
        cmocka_unit_test_setup(test_damaged, set_up),
        cmocka_unit_test_setup(test_budgets, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
