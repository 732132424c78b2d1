/* test_mesh_sort.c - keys, sorting in memory and in runs, cutting: against plain versions of each.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/mesh/mesh_morton.h"
#include "prep/mesh/mesh_cut.h"
#include "prep/mesh/mesh_pages.h"
#include "prep/mesh/mesh_runs.h"
#include "tests/support/fields.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

/* ---- keys ---- */

static void test_morton(void **state) {
    (void)state;
    skip_under_thread();
    field_random r = {FIELD_SEED};
    for (int n = 0; n < 1000; n++) {
        const uint64_t x = field_random_bits(&r) & 0x1fffff;
        uint64_t slow = 0;
        for (int bit = 0; bit < 21; bit++)
            slow |= (x >> bit & 1) << 3 * bit;
        assert_int_equal(mesh_morton_spread(x), slow);
        const uint64_t a = field_random_bits(&r) >> 1, b = a ^ UINT64_C(1) << n % 63;
        assert_int_equal(mesh_morton_common(a, b), 62 - n % 63);
        assert_int_equal(mesh_morton_common(a, a), 63);
    }
    /* A corner, the one across, and the middle; the longest edge sets the scale. */
    const float bounds[6] = {-1, 2, 5, 3, 4, 5};
    const mesh_lattice l = mesh_lattice_of(bounds);
    const float low[4][3] = {{-1, 2, 5}, {-1, 2, 5}, {-1, 2, 5}, {-1, 2, 5}};
    const float high[4][3] = {{3, 4, 5}, {3, 4, 5}, {3, 4, 5}, {3, 4, 5}};
    const float middle[4][3] = {{-1, 2, 5}, {3, 4, 5}, {3, 2, 5}, {-1, 4, 5}};
    assert_int_equal(mesh_morton_key(&l, low), 0);
    assert_int_equal(mesh_morton_key(&l, high),
                     mesh_morton_spread(0x1fffff) | mesh_morton_spread(0x100000) << 1);
    assert_int_equal(mesh_morton_key(&l, middle),
                     mesh_morton_spread(0x100000) | mesh_morton_spread(0x080000) << 1);
    const float point[6] = {7, 7, 7, 7, 7, 7}, tiny[6] = {0, 0, 0, 1e-45f, 0, 0};
    const mesh_lattice none = mesh_lattice_of(point), least = mesh_lattice_of(tiny);
    const float there[4][3] = {{7, 7, 7}, {7, 7, 7}, {7, 7, 7}, {7, 7, 7}};
    const float end[4][3] = {{1e-45f, 0, 0}, {1e-45f, 0, 0}, {1e-45f, 0, 0}, {1e-45f, 0, 0}};
    assert_int_equal(mesh_morton_key(&none, there), 0);
    assert_int_equal(mesh_morton_key(&least, end), mesh_morton_spread(0x1fffff));
}

/* ---- sorting ---- */

enum { SHAPES = 6 };

/* Keys spread out, crowded, all the same, of few bits, in order, and nearly all in one place. */
static mesh_record *random_records(size_t count, int shape, uint64_t seed) {
    mesh_record *records = malloc((count ? count : 1) * sizeof *records);
    field_random r = {seed};
    for (size_t i = 0; i < count; i++) {
        const uint64_t bits = field_random_bits(&r) >> 1;
        uint64_t key = bits;
        if (shape == 1)
            key = bits % 1000;
        if (shape == 2)
            key = UINT64_C(0x123456789abcdef);
        if (shape == 3)
            key = (bits & 3) << 40 | (bits >> 60);
        if (shape == 4)
            key = i * 1000;
        if (shape == 5)
            key = bits % 100 ? bits % (1 << 20) : bits;
        records[i] = (mesh_record){.key = key, .id = {(uint32_t)i, (uint32_t)(i >> 5), 0, 7}};
    }
    return records;
}

static int compare_records(const void *a, const void *b) {
    const mesh_record *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->id[0] < y->id[0] ? -1 : x->id[0] > y->id[0];
}

static const size_t COUNTS[] = {0, 1, 2, 24, 25, 300, 32767, 32768, 100000, 300001};
enum { COUNT_COUNT = sizeof COUNTS / sizeof COUNTS[0] };

