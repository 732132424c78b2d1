/* test_loader_series.c - another step: what is the same there stays resident, with its masks, and
 * the rest is read; going back reads nothing that fits. What is expected is read before.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "formats/base/fault.h"
#include "stream/grid_resident.h"
#include "stream/loader.h"
#include "tests/support/fields.h"
#include "tests/support/interests.h"
#include "tests/support/leaf_files.h"
#include "tests/support/loaded.h"
#include "tests/support/scratch.h"

enum { STEPS = 9, CHAIN = 5, NX = 70, NY = 40, NZ = 52 };

typedef struct stage {
    mem m;
    leaf_file *f;
    loader *l;
    interest all;
    void *payload;
} stage;

/* Nodes that coarse levels have none of, alternately a little more and less: they stay as they are,
 * and only how far they are from level 0 changes. */
static void shake(uint16_t *samples) {
    for (int z = 1; z < 32; z += 2)
        for (int y = 1; y < 32; y += 2)
            for (int x = 1; x < 32; x += 2) {
                uint16_t *at = &samples[x + NX * (y + NY * z)];
                *at = (uint16_t)(*at + ((x / 2 + y / 2 + z / 2) % 2 ? 9 : -9));
            }
}

/* Step 1 differs from step 0 at one end of x; 2 is as 0; 3 is shaken; 4 is another thing; those
 * from CHAIN on are a little different from the one before. */
static void next_step(const leaf_case *c, int step, uint16_t *samples, const uint16_t *first) {
    const size_t count = (size_t)NX * NY * NZ;
    if (step == 2)
        memcpy(samples, first, count * sizeof *samples);
    for (size_t i = 0; i < count && step == 1; i++)
        samples[i] ^= i % NX > 60;
    if (step == 3)
        shake(samples);
    if (step == 4) {
        void *other = leaf_files_random(c, FIELD_SEED + 9, 0);
        memcpy(samples, other, count * sizeof *samples);
        free(other);
    }
    field_random r = {(uint64_t)step};
    for (size_t i = 0; i < count && step >= CHAIN; i++)
        samples[i] ^= field_random_below(&r, 50) == 0;
}

static const char *make_file(leaf_codec codec) {
    leaf_case c = leaf_files_case(NX, NY, NZ, SAMPLE_U16);
    const size_t bytes = (size_t)NX * NY * NZ * sizeof(uint16_t);
    uint16_t *first = leaf_files_random(&c, FIELD_SEED, 0), *samples = malloc(bytes);
    const char *paths[STEPS];
    memcpy(samples, first, bytes);
    for (int step = 0; step < STEPS; step++) {
        char name[32];
        next_step(&c, step, samples, first);
        snprintf(name, sizeof name, "step%d.bin", step);
        paths[step] = strdup(scratch_write(name, samples, bytes));
    }
    const grid_series of = {.of = {.paths = paths, .sets = {1, STEPS, NULL, NULL, NULL}},
                            .hints = {.dims = {NX, NY, NZ}, .type = SAMPLE_U16}};
    c.options.file.codec = codec;
    c.options.file.zstd_level = 1;
    c.options.file.deviations = true;
    const char *path = leaf_files_series(&of, &c.options, "series.leaf");
    for (int step = 0; step < STEPS; step++)
        free((void *)(uintptr_t)paths[step]);
    free(first);
    free(samples);
    return path;
}

static void stage_open(stage *s, leaf_codec codec) {
    const loader_options options = {.source = SOURCE_ARENA, .workers = 2, .isa = cpu_best()};
    interests set;
    mem_init(&s->m, 0);
    assert_int_equal(leaf_file_open(&s->m, make_file(codec), &s->f), ST_OK);
    s->payload = mem_alloc(&s->m, leaf_layout_payload_max(&s->f->layout));
    assert_int_equal(loader_create(&s->m, s->f, &options, NULL, &s->l), ST_OK);
    interests_of_all(&set);
    s->all = set.in;
    loader_select(s->l, &s->all);
}

static void stage_close(stage *s) {
    loader_destroy(s->l);
    mem_free(&s->m, s->payload);
    leaf_file_close(s->f);
    assert_int_equal(mem_used(&s->m), 0);
}

