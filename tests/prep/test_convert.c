/* test_convert.c - whole conversions: what is in the file, that nothing but input and parameters
 * has a say in its bytes, and that a failure leaves nothing behind.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_verify.h"
#include "prep/grid/pyramid.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/loaded.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

static leaf_file *open_verified(const char *path) {
    leaf_file *f = NULL;
    if (leaf_file_open(&m, path, &f) != ST_OK || leaf_verify(&m, f, 2, NULL) != ST_OK)
        fail_msg("%s", status_text());
    return f;
}

/* All own samples of a level, put together from its treelets. */
static void *assemble(leaf_file *f, uint32_t level) {
    const leaf_level *v = &f->layout.level[level];
    size_t size = sample_size(f->layout.type);
    char *all = malloc((size_t)v->dims[0] * v->dims[1] * v->dims[2] * size);
    char *payload = aligned_alloc(64, leaf_layout_aligned(leaf_layout_payload_max(&f->layout), 6));
    for (uint32_t t = v->first; t < v->first + v->count; t++) {
        leaf_payload p = leaf_layout_payload(&f->layout, t);
        assert_int_equal(loaded(f, t, payload), ST_OK);
        uint32_t h = f->layout.halo;
        const uint32_t *place = f->layout.place[t], log2 = f->layout.cells_log2;
        for (uint32_t z = 0; z <= p.cells[2]; z++)
            for (uint32_t y = 0; y <= p.cells[1]; y++) {
                size_t from = h + p.samples[0] * (y + h + (size_t)p.samples[1] * (z + h));
                size_t to = (place[0] << log2) +
                            v->dims[0] * ((place[1] << log2) + y +
                                          (size_t)v->dims[1] * ((place[2] << log2) + z));
                memcpy(all + to * size, payload + p.samples_at + from * size,
                       (p.cells[0] + 1) * size);
            }
    }
    free(payload);
    return all;
}

static void *coarser(const leaf_level *fine, sample_type type, const void *samples) {
    pool *workers;
    pyramid *p;
    assert_int_equal(pool_create(&m, 1, &workers), ST_OK);
    assert_int_equal(pyramid_create(&m, type, false, fine->dims, 1, &p), ST_OK);
    size_t bytes = sample_size(type);
    for (int a = 0; a < 3; a++)
        bytes *= pyramid_coarse(fine->dims[a]);
    void *coarse = malloc(bytes);
    assert_int_equal(pyramid_feed(p, workers, samples, NULL, fine->dims[2], coarse, NULL), ST_OK);
    pyramid_destroy(p);
    pool_destroy(workers);
    return coarse;
}

/* The file is sound, and every level is what the input and the pyramid make it. */
static void check_content(const char *path, const void *samples) {
    leaf_file *f = open_verified(path);
    size_t size = sample_size(f->layout.type);
    void *expected = NULL;
    for (uint32_t level = 0; level < f->layout.levels; level++) {
        const leaf_level *v = &f->layout.level[level];
        void *next = level ? coarser(v - 1, f->layout.type, level > 1 ? expected : samples) : NULL;
        free(expected);
        expected = next;
        void *got = assemble(f, level);
        assert_memory_equal(got, level ? expected : samples,
                            (size_t)v->dims[0] * v->dims[1] * v->dims[2] * size);
        free(got);
    }
    free(expected);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

/* 2, B, B + 1, 2B, 2B + 1 and between, thin and long, with B = 16. */
static const uint32_t SIZES[][3] = {{2, 2, 2},    {16, 16, 16}, {17, 17, 17}, {32, 32, 32},
                                    {33, 33, 33}, {34, 18, 16}, {2, 70, 3},   {100, 2, 2},
                                    {2, 2, 150},  {66, 35, 67}};
enum { SIZE_COUNT = sizeof SIZES / sizeof SIZES[0] };

static void test_sizes(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < SIZE_COUNT; i++)
        for (int type = SAMPLE_U8; type <= SAMPLE_F32; type++) {
            leaf_case c = leaf_files_case(SIZES[i][0], SIZES[i][1], SIZES[i][2], (sample_type)type);
            c.options.file.halo = (uint32_t)(i + type) & 1;
            void *samples = leaf_files_random(&c, FIELD_SEED + (uint64_t)i,
                                              type == SAMPLE_F32 && i % 2 ? 50 : 0);
            c.samples = samples;
            check_content(leaf_files_make(&c, "sizes.leaf"), samples);
            free(samples);
        }
}

