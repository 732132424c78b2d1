/* test_mesh_keep.c - what is kept of a mesh's spools and sorted runs, and loaded by another run. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "prep/mesh/mesh_runs.h"
#include "prep/mesh/mesh_spool.h"
#include "tests/support/fields.h"
#include "tests/support/scratch.h"

static mem m;

/* Nothing here depends on the disk, and it takes long. */
int fsync(int fd) {
    (void)fd;
    return 0;
}

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

/* ---- spools ---- */

enum { ELEMENT = 12, SAVED = 50000, COUNT = 70000 };

static status keep_spool(void *ctx, state_io *io) {
    return mesh_spool_keep(ctx, io);
}

static mesh_spool new_spool(work_folder *w, size_t ceiling) {
    mesh_spool s;
    mesh_spool_init(&s, &m, scratch_path("s"), ELEMENT, ceiling);
    mesh_spool_keep_in(&s, w, WORK_VALUES);
    return s;
}

/* Save SAVED elements, append the others, and end. */
static void leave_spool(const char *bytes, bool in_file) {
    work_folder *w = open_work("s", WORK_REMOVE);
    mesh_spool s = new_spool(w, 0);
    if (in_file)
        assert_int_equal(mesh_spool_spill(&s), ST_OK);
    assert_int_equal(mesh_spool_append(&s, bytes, SAVED / 2), ST_OK);
    assert_int_equal(mesh_spool_store(&s), ST_OK);
    assert_int_equal(mesh_spool_append(&s, bytes + SAVED / 2 * ELEMENT, SAVED - SAVED / 2), ST_OK);
    assert_int_equal(mesh_spool_store(&s), ST_OK);
    assert_int_equal(mesh_spool_held(&s), !in_file);
    out_file *files[WORK_FILES] = {[WORK_VALUES] = mesh_spool_file(&s)};
    assert_int_equal(work_folder_save(w, files, 0.5, keep_spool, &s), ST_OK);
    assert_int_equal(mesh_spool_append(&s, bytes + SAVED * ELEMENT, COUNT - SAVED), ST_OK);
    assert_int_equal(mesh_spool_store(&s), ST_OK);
    mesh_spool_release(&s);
    assert_true(work_folder_close(w, true));
}

static void go_on_with_spool(const char *bytes, char *back, size_t ceiling, bool held) {
    work_folder *w = open_work("s", WORK_RESUME);
    mesh_spool s = new_spool(w, ceiling);
    assert_int_equal(work_folder_load(w, keep_spool, &s), ST_OK);
    assert_int_equal(s.count, SAVED);
    assert_int_equal(mesh_spool_held(&s), held);
    /* Gaps are zeros, whatever was there. */
    assert_int_equal(mesh_spool_put(&s, SAVED + 9, bytes, 1), ST_OK);
    assert_int_equal(mesh_spool_read(&s, SAVED, 9, back), ST_OK);
    for (int i = 0; i < 9 * ELEMENT; i++)
        assert_int_equal(back[i], 0);
    assert_int_equal(mesh_spool_put(&s, SAVED, bytes + SAVED * ELEMENT, COUNT - SAVED), ST_OK);
    assert_int_equal(mesh_spool_store(&s), ST_OK);
    assert_int_equal(mesh_spool_read(&s, 0, COUNT, back), ST_OK);
    assert_memory_equal(back, bytes, (size_t)COUNT * ELEMENT);
    assert_int_equal(out_file_read_at(mesh_spool_file(&s), 0, back, (size_t)COUNT * ELEMENT),
                     ST_OK);
    assert_memory_equal(back, bytes, (size_t)COUNT * ELEMENT);
    mesh_spool_release(&s);
    assert_true(work_folder_close(w, true));
}

static void test_spool(void **state) {
    (void)state;
    char *bytes = malloc((size_t)COUNT * ELEMENT), *back = malloc((size_t)COUNT * ELEMENT);
    field_random r = {FIELD_SEED};
    for (size_t i = 0; i < (size_t)COUNT * ELEMENT; i++)
        bytes[i] = (char)(1 + field_random_bits(&r) % 255);
    for (int in_file = 0; in_file < 2; in_file++) {
        leave_spool(bytes, in_file);
        go_on_with_spool(bytes, back, 0, !in_file);
        leave_spool(bytes, in_file);
        go_on_with_spool(bytes, back, 1 << 19, false);
        leave_spool(bytes, in_file);
        assert_int_equal(truncate(work_path("s", "values"), SAVED * ELEMENT - 1), 0);
        work_folder *w = open_work("s", WORK_RESUME);
        mesh_spool s = new_spool(w, 0);
        assert_int_equal(work_folder_load(w, keep_spool, &s), ST_CORRUPT);
        mesh_spool_release(&s);
        assert_false(work_folder_close(w, false));
        assert_int_equal(mem_used(&m), 0);
        assert_int_equal(scratch_count(), 0);
    }
    free(bytes);
    free(back);
}

/* ---- runs ---- */

enum { RECORDS = 30000 };

typedef struct kept_runs {
    mesh_runs *r;
    uint64_t done; /* records that were put, later used */
    size_t used;   /* of the window */
    bool ended;
} kept_runs;

static status keep_runs(void *ctx, state_io *io) {
    kept_runs *k = ctx;
    status st = STATE_IO(io, k->done);
    if (st == ST_OK)
        st = mesh_runs_keep(k->r, io);
    return st == ST_OK && k->ended ? mesh_runs_keep_place(k->r, k->used, io) : st;
}