/* Show a step. Returns how many treelets were read for it. */
static uint64_t show(stage *s, uint32_t set) {
    loader_reset_statistics(s->l);
    loader_select_set(s->l, set);
    loader_sweep(s->l);
    assert_int_equal(loader_settle(s->l), ST_OK);
    return loader_statistics(s->l).loads;
}

/* All treelets are those of the set, with its deviations and masks. */
static void check(stage *s, uint32_t set) {
    const leaf_layout *l = &s->f->layout;
    for (uint32_t t = 0; t < l->treelets; t++) {
        const uint32_t p = leaf_layout_samples(l, set, t);
        const treelet *tr = loader_lookup(s->l, t);
        assert_non_null(tr);
        assert_int_equal(tr->set, set);
        assert_int_equal(loaded(s->f, p, s->payload), ST_OK);
        assert_memory_equal(tr->payload, s->payload, leaf_layout_payload_bytes(l, p));
        if (l->level_of[t] > 0)
            assert_ptr_equal(resident_grid_of(tr)->deviations,
                             s->f->deviations + deviation_at(l, set, t));
    }
}

/* How many treelets of a set differ from another's, in samples, halo or deviations. */
static uint32_t different(const stage *s, uint32_t a, uint32_t b) {
    const leaf_layout *l = &s->f->layout;
    const size_t room = leaf_layout_payload_max(l);
    char *x = aligned_alloc(64, room), *y = aligned_alloc(64, room);
    uint32_t count = 0;
    for (uint32_t t = 0; t < l->treelets; t++) {
        const uint32_t p = leaf_layout_samples(l, a, t), q = leaf_layout_samples(l, b, t);
        bool same = true;
        assert_int_equal(loaded(s->f, p, x), ST_OK);
        assert_int_equal(loaded(s->f, q, y), ST_OK);
        same = memcmp(x, y, leaf_layout_payload_bytes(l, p)) == 0;
        if (l->level_of[t] > 0)
            same &= memcmp(s->f->deviations + deviation_at(l, a, t),
                           s->f->deviations + deviation_at(l, b, t),
                           deviation_bricks(l) * sizeof *s->f->deviations) == 0;
        count += !same;
    }
    free(x);
    free(y);
    return count;
}

/* With room for two steps: each is there as if it were alone, and what is the same is not read. */
static void test_steps(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        stage s;
        stage_open(&s, (leaf_codec)codec);
        const uint32_t n = s.f->layout.treelets;
        loader_set_capacity(s.l, n, n * loader_slot_bytes(s.l));
        assert_int_equal(show(&s, 0), n);
        for (uint32_t set = 1; set < STEPS; set++) {
            /* A compressed treelet is read again if its family's shell is another. */
            const uint32_t least = different(&s, set, set - 1);
            const uint64_t read = show(&s, set);
            const uint64_t back = set == 2 ? 0 : least;
            if (read < back || read > (codec == LEAF_CODEC_RAW ? least : 8 * least))
                fail_msg("set %u: %u treelets read, %u differ", set, (unsigned)read, least);
            /* Of a chain, the last code alone is read. */
            const uint64_t bytes = loader_statistics(s.l).bytes_read;
            if (codec == LEAF_CODEC_ZSTD && set > CHAIN)
                assert_in_range(bytes, 1, s.l->bytes_active / 2);
            check(&s, set);
        }
        assert_in_range(different(&s, 1, 0), 1, n / 2);
        assert_int_equal(different(&s, 4, 3), n);
        /* Both are in memory. */
        for (uint32_t set = STEPS - 2; set < STEPS; set++) {
            assert_int_equal(show(&s, set), 0);
            check(&s, set);
        }
        stage_close(&s);
    }
}