/* Threads, memory (spilled or not, wide columns or narrow, one slice at a time or many) change
 * nothing. */
static void test_same_bytes(void **state) {
    (void)state;
    for (int i = 0; i < SIZE_COUNT; i++)
        for (int zstd = 0; zstd < 2; zstd++) {
            leaf_case c = leaf_files_case(SIZES[i][0], SIZES[i][1], SIZES[i][2],
                                          i % 2 ? SAMPLE_U16 : SAMPLE_F32);
            c.options.file.codec = zstd ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
            c.options.file.zstd_level = 1;
            void *samples = leaf_files_random(&c, FIELD_SEED, 200);
            c.samples = samples;
            c.options.threads = 1;
            char first[PATH_MAX];
            snprintf(first, sizeof first, "%s", leaf_files_make(&c, "first.leaf"));
            for (int threads = 1; threads <= 5; threads += WATCHED ? 2 : 1) {
                c.options.threads = threads;
                scratch_same("threads", first, leaf_files_make(&c, "threads.leaf"));
            }
            c.options.threads = 2;
            const uint64_t least = leaf_files_least(&c);
            for (uint64_t more = 0; more <= 4; more += WATCHED ? 2 : 1) {
                c.options.memory = least + more * (64 << 10);
                scratch_same("memory", first, leaf_files_make(&c, "memory.leaf"));
            }
            free(samples);
            m.limit = 0;
        }
    assert_int_equal(mem_used(&m), 0);
}

/* The budget holds, and what a plan says of memory, spilling and the file's size is so. */
static void test_plan(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = leaf_files_case(150, 130, 90, SAMPLE_U8);
    c.options.force = true;
    uint8_t *samples = leaf_files_random(&c, FIELD_SEED, 0);
    c.samples = samples;
    /* Noise, so that no payload is implied. */
    for (size_t i = 0; i < (size_t)150 * 130 * 90; i++)
        samples[i] = (uint8_t)((uint32_t)i * 2654435761u >> 13);
    const uint64_t least = leaf_files_least(&c);
    for (uint64_t i = 0; i < 12; i++) {
        convert_plan plan;
        convert_result result;
        mem_init(&m, 0);
        c.options.memory = least + i * (400 << 10);
        status st = leaf_files_try(&m, &c, "plan.leaf", &plan, &result);
        assert_int_equal(mem_used(&m), 0);
        assert_int_equal(st, ST_OK);
        assert_int_equal(plan.file_bytes, result.header.file_bytes);
        assert_int_equal(plan.payload_bytes, result.header.payload_bytes);
        assert_true(mem_peak(&m) <= plan.memory && plan.memory <= c.options.memory);
        assert_int_equal(plan.spilled_levels == 0, plan.memory_in_core <= c.options.memory);
        assert_int_equal(plan.spilled_levels == 0, plan.spill_bytes == 0);
        assert_int_equal(plan.memory_least, least);
    }
    c.options.memory = least - 1;
    assert_int_equal(leaf_files_try(&m, &c, "plan2.leaf", NULL, NULL), ST_NOMEM);
    assert_non_null(strstr(status_text(), "too small"));
    m.limit = 0;
    free(samples);
}