static void test_sort(void **state) {
    (void)state;
    for (int threads = 1; threads <= 5; threads += 2) {
        pool *p;
        mesh_sort *s;
        assert_int_equal(pool_create(&m, threads, &p), ST_OK);
        const size_t before = mem_used(&m);
        assert_int_equal(mesh_sort_create(&m, p, &s), ST_OK);
        assert_true(mem_used(&m) - before <= mesh_sort_memory(threads));
        for (int i = 0; i < COUNT_COUNT; i++)
            for (int shape = 0; shape < SHAPES; shape++) {
                const size_t n = COUNTS[i];
                mesh_record *got = random_records(n, shape, FIELD_SEED + (uint64_t)i);
                mesh_record *expected = random_records(n, shape, FIELD_SEED + (uint64_t)i);
                mesh_record *spare = malloc((n ? n : 1) * sizeof *spare);
                qsort(expected, n, sizeof *expected, compare_records);
                assert_int_equal(mesh_sort_records(s, got, spare, n), ST_OK);
                assert_memory_equal(got, expected, n * sizeof *got);
                free(got);
                free(expected);
                free(spare);
            }
        mesh_sort_destroy(s);
        pool_destroy(p);
    }
    assert_int_equal(mem_used(&m), 0);
}

/* ---- runs ---- */

static void put_all(mesh_runs *r, const mesh_record *records, size_t count) {
    field_random random = {FIELD_SEED};
    for (size_t at = 0; at < count;) {
        size_t room;
        mesh_record *to = mesh_runs_room(r, &room);
        size_t some = 1 + field_random_bits(&random) % 5000;
        some = some < room ? some : room;
        some = some < count - at ? some : count - at;
        memcpy(to, records + at, some * sizeof *to);
        assert_int_equal(mesh_runs_put(r, some), ST_OK);
        at += some;
    }
    assert_int_equal(mesh_runs_end(r), ST_OK);
}

/* Windows of it show all records in order, whatever is used of each. */
static void check_windows(mesh_runs *r, const mesh_record *expected, size_t count, size_t in_sight,
                          uint64_t seed) {
    field_random random = {seed};
    size_t used = 0, done = 0;
    for (bool last = false;;) {
        const mesh_record *records;
        size_t sight;
        assert_int_equal(mesh_runs_window(r, used, &records, &sight, &last), ST_OK);
        done += used;
        assert_true(sight >= in_sight || last);
        assert_true(done + sight <= count && (!last || done + sight == count));
        assert_memory_equal(records, expected + done, sight * sizeof *records);
        if (done == count)
            return;
        used = 1 + field_random_bits(&random) % sight;
    }
}

static void test_runs(void **state) {
    (void)state;
    skip_under_thread();
    pool *p;
    assert_int_equal(pool_create(&m, 2, &p), ST_OK);
    const size_t pool_bytes = mem_used(&m);
    for (int i = 0; i < COUNT_COUNT; i++)
        for (int shape = 0; shape < SHAPES; shape++)
            for (uint64_t room = 0; room < 3; room++) {
                const size_t n = COUNTS[i], in_sight = 1000;
                mesh_record *records = random_records(n, shape, FIELD_SEED);
                const uint64_t bytes = room == 2 ? UINT64_MAX : room * n * 10;
                const mesh_runs_plan plan = mesh_runs_plan_make(n, in_sight, bytes, bytes);
                assert_true(room < 2 || plan.block == 0);
                assert_true(n < 300000 || room == 2 || plan.block > 0);
                mesh_runs *r;
                mem_init(&m, 0);
                atomic_store(&m.used, pool_bytes);
                assert_int_equal(mesh_runs_create(&m, p, scratch_path("runs"), &plan, &r), ST_OK);
                put_all(r, records, n);
                qsort(records, n, sizeof *records, compare_records);
                check_windows(r, records, n, in_sight, FIELD_SEED + room);
                assert_int_equal(mesh_runs_rewind(r), ST_OK);
                check_windows(r, records, n, in_sight, FIELD_SEED + 7 + room);
                mesh_runs_destroy(r);
                assert_int_equal(mem_used(&m), pool_bytes);
                uint64_t most = mesh_runs_sorting(&plan) + mesh_sort_memory(2);
                const uint64_t merging = mesh_runs_merging(&plan, n);
                most = most > merging ? most : merging;
                assert_true(mem_peak(&m) <= pool_bytes + most);
                free(records);
            }
    pool_destroy(p);
    assert_int_equal(scratch_count(), 0);
}