/* With room for less than one: nothing is taken for what it is not. */
static void test_little_room(void **state) {
    (void)state;
    stage s;
    stage_open(&s, LEAF_CODEC_ZSTD);
    const uint32_t n = s.f->layout.treelets;
    field_random r = {FIELD_SEED};
    for (int round = 0; round < 60; round++) {
        loader_set_capacity(s.l, 1 + (uint32_t)field_random_below(&r, n),
                            (size_t)field_random_below(&r, n) * loader_slot_bytes(s.l));
        const uint32_t set = (uint32_t)field_random_below(&r, STEPS);
        (void)show(&s, set);
        for (uint32_t t = 0; t < n; t++) {
            const treelet *tr = loader_lookup(s.l, t);
            const uint32_t p = leaf_layout_samples(&s.f->layout, set, t);
            if (!tr)
                continue;
            assert_int_equal(tr->set, set);
            assert_int_equal(loaded(s.f, p, s.payload), ST_OK);
            assert_memory_equal(tr->payload, s.payload, leaf_layout_payload_bytes(&s.f->layout, p));
        }
    }
    stage_close(&s);
}

/* ---- what is expected ---- */

static void wait_ms(long ms) {
    nanosleep(&(struct timespec){0, ms * 1000000}, NULL);
}

/* Read of an expected set what `touched` says, until that many treelets have come. Then no more
 * do. */
static void read_early(stage *s, uint32_t set, const atomic_uchar *touched, uint64_t count) {
    const uint64_t before = loader_statistics(s->l).early;
    loader_expect(s->l, set);
    loader_read_expected(s->l, touched);
    for (int i = 0; i < 20000 && loader_statistics(s->l).early - before < count; i++)
        wait_ms(1);
    wait_ms(10);
    assert_int_equal(loader_statistics(s->l).early - before, count);
}

/* Mark every n-th treelet as touched, from the first on. Returns their number. */
static uint32_t touch(const stage *s, atomic_uchar *touched, uint32_t n) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < s->f->layout.treelets; t++) {
        atomic_store(&touched[t], t % n == 0);
        count += t % n == 0;
    }
    return count;
}

/* What rays touched is there before its step is selected, with masks; the rest is read then. */
static void test_expected(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        stage s;
        stage_open(&s, (leaf_codec)codec);
        const uint32_t n = s.f->layout.treelets;
        atomic_uchar *touched = calloc(n, sizeof *touched);
        loader_set_capacity(s.l, n, 2 * n * loader_slot_bytes(s.l));
        /* Steps 4 and 5 have nothing in common with the one before; nor has 8 with 4. */
        assert_int_equal(show(&s, 3), n);
        const uint32_t third = touch(&s, touched, 3);
        read_early(&s, 4, touched, third);
        check(&s, 3);
        /* What was read early counts in its step. */
        assert_int_equal(show(&s, 4), n);
        check(&s, 4);
        assert_int_equal(loader_statistics(s.l).masks, n - third);
        /* It is the selected one now, and nothing is read of it; nor of what is all there. */
        read_early(&s, 4, touched, 0);
        touch(&s, touched, 1);
        read_early(&s, 3, touched, 0);
        /* Another one is selected. What was expected stays so. */
        read_early(&s, CHAIN + 1, touched, different(&s, CHAIN + 1, 4));
        assert_int_equal(show(&s, 3), 0);
        check(&s, 3);
        assert_int_equal(show(&s, CHAIN + 1), different(&s, CHAIN + 1, 4));
        assert_int_equal(loader_statistics(s.l).masks, 0);
        check(&s, CHAIN + 1);
        /* But once. */
        assert_int_equal(show(&s, 3), 0);
        assert_int_equal(show(&s, CHAIN + 1), 0);
        /* Nothing is expected any more. */
        loader_clear(s.l);
        (void)show(&s, 3);
        const uint64_t before = loader_statistics(s.l).early;
        loader_read_expected(s.l, touched);
        wait_ms(10);
        assert_int_equal(loader_statistics(s.l).early, before);
        /* What is the same is not read: step 2 is as 0. */
        (void)show(&s, 0);
        read_early(&s, 2, touched, 0);
        /* One that shows no value of the interest. */
        const double above = 1e9;
        const interest none = interest_of_isovalues(&above, 1);
        loader_select(s.l, &none);
        read_early(&s, 8, touched, 0);
        loader_select(s.l, &s.all);
        free(touched);
        stage_close(&s);
    }
}

