/* test_loader.c - selections: what the sweep over the directory says, masks made on the first look
 * by any number of threads at once, and treelets that keep what they have read.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/base/pool.h"
#include "stream/grid_resident.h"
#include "stream/loader.h"
#include "tests/support/fields.h"
#include "tests/support/fixture.h"
#include "tests/support/interests.h"
#include "tests/support/leaf_files.h"
#include "tests/support/loaded.h"
#include "tests/support/watched.h"

enum { WORKERS = 2, THREADS = 4 };

/* A treelet file, its loader, and masks made by the scalar version alone. */
typedef struct stage {
    mem m;
    leaf_file *f;
    loader *l;
    void *payload;
    active_masks *truth;
    uint32_t levels;
} stage;

static void stage_open(stage *s, sample_type type, cpu_isa isa) {
    leaf_case c = leaf_files_case(100, 70, 45, type);
    void *samples = leaf_files_random(&c, FIELD_SEED, type == SAMPLE_F32 ? 500 : 0);
    c.samples = samples;
    mem_init(&s->m, 0);
    assert_int_equal(leaf_file_open(&s->m, leaf_files_make(&c, "loader.leaf"), &s->f), ST_OK);
    free(samples);
    s->levels = s->f->layout.cells_log2 - LEAF_BLOCK_LOG2;
    s->payload = mem_alloc(&s->m, leaf_layout_payload_max(&s->f->layout));
    s->truth = active_init(mem_alloc(&s->m, active_bytes(s->levels)), s->levels);
    const loader_options options = {.source = SOURCE_ARENA, .workers = WORKERS, .isa = isa};
    assert_int_equal(loader_create(&s->m, s->f, &options, NULL, &s->l), ST_OK);
    loader_set_capacity(s->l, s->f->layout.treelets, 0);
}

static void stage_close(stage *s) {
    loader_destroy(s->l);
    mem_free(&s->m, s->truth);
    mem_free(&s->m, s->payload);
    leaf_file_close(s->f);
    assert_int_equal(mem_used(&s->m), 0);
}

static void load_all(stage *s) {
    loader_sweep(s->l);
    assert_int_equal(loader_settle(s->l), ST_OK);
}

static bool same_masks(const active_masks *a, const active_masks *b, uint32_t levels) {
    const size_t cells = sizeof *a->cells << (3 * levels);
    return a->root == b->root && !memcmp(a->cells, b->cells, cells) &&
           !memcmp(a->nodes, b->nodes, active_nodes_at(levels));
}

static void assert_true_masks(stage *s, const treelet *tr, const interest *in) {
    assert_int_equal(loaded(s->f, tr->id, s->payload), ST_OK);
    active_compute(s->truth, s->f, tr->id, s->payload, in);
    assert_true(same_masks(resident_grid_of(tr)->masks, s->truth, s->levels));
}

/* ---- The sweep ---- */

static void select_isovalues(loader *l, const double *isos, int count) {
    const interest in = interest_of_isovalues(isos, count);
    loader_select(l, &in);
}

static bool holds(const float range[2], const interests *set) {
    return interests_meet(set, (double)range[0], (double)range[1]);
}

static void assert_swept(const stage *s, const interests *set) {
    const leaf_file *f = s->f;
    uint64_t bytes = 0;
    uint32_t active = 0;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const bool own = holds(f->own[t], set);
        assert_int_equal(s->l->own[t], own);
        bytes += own ? f->sizes[t] : 0;
        active += own;
        const unsigned existing = leaf_layout_children(&f->layout, t);
        uint32_t child = f->layout.first_child[t];
        for (unsigned octant = 0; octant < 8; octant++) {
            const bool there = existing >> octant & 1u;
            const bool held = there && holds(f->ranges[child], set);
            assert_int_equal(s->l->children[t] >> octant & 1u, held);
            child += there;
        }
    }
    assert_int_equal(s->l->bytes_active, bytes);
    assert_int_equal(s->l->treelets_active, active);
}

static void sweep(stage *s, const interests *set) {
    loader_select(s->l, &set->in);
    assert_swept(s, set);
}