/* What a plan says of memory holds, and more room never makes it ask for more than there is. */
static void test_runs_plan(void **state) {
    (void)state;
    skip_under_thread();
    for (uint64_t n = 1; n < UINT64_C(1) << 34; n = 3 * n + 1) {
        const mesh_runs_plan least = mesh_runs_plan_make(n, 4097, 0, 0);
        const uint64_t sorting = mesh_runs_sorting(&least), merging = mesh_runs_merging(&least, n);
        for (uint64_t more = 0; more < UINT64_C(1) << 30; more = 2 * more + 1000) {
            const mesh_runs_plan plan =
                mesh_runs_plan_make(n, 4097, sorting + more, merging + more);
            assert_true(mesh_runs_sorting(&plan) <= sorting + more);
            assert_true(mesh_runs_merging(&plan, n) <= merging + more);
            assert_true(plan.block == 0 ? plan.run >= n : plan.window > 4097);
            assert_true(mesh_runs_filling(&plan) <= mesh_runs_sorting(&plan));
        }
    }
    /* One run of all records stays in memory: where there is no room for it behind, there are
     * several, however long they could be. */
    enum { RECORDS = 142164 };
    for (uint64_t making = 1 << 20; making < 16 << 20; making += 100000)
        for (uint64_t merging = 1 << 18; merging < 8 << 20; merging += 100000) {
            const mesh_runs_plan plan = mesh_runs_plan_make(RECORDS, 4097, making, merging);
            assert_true(plan.run < RECORDS || plan.run * sizeof(mesh_record) <= merging);
        }
    /* A hundred million tets pass through some MiB. */
    const mesh_runs_plan many = mesh_runs_plan_make(100000000, 4097, 0, 0);
    assert_true(mesh_runs_merging(&many, 100000000) < 24 << 20);
    assert_true(mesh_runs_sorting(&many) < 24 << 20);
}

/* ---- cutting ---- */

/* The tree from the top: what holds too many is split by its next bit. */
static size_t cut_tree(const mesh_record *records, size_t first, size_t end, int bit, size_t most,
                       size_t *cuts) {
    if (first == end)
        return 0;
    if (end - first <= most) {
        cuts[0] = end - first;
        return 1;
    }
    if (bit < 0) {
        cuts[0] = most;
        return 1 + cut_tree(records, first + most, end, bit, most, cuts + 1);
    }
    size_t middle = first;
    while (middle < end && !(records[middle].key >> bit & 1))
        middle++;
    size_t n = cut_tree(records, first, middle, bit - 1, most, cuts);
    return n + cut_tree(records, middle, end, bit - 1, most, cuts + n);
}

static void check_cuts(const mesh_record *records, size_t n, size_t most) {
    size_t *cuts = malloc((n + 1) * sizeof *cuts);
    const size_t count = cut_tree(records, 0, n, 62, most, cuts);
    for (size_t only = most + 1; only <= n + most + 1; only += n / 2 + 1) {
        size_t at = 0;
        for (size_t i = 0; i < count; i++) {
            const size_t sight = n - at < only ? n - at : only;
            const uint64_t *before = at > 0 ? &records[at - 1].key : NULL;
            assert_int_equal(mesh_cut_next(records + at, sight, before, most), cuts[i]);
            at += cuts[i];
        }
        assert_int_equal(at, n);
    }
    free(cuts);
}

static void test_cut(void **state) {
    (void)state;
    skip_under_thread();
    static const size_t most[] = {1, 2, 7, 100, 4096, 100000};
    for (int shape = 0; shape < SHAPES; shape++)
        for (size_t n = 1; n < 40000; n = 5 * n + 1) {
            mesh_record *records = random_records(n, shape, FIELD_SEED);
            qsort(records, n, sizeof *records, compare_records);
            for (size_t i = 0; i < sizeof most / sizeof most[0]; i++)
                check_cuts(records, n, most[i]);
            free(records);
        }
}