/* Codes of a chain are added to those of the step that is shown. */
static void test_expected_chain(void **state) {
    (void)state;
    stage s;
    stage_open(&s, LEAF_CODEC_ZSTD);
    const uint32_t n = s.f->layout.treelets;
    atomic_uchar *touched = calloc(n, sizeof *touched);
    touch(&s, touched, 1);
    loader_set_capacity(s.l, n, n * loader_slot_bytes(s.l));
    (void)show(&s, CHAIN);
    for (uint32_t set = CHAIN + 1; set < STEPS; set++) {
        const uint64_t before = loader_statistics(s.l).bytes_read_ever;
        read_early(&s, set, touched, different(&s, set, set - 1));
        const uint64_t read = loader_statistics(s.l).bytes_read_ever - before;
        assert_int_equal(show(&s, set), different(&s, set, set - 1));
        assert_int_equal(loader_statistics(s.l).bytes_read, read);
        assert_int_equal(loader_statistics(s.l).bytes_read_ever - before, read);
        assert_in_range(read, 1, s.l->bytes_active / 2);
        check(&s, set);
    }
    free(touched);
    stage_close(&s);
}

/* It makes room of what is old, of nothing that is shown or expected, and takes no more than there
 * is. What comes next ends it. */
static void test_expected_room(void **state) {
    (void)state;
    for (uint32_t rest = 0; rest < 3; rest++) {
        stage s;
        stage_open(&s, LEAF_CODEC_RAW);
        const uint32_t n = s.f->layout.treelets;
        const size_t room = (n + rest * n / 2) * loader_slot_bytes(s.l);
        atomic_uchar *touched = calloc(n, sizeof *touched);
        touch(&s, touched, 1);
        loader_set_capacity(s.l, n, room - n * loader_slot_bytes(s.l));
        (void)show(&s, 5);
        (void)show(&s, 4);
        (void)show(&s, 5);
        for (uint32_t set = 5; set <= 8; set += 3) {
            (void)show(&s, 4);
            for (int round = 0; round < 20; round++) {
                const struct timespec pause = {0, round * 20000};
                loader_expect(s.l, set);
                loader_read_expected(s.l, touched);
                nanosleep(&pause, NULL);
                if (round % 5 == 4)
                    loader_rest(s.l);
                assert_true(loader_statistics(s.l).bytes_resident <= room);
                for (uint32_t t = 0; t < n; t++)
                    assert_true(loader_is_ready(s.l, t));
            }
            for (int i = 0; i < 1000 && set == 8 && !loader_statistics(s.l).early; i++)
                wait_ms(10);
            loader_rest(s.l);
            const uint64_t early = loader_statistics(s.l).early;
            check(&s, 4);
            assert_int_equal(loader_statistics(s.l).early, early);
            /* Each once: none makes room for another. */
            assert_in_range(early, set == 5 ? 0 : 1, 2 * n);
            const uint64_t read = show(&s, set);
            assert_in_range(read, 0, rest > 0 && set == 5 ? 0 : 2 * n);
            check(&s, set);
        }
        free(touched);
        stage_close(&s);
    }
}

/* What fails early is nobody's error: it is read again when it is wanted. */
static void test_expected_faults(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++)
        for (int what = FAULT_ALLOC; what <= FAULT_READ; what++)
            for (long k = 1; k < 10; k += 4) {
                stage s;
                stage_open(&s, (leaf_codec)codec);
                const uint32_t n = s.f->layout.treelets;
                atomic_uchar *touched = calloc(n, sizeof *touched);
                touch(&s, touched, 1);
                loader_set_capacity(s.l, n, n * loader_slot_bytes(s.l));
                (void)show(&s, 3);
                fault_arm((fault_kind)what, k);
                loader_expect(s.l, 4);
                loader_read_expected(s.l, touched);
                for (int i = 0; i < 20000 && !fault_fired((fault_kind)what); i++)
                    wait_ms(1);
                assert_true(fault_fired((fault_kind)what));
                loader_rest(s.l);
                fault_arm((fault_kind)what, 0);
                assert_int_equal(loader_failure(s.l), ST_OK);
                assert_in_range(loader_statistics(s.l).early, 0, n - 1);
                check(&s, 3);
                (void)show(&s, 4);
                check(&s, 4);
                free(touched);
                stage_close(&s);
            }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_steps),         cmocka_unit_test(test_little_room),
        cmocka_unit_test(test_expected),      cmocka_unit_test(test_expected_chain),
        cmocka_unit_test(test_expected_room), cmocka_unit_test(test_expected_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