static void save_runs(work_folder *w, kept_runs *k) {
    out_file *files[WORK_FILES] = {0};
    assert_true(mesh_runs_written(k->r));
    assert_int_equal(mesh_runs_store(k->r), ST_OK);
    files[WORK_RUNS] = mesh_runs_file(k->r);
    assert_int_equal(work_folder_save(w, files, 0.5, keep_runs, k), ST_OK);
}

static void put_some(mesh_runs *r, const mesh_record *from, size_t count) {
    while (count > 0) {
        size_t room;
        mesh_record *to = mesh_runs_room(r, &room);
        const size_t some = room < count ? room : count;
        memcpy(to, from, some * sizeof *to);
        assert_int_equal(mesh_runs_put(r, some), ST_OK);
        from += some;
        count -= some;
    }
}

static kept_runs new_runs(pool *p, work_folder *w, const mesh_runs_plan *plan) {
    kept_runs k = {0};
    assert_int_equal(mesh_runs_create(&m, p, scratch_path("r"), plan, &k.r), ST_OK);
    mesh_runs_keep_in(k.r, w);
    return k;
}

static work_folder *end_and_open(work_folder *w, kept_runs *k) {
    mesh_runs_destroy(k->r);
    assert_true(work_folder_close(w, true));
    return open_work("r", WORK_RESUME);
}

/* Records that have the same key are told apart by their first id. */
static mesh_record *some_records(void) {
    mesh_record *records = malloc(RECORDS * sizeof *records);
    field_random r = {FIELD_SEED};
    for (uint32_t i = 0; i < RECORDS; i++)
        records[i] = (mesh_record){.key = field_random_bits(&r) % 9999, .id = {i, 1, 2, 3}};
    return records;
}

static int compare_records(const void *a, const void *b) {
    const mesh_record *x = a, *y = b;
    return x->key != y->key ? (x->key < y->key ? -1 : 1) : (x->id[0] < y->id[0] ? -1 : 1);
}

/* Interrupted after so many runs, and after every window. */
static void interrupt_runs(pool *p, const mesh_runs_plan *plan, const mesh_record *records,
                           const mesh_record *sorted, uint64_t runs) {
    work_folder *w = open_work("r", WORK_REMOVE);
    kept_runs k = new_runs(p, w, plan);
    if (runs > 0) {
        k.done = runs * plan->run;
        put_some(k.r, records, (size_t)k.done);
        save_runs(w, &k);
        assert_int_equal(mesh_runs_left(k.r), k.done);
        put_some(k.r, records + k.done, RECORDS / 5);
        w = end_and_open(w, &k);
        k = new_runs(p, w, plan);
        assert_int_equal(work_folder_load(w, keep_runs, &k), ST_OK);
        assert_int_equal(k.done, runs * plan->run);
    }
    put_some(k.r, records + k.done, RECORDS - (size_t)k.done);
    assert_int_equal(mesh_runs_end(k.r), ST_OK);
    k.ended = true;
    field_random random = {FIELD_SEED + runs};
    for (k.done = 0; k.done < RECORDS;) {
        const mesh_record *seen;
        size_t count;
        bool last;
        assert_int_equal(mesh_runs_window(k.r, k.used, &seen, &count, &last), ST_OK);
        assert_int_equal(mesh_runs_left(k.r), RECORDS - k.done);
        assert_memory_equal(seen, sorted + k.done, count * sizeof *seen);
        k.used = 1 + field_random_bits(&random) % count;
        k.done += k.used;
        save_runs(w, &k);
        w = end_and_open(w, &k);
        k = new_runs(p, w, plan);
        k.ended = true;
        assert_int_equal(work_folder_load(w, keep_runs, &k), ST_OK);
    }
    mesh_runs_destroy(k.r);
    assert_true(work_folder_close(w, true));
    if (plan->block) {
        assert_int_equal(truncate(work_path("r", "runs"), RECORDS * 24 - 1), 0);
        w = open_work("r", WORK_RESUME);
        k = new_runs(p, w, plan);
        assert_int_equal(work_folder_load(w, keep_runs, &k), ST_CORRUPT);
        mesh_runs_destroy(k.r);
        assert_true(work_folder_close(w, true));
    }
    assert_false(work_folder_close(open_work("r", WORK_REMOVE), false));
}

static void test_runs(void **state) {
    (void)state;
    mesh_record *records = some_records(), *sorted = some_records();
    qsort(sorted, RECORDS, sizeof *sorted, compare_records);
    pool *p;
    assert_int_equal(pool_create(&m, 2, &p), ST_OK);
    const mesh_runs_plan one = mesh_runs_plan_make(RECORDS, 1000, UINT64_MAX, UINT64_MAX),
                         least = mesh_runs_plan_make(RECORDS, 1000, 0, 0);
    assert_true(!one.block && least.block && least.run < RECORDS / 4);
    interrupt_runs(p, &one, records, sorted, 0);
    for (uint64_t runs = 0; runs < 4; runs++)
        interrupt_runs(p, &least, records, sorted, runs);
    pool_destroy(p);
    free(records);
    free(sorted);
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(scratch_count(), 0);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_spool, set_up),
        cmocka_unit_test_setup(test_runs, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