static void test_compressed(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = leaf_files_case(50, 40, 45, SAMPLE_I16);
    void *samples = leaf_files_random(&c, FIELD_SEED, 0);
    c.samples = samples;
    check_content(leaf_files_make(&c, "raw.leaf"), samples);
    c.options.file.codec = LEAF_CODEC_ZSTD;
    c.options.file.zstd_level = 5;
    check_content(leaf_files_make(&c, "zstd.leaf"), samples);
    leaf_file *raw = open_verified(scratch_path("raw.leaf")),
              *zstd = open_verified(scratch_path("zstd.leaf"));
    assert_true(zstd->header.payload_bytes < raw->header.payload_bytes);
    assert_memory_equal(raw->ranges, zstd->ranges, raw->layout.treelets * sizeof *raw->ranges);
    assert_memory_equal(raw->own, zstd->own, raw->layout.treelets * sizeof *raw->own);
    char *a = aligned_alloc(64, leaf_layout_aligned(leaf_layout_payload_max(&raw->layout), 6)),
         *b = aligned_alloc(64, leaf_layout_aligned(leaf_layout_payload_max(&raw->layout), 6));
    for (uint32_t t = 0; t < raw->layout.treelets; t++) {
        assert_int_equal(leaf_file_load(raw, t, NULL, a), ST_OK);
        assert_int_equal(loaded(zstd, t, b), ST_OK);
        assert_memory_equal(a, b, leaf_layout_payload(&raw->layout, t).bytes);
    }
    free(a);
    free(b);
    leaf_file_close(raw);
    leaf_file_close(zstd);
    free(samples);
    /* What does not get smaller is stored as it is: samples without codes. */
    c = leaf_files_case(17, 17, 17, SAMPLE_U16);
    uint16_t *noise = malloc(17 * 17 * 17 * sizeof *noise);
    field_random r = {FIELD_SEED};
    for (int i = 0; i < 17 * 17 * 17; i++)
        noise[i] = (uint16_t)field_random_bits(&r);
    c.samples = noise;
    c.options.file.codec = LEAF_CODEC_ZSTD;
    c.options.file.zstd_level = 1;
    c.options.file.halo = 0;
    check_content(leaf_files_make(&c, "noise.leaf"), noise);
    leaf_file *f = open_verified(scratch_path("noise.leaf"));
    assert_int_equal(f->sizes[0], 16 + 17 * 17 * 17 * sizeof *noise);
    leaf_file_close(f);
    free(noise);
}

static void test_rectilinear(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = leaf_files_case(20, 5, 33, SAMPLE_U8);
    void *samples = leaf_files_random(&c, FIELD_SEED, 0);
    c.samples = samples;
    c.axis_file[1] = scratch_text("axis", "-3 0.5 0.75 10\n1e3\n");
    check_content(leaf_files_make(&c, "axis.leaf"), samples);
    leaf_file *f = open_verified(scratch_path("axis.leaf"));
    static const double y[] = {-3, 0.5, 0.75, 10, 1e3};
    assert_int_equal(f->header.rectilinear, 1);
    assert_memory_equal(f->axis[1], y, sizeof y);
    assert_true(f->axis[0][19] == 19 && f->axis[2][32] == 32);
    leaf_file_close(f);
    free(samples);
}

/* u32, i32 and f64 become f32, and what that costs is told. */
static void test_rounded(void **state) {
    (void)state;
    skip_under_thread();
    static const sample_type types[] = {SAMPLE_U32, SAMPLE_I32, SAMPLE_F64};
    for (int i = 0; i < 3; i++) {
        leaf_case c = leaf_files_case(19, 18, 35, types[i]);
        void *samples = leaf_files_random(&c, FIELD_SEED, 0);
        size_t count = 19 * 18 * 35;
        float *stored = malloc(count * sizeof *stored);
        double error = sample_to_stored(types[i], samples, stored, count);
        c.samples = samples;
        check_content(leaf_files_make(&c, "rounded.leaf"), stored);
        leaf_file *f = open_verified(scratch_path("rounded.leaf"));
        assert_int_equal(f->header.source_type, types[i]);
        assert_int_equal(f->header.sample_type, SAMPLE_F32);
        assert_true(error > 0 && f->header.rounding_error == error);
        leaf_file_close(f);
        free(samples);
        free(stored);
    }
}

static void test_non_finite(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = leaf_files_case(35, 20, 40, SAMPLE_F32);
    float *samples = leaf_files_random(&c, FIELD_SEED, 30);
    uint64_t count = 0;
    double lo = (double)INFINITY, hi = -(double)INFINITY;
    for (int i = 0; i < 35 * 20 * 40; i++)
        if (isfinite(samples[i])) {
            lo = fmin(lo, (double)samples[i]);
            hi = fmax(hi, (double)samples[i]);
        } else {
            count++;
        }
    c.samples = samples;
    leaf_files_make(&c, "nan.leaf");
    leaf_file *f = open_verified(scratch_path("nan.leaf"));
    assert_int_equal(f->header.non_finite, count);
    assert_true(f->header.value_min == lo && f->header.value_max == hi);
    leaf_file_close(f);
    for (int i = 0; i < 35 * 20 * 40; i++)
        samples[i] = i % 2 ? NAN : INFINITY;
    check_content(leaf_files_make(&c, "none.leaf"), samples);
    f = open_verified(scratch_path("none.leaf"));
    assert_true(f->header.value_min > f->header.value_max && f->ranges[0][0] > f->ranges[0][1]);
    leaf_file_close(f);
    free(samples);
}