/* Isovalues and intervals at the ends of ranges, beside them, and where no float is. */
static void test_sweep(void **state) {
    (void)state;
    stage s;
    interests set;
    stage_open(&s, SAMPLE_F32, CPU_SCALAR);
    field_random r = {FIELD_SEED};
    interests_of_isovalues(&set, NULL, 0);
    assert_swept(&s, &set);
    interests_of_all(&set);
    sweep(&s, &set);
    assert_true(s.l->treelets_active > 50);
    for (uint32_t t = 0; t < s.f->layout.treelets; t++)
        for (int end = 0; end < 2; end++) {
            const double at = (double)s.f->own[t][end];
            const double isos[] = {at, nextafter(at, INFINITY), nextafter(at, -INFINITY), 1e300};
            for (int i = 0; i < 4; i++) {
                interests_of_isovalues(&set, &isos[i], 1);
                sweep(&s, &set);
            }
            interests_of_isovalues(&set, isos, 4);
            sweep(&s, &set);
            interests_random(&set, &r, isos, 4);
            sweep(&s, &set);
        }
    stage_close(&s);
}

/* Intervals: what the sweep finds comes in, with the masks of the scalar version. */
static void test_intervals(void **state) {
    (void)state;
    static const double values[] = {0, 60, 90.5, 120, 255};
    for (int isa = CPU_SCALAR; isa <= (int)cpu_best(); isa++) {
        stage s;
        interests set;
        stage_open(&s, SAMPLE_U8, (cpu_isa)isa);
        field_random r = {FIELD_SEED};
        for (int i = 0; i < 12; i++) {
            if (i == 0)
                interests_of_all(&set);
            else
                interests_random(&set, &r, values, 5);
            sweep(&s, &set);
            load_all(&s);
            for (uint32_t t = 0; t < s.f->layout.treelets; t++) {
                const treelet *tr = loader_lookup(s.l, t);
                assert_int_equal(tr != NULL, s.l->own[t]);
                if (tr)
                    assert_true_masks(&s, tr, &set.in);
            }
        }
        /* Given in another order they are the same selection. */
        const size_t selection = s.l->selection;
        const interest_interval turned[] = {{9, 9, false, true}, {2, 4, true, false}},
                                again[] = {turned[1], turned[0]};
        interest in = interest_of_intervals(turned, 2);
        loader_select(s.l, &in);
        assert_int_equal(s.l->selection, selection + 1);
        in = interest_of_intervals(again, 2);
        loader_select(s.l, &in);
        assert_int_equal(s.l->selection, selection + 1);
        stage_close(&s);
    }
}

/* ---- Masks on the first look ---- */

static void test_lazy(void **state) {
    (void)state;
    static const double isos[][2] = {{120, 120}, {90.5, 90.5}, {100, 140}, {120, 140}};
    for (int isa = CPU_SCALAR; isa <= (int)cpu_best(); isa++) {
        stage s;
        stage_open(&s, SAMPLE_U8, (cpu_isa)isa);
        for (size_t i = 0; i < sizeof isos / sizeof *isos; i++) {
            const int count = isos[i][0] == isos[i][1] ? 1 : 2;
            const interest in = interest_of_isovalues(isos[i], count);
            select_isovalues(s.l, isos[i], count);
            loader_reset_statistics(s.l);
            assert_int_equal(loader_statistics(s.l).masks, 0);
            load_all(&s);
            /* What was read has its masks; what was there gets them when it is looked at. */
            assert_int_equal(loader_statistics(s.l).masks, loader_statistics(s.l).loads);
            uint32_t seen = 0;
            for (uint32_t t = 0; t < s.f->layout.treelets; t++) {
                const treelet *tr = loader_lookup(s.l, t);
                assert_int_equal(tr != NULL, s.l->own[t]);
                if (tr)
                    assert_true_masks(&s, tr, &in);
                seen += tr != NULL;
            }
            assert_true(seen > 50);
            assert_int_equal(loader_statistics(s.l).masks, seen);
            /* The same again: nothing to do. */
            select_isovalues(s.l, isos[i], count);
            for (uint32_t t = 0; t < s.f->layout.treelets; t++)
                (void)loader_lookup(s.l, t);
            assert_int_equal(loader_statistics(s.l).masks, seen);
        }
        stage_close(&s);
    }
}