/* ---- spools and windows on them ---- */

enum { COUNT = 200001, ELEMENT = 12, LANES = 3 };

/* In random runs: behind one another, or from several places on in turns. */
static void fill_spool(mesh_spool *s, const char *bytes, bool in_turns, field_random *r) {
    const size_t lanes = in_turns ? LANES : 1, lane = COUNT / lanes;
    size_t at[LANES] = {0, lane, 2 * lane}, left = COUNT;
    assert_int_equal(COUNT % LANES, 0);
    for (size_t k = 0; left > 0; k = field_random_bits(r) % lanes) {
        const size_t room = (k + 1) * lane - at[k];
        size_t some = 1 + field_random_bits(r) % 40000;
        some = some < room ? some : room;
        assert_int_equal(in_turns ? mesh_spool_put(s, at[k], bytes + at[k] * ELEMENT, some)
                                  : mesh_spool_append(s, bytes + at[k] * ELEMENT, some),
                         ST_OK);
        at[k] += some;
        left -= some;
    }
}

static void test_spool(void **state) {
    (void)state;
    char *bytes = malloc((size_t)COUNT * ELEMENT), *back = malloc((size_t)COUNT * ELEMENT);
    field_random r = {FIELD_SEED};
    for (size_t i = 0; i < (size_t)COUNT * ELEMENT; i++)
        bytes[i] = (char)field_random_bits(&r);
    for (int turn = 0; turn < 8; turn++) {
        const int how = turn / 2;
        mesh_spool s, other;
        mesh_spool_init(&s, &m, scratch_path("spool"), ELEMENT, how ? (size_t)how << 19 : 0);
        mesh_spool_init(&other, &m, scratch_path("spool"), ELEMENT, 0);
        s.first_out = &other;
        assert_int_equal(mesh_spool_append(&other, bytes, 20000), ST_OK);
        fill_spool(&s, bytes, turn % 2, &r);
        /* Above the ceiling the other one goes first. */
        assert_int_equal(mesh_spool_held(&other), how == 0);
        assert_int_equal(mesh_spool_held(&s), how == 0);
        if (how == 0)
            assert_int_equal(mesh_spool_spill(&s), ST_OK);
        assert_int_equal(mesh_spool_read(&s, 0, COUNT, back), ST_OK);
        assert_memory_equal(back, bytes, (size_t)COUNT * ELEMENT);
        assert_int_equal(mesh_spool_read(&other, 77, 19000, back), ST_OK);
        assert_memory_equal(back, bytes + 77 * ELEMENT, 19000 * ELEMENT);
        mesh_pages p;
        const uint64_t room = mesh_pages_least(&s) << how;
        const size_t before = mem_used(&m);
        assert_int_equal(mesh_pages_init(&p, &s, room), ST_OK);
        assert_true(mem_used(&m) - before <= mesh_pages_memory(&s, room));
        assert_true(mesh_pages_memory(&s, room) <= room);
        for (int i = 0; i < 100000; i++) {
            const uint64_t at = i % 3 ? (uint64_t)i * 2 % COUNT : field_random_bits(&r) % COUNT;
            const void *element = mesh_pages_at(&p, at);
            assert_non_null(element);
            assert_memory_equal(element, bytes + at * ELEMENT, ELEMENT);
        }
        mesh_pages_release(&p);
        mesh_spool_release(&s);
        mesh_spool_release(&other);
        assert_int_equal(mem_used(&m), 0);
        assert_int_equal(scratch_count(), 0);
    }
    free(bytes);
    free(back);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_morton, set_up), cmocka_unit_test_setup(test_sort, set_up),
        cmocka_unit_test_setup(test_runs, set_up),   cmocka_unit_test_setup(test_runs_plan, set_up),
        cmocka_unit_test_setup(test_cut, set_up),    cmocka_unit_test_setup(test_spool, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