static void test_exists(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = leaf_files_case(4, 4, 4, SAMPLE_U8);
    void *samples = leaf_files_random(&c, FIELD_SEED, 0);
    c.samples = samples;
    scratch_text("there.leaf", "mine");
    assert_int_equal(leaf_files_try(&m, &c, "there.leaf", NULL, NULL), ST_EXISTS);
    char *text = scratch_read(scratch_path("there.leaf"), NULL);
    assert_string_equal(text, "mine");
    free(text);
    c.options.force = true;
    assert_int_equal(leaf_files_try(&m, &c, "there.leaf", NULL, NULL), ST_OK);
    check_content(scratch_path("there.leaf"), samples);
    free(samples);
}

/* Each allocation, read, write and thread fails in turn: an error, said; nothing left anywhere. */
static void sweep(leaf_case *c, fault_kind kind) {
    size_t files = scratch_count();
    long k = 0;
    for (bool fired = true; fired;) {
        mem_init(&m, 0);
        fault_arm(kind, k += 1 + (WATCHED_THREADS ? k / 4 : 0));
        status st = leaf_files_try(&m, c, "fault.leaf", NULL, NULL);
        fired = fault_fired(kind);
        fault_arm(kind, 0);
        /* A fault may also hit what is only tried, such as the folder's fsync. */
        if (st == ST_OK)
            assert_int_equal(remove(scratch_path("fault.leaf")), 0);
        else if (!fired || !*status_text())
            fail_msg("fault %d of kind %d: status %d: %s", (int)k, kind, st, status_text());
        assert_int_equal(mem_used(&m), 0);
        assert_int_equal(scratch_count(), files);
    }
    assert_true(k > 1);
}

static void test_faults(void **state) {
    (void)state;
    for (int zstd = 0; zstd < 2; zstd++) {
        leaf_case c = leaf_files_case(40, 70, 36, SAMPLE_F32);
        float *samples = leaf_files_random(&c, FIELD_SEED, 100);
        c.samples = samples;
        /* So that payloads are implied, and others move. */
        for (size_t i = 0; i < (size_t)40 * 70 * 36; i++)
            samples[i] = i / 40 % 70 < 35 ? 1.0F : samples[i];
        c.options.threads = 3;
        c.options.file.codec = zstd ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
        c.options.file.zstd_level = 1;
        c.options.memory = leaf_files_least(&c);
        sweep(&c, FAULT_ALLOC);
        sweep(&c, FAULT_READ);
        sweep(&c, FAULT_WRITE);
        sweep(&c, FAULT_THREAD);
        free(samples);
        m.limit = 0;
    }
}

/* Asked to stop, at any point: it stops, and nothing is left. */
static bool stop_later(void *ctx) {
    return --*(int *)ctx <= 0;
}

static void test_stop(void **state) {
    (void)state;
    leaf_case c = leaf_files_case(40, 40, 70, SAMPLE_U8);
    void *samples = leaf_files_random(&c, FIELD_SEED, 0);
    c.samples = samples;
    c.options.memory = leaf_files_least(&c);
    const char *path = scratch_write("stop_40x40x70_uint8.raw", samples, 40 * 40 * 70);
    size_t files = scratch_count();
    for (int steps = 1; steps < 6; steps++) {
        int left = steps;
        progress p = {.stop = stop_later, .ctx = &left};
        volume *v;
        convert_plan plan;
        convert_result result;
        assert_int_equal(volume_open(&m, path, NULL, &v), ST_OK);
        assert_int_equal(convert_plan_make(&m, volume_grid(v), &c.options, &plan), ST_OK);
        assert_int_equal(
            convert_run(&m, v, scratch_path("stop.leaf"), &c.options, &plan, &p, &result),
            ST_STOPPED);
        volume_close(v);
        assert_int_equal(mem_used(&m), 0);
        assert_int_equal(scratch_count(), files);
    }
    free(samples);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_sizes, set_up),
        cmocka_unit_test_setup(test_same_bytes, set_up),
        cmocka_unit_test_setup(test_plan, set_up),
        cmocka_unit_test_setup(test_compressed, set_up),
        cmocka_unit_test_setup(test_rectilinear, set_up),
        cmocka_unit_test_setup(test_rounded, set_up),
        cmocka_unit_test_setup(test_non_finite, set_up),
        cmocka_unit_test_setup(test_exists, set_up),
        cmocka_unit_test_setup(test_faults, set_up),
        cmocka_unit_test_setup(test_stop, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