/* ---- Many threads at once ---- */

typedef struct crowd {
    stage *s;
    hash_id *want; /* a treelet */
    atomic_int wrong;
} crowd;

static hash_id hash_masks(const active_masks *masks, uint32_t levels) {
    return hash_identity(masks->cells, active_bytes(levels) - sizeof *masks);
}

/* Every index is a walk over all treelets, so that all threads come to the same ones together. */
static status look_at_all(void *ctx, size_t index, int worker) {
    crowd *c = ctx;
    (void)index;
    (void)worker;
    for (uint32_t t = 0; t < c->s->f->layout.treelets; t++) {
        const treelet *tr = loader_lookup(c->s->l, t);
        if (!tr)
            continue;
        const hash_id got = hash_masks(resident_grid_of(tr)->masks, c->s->levels);
        if (got.lo != c->want[t].lo || got.hi != c->want[t].hi)
            atomic_fetch_add(&c->wrong, 1);
    }
    return ST_OK;
}

static void test_crowd(void **state) {
    (void)state;
    stage s;
    pool *threads;
    stage_open(&s, SAMPLE_I16, CPU_SCALAR); /* the slowest: the longest to wait for */
    const uint32_t n = s.f->layout.treelets;
    crowd c = {.s = &s, .want = mem_array(&s.m, n, sizeof *c.want)};
    assert_int_equal(pool_create(&s.m, THREADS, &threads), ST_OK);
    for (int i = 0; i < 40; i++) {
        const double iso = -9000.0 + 450.5 * i;
        const interest in = interest_of_isovalues(&iso, 1);
        select_isovalues(s.l, &iso, 1);
        uint32_t active = 0;
        for (uint32_t t = 0; t < n; t++) {
            if (!s.l->own[t])
                continue;
            active++;
            assert_int_equal(loaded(s.f, t, s.payload), ST_OK);
            active_compute(s.truth, s.f, t, s.payload, &in);
            c.want[t] = hash_masks(s.truth, s.levels);
        }
        loader_reset_statistics(s.l);
        /* Rays come while treelets are still being read, then once all are there. */
        loader_sweep(s.l);
        assert_int_equal(pool_run(threads, THREADS, look_at_all, &c), ST_OK);
        assert_int_equal(loader_settle(s.l), ST_OK);
        assert_int_equal(pool_run(threads, THREADS, look_at_all, &c), ST_OK);
        assert_int_equal(atomic_load(&c.wrong), 0);
        assert_int_equal(loader_statistics(s.l).masks, active);
        assert_true(active > 0);
    }
    pool_destroy(threads);
    mem_free(&s.m, c.want);
    stage_close(&s);
}

/* ---- Levels ---- */

static uint32_t ready_in(const stage *s, uint32_t level) {
    const leaf_level *of = &s->f->layout.level[level];
    uint32_t count = 0;
    for (uint32_t t = of->first; t < of->first + of->count; t++)
        count += loader_is_ready(s->l, t);
    return count;
}

static uint32_t active_in(const stage *s, uint32_t level) {
    const leaf_level *of = &s->f->layout.level[level];
    uint32_t count = 0;
    for (uint32_t t = of->first; t < of->first + of->count; t++)
        count += s->l->own[t];
    return count;
}

/* A sweep to a level brings all of interest that is as coarse, and nothing finer. */
static void test_levels(void **state) {
    (void)state;
    stage s;
    stage_open(&s, SAMPLE_I16, CPU_SCALAR);
    const double iso = 100.5;
    select_isovalues(s.l, &iso, 1);
    const uint32_t levels = s.f->layout.levels;
    assert_true(levels > 1);
    for (uint32_t level = levels; level-- > 0;) {
        loader_sweep_level(s.l, level, UINT64_MAX);
        assert_int_equal(loader_settle(s.l), ST_OK);
        for (uint32_t i = 0; i < levels; i++)
            assert_int_equal(ready_in(&s, i), i < level ? 0 : active_in(&s, i));
        assert_true(active_in(&s, level) > 0);
    }
    loader_clear(s.l);
    stage_close(&s);
}

/* Sweeps in parts: none reads more than it may, but for a single treelet; the next goes on. */
static void test_parts(void **state) {
    (void)state;
    stage s;
    stage_open(&s, SAMPLE_I16, CPU_SCALAR);
    const double iso = 100.5;
    select_isovalues(s.l, &iso, 1);
    const uint64_t one = leaf_layout_payload_max(&s.f->layout), most = 3 * one;
    uint32_t ready = 0, parts = 0, level = s.f->layout.levels - 1;
    assert_int_equal(loader_level_within(s.l, 0, 0), level);
    assert_int_equal(loader_level_within(s.l, 0, s.l->bytes_active), 0);
    assert_int_equal(loader_level_within(s.l, 1, s.l->bytes_active), 1);
    for (; ready < s.l->treelets_active; parts++) {
        const uint64_t before = loader_statistics(s.l).bytes_read;
        /* The level gets finer, and of what it needs all is read. */
        const uint32_t within = loader_level_within(s.l, 0, parts % 4 ? most : 0);
        assert_true(within <= level);
        level = within;
        loader_sweep_level(s.l, 0, parts % 4 ? most : 0);
        assert_int_equal(loader_settle(s.l), ST_OK);
        const uint64_t read = loader_statistics(s.l).bytes_read - before;
        assert_true(read > 0 && (parts % 4 ? read <= most : read <= one));
        const uint32_t had = ready;
        bool gap = false; /* coarse levels come first */
        ready = 0;
        for (uint32_t t = 0; t < s.f->layout.treelets; t++) {
            gap = gap || (s.l->own[t] && !loader_is_ready(s.l, t));
            assert_false(gap && loader_is_ready(s.l, t));
            ready += loader_is_ready(s.l, t);
        }
        assert_true(ready > had);
        for (uint32_t i = level; i < s.f->layout.levels && parts % 4; i++)
            assert_int_equal(ready_in(&s, i), active_in(&s, i));
    }
    assert_true(parts > 3);
    assert_int_equal(loader_level_within(s.l, 0, 0), 0);
    loader_clear(s.l);
    stage_close(&s);
}

/* After loader_rest() nothing more is read. */
static void test_rest(void **state) {
    (void)state;
    stage s;
    stage_open(&s, SAMPLE_I16, CPU_SCALAR);
    const double iso = 100.5;
    select_isovalues(s.l, &iso, 1);
    loader_sweep(s.l);
    loader_rest(s.l);
    const uint64_t loads = loader_statistics(s.l).loads;
    assert_false(loader_is_reading(s.l));
    assert_int_equal(loader_settle(s.l), ST_OK);
    assert_true(loader_statistics(s.l).loads == loads);
    load_all(&s);
    assert_int_equal(ready_in(&s, 0), active_in(&s, 0));
    stage_close(&s);
}

/* ---- Spare treelets ---- */

static uint32_t ready(const stage *s) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < s->f->layout.treelets; t++)
        count += loader_lookup(s->l, t) != NULL;
    return count;
}

/* An isovalue that nothing holds, and back: nothing is read again. */
static void test_kept(void **state) {
    (void)state;
    static const double here = 120.0, nowhere = 1e6;
    const interest in = interest_of_isovalues(&here, 1);
    stage s;
    stage_open(&s, SAMPLE_U8, cpu_best());
    select_isovalues(s.l, &here, 1);
    load_all(&s);
    const uint32_t active = s.l->treelets_active;
    assert_int_equal(ready(&s), active);
    select_isovalues(s.l, &nowhere, 1);
    assert_int_equal(ready(&s), 0);
    /* A point's treelet is asked for whatever its range. */
    uint32_t one = 0;
    while (!interest_meets(&in, s.f->own[one][0], s.f->own[one][1]))
        one++;
    loader_request request = {one, 0};
    assert_int_equal(loader_admit(s.l, &request, 1), ST_OK);
    assert_int_equal(ready(&s), 1);
    select_isovalues(s.l, &here, 1);
    assert_int_equal(ready(&s), active);
    load_all(&s);
    assert_int_equal(loader_statistics(s.l).loads, active);
    for (uint32_t t = 0; t < s.f->layout.treelets; t++)
        if (s.l->own[t])
            assert_true_masks(&s, loader_lookup(s.l, t), &in);
    /* Fewer slots: the spare ones go first, and memory with them. */
    select_isovalues(s.l, &nowhere, 1);
    assert_int_equal(loader_admit(s.l, &request, 1), ST_OK);
    const size_t before = mem_used(&s.m);
    loader_set_capacity(s.l, 3, 0);
    assert_int_equal(ready(&s), 1);
    assert_true(mem_used(&s.m) + (active - 3) * active_bytes(s.levels) < before);
    select_isovalues(s.l, &here, 1);
    assert_int_equal(ready(&s), 3);
    stage_close(&s);
}

/* What is spare makes room for what is wanted, and never more is held than there are slots. */
static void test_room(void **state) {
    (void)state;
    stage s;
    stage_open(&s, SAMPLE_U8, cpu_best());
    const size_t bare = mem_used(&s.m);
    enum { SLOTS = 5 };
    loader_set_capacity(s.l, SLOTS, 0);
    field_random r = {FIELD_SEED};
    for (int i = 0; i < 200; i++) {
        const double iso = 5.0 * (double)field_random_below(&r, 51);
        select_isovalues(s.l, &iso, 1);
        load_all(&s);
        const uint32_t active = s.l->treelets_active;
        assert_int_equal(ready(&s), active < SLOTS ? active : SLOTS);
        assert_true(mem_used(&s.m) <= bare + SLOTS * loader_slot_bytes(s.l));
    }
    assert_true(loader_statistics(s.l).loads > SLOTS);
    stage_close(&s);
}

/* ---- Pictures ---- */

enum { SIDE = WATCHED ? 24 : 48 };

static hash_id draw(leafcast *v, double iso) {
    static double depth[SIDE * SIDE];
    const leafcast_surface surface = leafcast_surface_default(iso);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera camera = leafcast_standard_view(v, 1.1, SIDE, SIDE);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    if (leafcast_trace(v, &scene, &camera,
                       &(leafcast_image){.size = sizeof(leafcast_image), .z = depth}, NULL, NULL,
                       NULL))
        fail_msg("%s", leafcast_error_text());
    return hash_identity(depth, sizeof depth);
}

/* Isovalues to and fro, with room for all treelets and for few, by every version of the masks: the
 * pictures of volumes freshly opened. */
static void test_pictures(void **state) {
    (void)state;
    enum { ISOS = 6 };
    static const uint32_t limits[] = {0, 1, 7};
    hash_id want[ISOS];
    field f;
    assert_true(field_make(&f, "noise-u8", 60, FIELD_SEED));
    const char *path = fixture_leaf(&f, 4, 1, false);
    field_release(&f);
    for (int i = 0; i < ISOS; i++) {
        leafcast *fresh = fixture_open(
            path,
            &(leafcast_options){.size = sizeof(leafcast_options), .threads = 1, .isa = "scalar"});
        want[i] = draw(fresh, 20.0 + 35.5 * i);
        leafcast_close(fresh);
    }
    for (int isa = CPU_SCALAR; isa <= (int)cpu_best(); isa++)
        for (size_t k = 0; k < sizeof limits / sizeof *limits; k++) {
            field_random r = {FIELD_SEED};
            leafcast *v = fixture_open(
                path, &(leafcast_options){.size = sizeof(leafcast_options),
                                          .threads = 3,
                                          .isa = cpu_isa_name((cpu_isa)isa),
                                          .experiments = EXPERIMENTS(.treelet_limit = limits[k])});
            for (int step = 0; step < 3 * ISOS; step++) {
                const int i = (int)field_random_below(&r, ISOS);
                const hash_id got = draw(v, 20.0 + 35.5 * i);
                assert_true(got.lo == want[i].lo && got.hi == want[i].hi);
            }
            leafcast_close(v);
        }
    assert_false(want[0].lo == want[1].lo && want[0].hi == want[1].hi);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sweep),  cmocka_unit_test(test_intervals),
        cmocka_unit_test(test_lazy),   cmocka_unit_test(test_crowd),
        cmocka_unit_test(test_levels), cmocka_unit_test(test_parts),
        cmocka_unit_test(test_rest),   cmocka_unit_test(test_kept),
        cmocka_unit_test(test_room),   cmocka_unit_test(test_pictures)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
