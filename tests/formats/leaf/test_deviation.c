/* test_deviation.c - the deviations in treelet files: worked out again by a second reader, the same
 * bytes whatever the memory and the threads, and damage that opening or verify finds.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "formats/leaf/deviation.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/leaf_verify.h"
#include "stream/active.h"
#include "tests/support/leaf_files.h"
#include "tests/support/leaf_image.h"
#include "tests/support/naive_deviation.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

static status verify(const char *path) {
    leaf_file *f = NULL;
    status st = leaf_file_open(&m, path, &f);
    if (st == ST_OK)
        st = leaf_verify(&m, f, 2, NULL);
    leaf_file_close(f);
    return st;
}

static leaf_case case_of(uint32_t x, uint32_t y, uint32_t z, sample_type type) {
    leaf_case c = leaf_files_case(x, y, z, type);
    c.options.file.deviations = true;
    return c;
}

/* ---- Codes ---- */

static void test_codes(void **state) {
    (void)state;
    skip_under_thread();
    assert_int_equal(deviation_code(0.0), 0);
    assert_int_equal(deviation_code((double)INFINITY), DEVIATION_UNKNOWN);
    assert_int_equal(deviation_code((double)NAN), DEVIATION_UNKNOWN);
    assert_int_equal(deviation_code((double)FLT_MAX), DEVIATION_UNKNOWN);
    assert_int_equal(deviation_code(1e300), DEVIATION_UNKNOWN);
    assert_true(deviation_value(DEVIATION_UNKNOWN) == (double)INFINITY);
    for (unsigned code = 0; code < DEVIATION_UNKNOWN; code++) {
        const double value = deviation_value((uint16_t)code);
        assert_int_equal(deviation_code(value), code);
        assert_int_equal(deviation_code(nextafter(value, INFINITY)), code + 1);
        if (code > 0)
            assert_int_equal(deviation_code(nextafter(value, 0.0)), code);
    }
}

/* Where something is rounded: more than what a few operations on the largest value lose. */
static void test_rounding(void **state) {
    (void)state;
    skip_under_thread();
    const double range[2] = {-4.0, 2.0}, none[2] = {(double)INFINITY, -(double)INFINITY};
    assert_true(deviation_rounding(SAMPLE_U16, false, range, 3) == 0.0);
    assert_true(deviation_rounding(SAMPLE_U16, true, range, 3) >= 3 * 4.0 * 64 * 0x1p-53);
    assert_true(deviation_rounding(SAMPLE_F32, false, range, 3) >= 3 * 4.0 * 64 * 0x1p-53);
    assert_true(deviation_rounding(SAMPLE_F32, false, range, 1) < 1e-12);
    assert_true(deviation_rounding(SAMPLE_F32, false, none, 1) == 0.0);
}

/* ---- Files ---- */

/* Returns how many bricks have a number. */
static long check_file(const leaf_case *c, const char *what) {
    const char *path = leaf_files_make(c, "d.leaf");
    static naive_leaf leaf;
    long known = 0;
    if (!naive_leaf_load(&leaf, path))
        fail_msg("%s: %s", what, leaf.why);
    const char *why = naive_deviation_check(&leaf, 0, 2000, 5, &known);
    if (why)
        fail_msg("%s: %s", what, why);
    naive_leaf_release(&leaf);
    if (verify(path) != ST_OK)
        fail_msg("%s: %s", what, status_text());
    return known;
}

static void test_types(void **state) {
    (void)state;
    skip_under_thread();
    static const sample_type types[] = {SAMPLE_U8,  SAMPLE_I8,  SAMPLE_U16, SAMPLE_I16,
                                        SAMPLE_F32, SAMPLE_U32, SAMPLE_F64};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        leaf_case c = case_of(37 + (uint32_t)i, 50, 34, types[i]);
        c.options.file.halo = i % 2;
        c.options.file.codec = i % 3 ? LEAF_CODEC_RAW : LEAF_CODEC_ZSTD;
        c.options.file.zstd_level = 1;
        void *samples = leaf_files_random(&c, 7 + i, 0);
        c.samples = samples;
        assert_true(check_file(&c, sample_name(types[i])) >= 3 * 4 * 3);
        free(samples);
    }
}

/* Odd and even ends, of all bricks' and treelets' kinds. */
static void test_sizes(void **state) {
    (void)state;
    skip_under_thread();
    for (uint32_t i = 0; i < 18; i++) {
        leaf_case c = case_of(17 + i, 68 - 3 * i, 2 + i % 5, SAMPLE_U8);
        c.options.file.cells_log2 = i % 6 == 5 ? 5 : 4;
        void *samples = leaf_files_random(&c, i, 0);
        char what[40];
        snprintf(what, sizeof what, "%u x %u x %u", c.dims[0], c.dims[1], c.dims[2]);
        c.samples = samples;
        if (c.dims[0] > 17 || c.dims[1] > 17)
            (void)check_file(&c, what);
        free(samples);
    }
}

static const char *write_axis(const char *name, int nodes, double bend) {
    static char text[4096];
    size_t n = 0;
    for (int i = 0; i < nodes; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "%.17g\n", 0.3 * i + bend * i * i);
    return scratch_text(name, text);
}

static void test_rectilinear(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < 4; i++) {
        leaf_case c = case_of(36, 45, 39, i % 2 ? SAMPLE_F32 : SAMPLE_U8);
        void *samples = leaf_files_random(&c, 3 + (uint64_t)i, 0);
        c.samples = samples;
        c.axis_file[0] = write_axis("x.txt", 36, i > 1 ? 0.7 : 0.01);
        c.axis_file[1] = write_axis("y.txt", 45, 0.1 * (i % 3));
        c.axis_file[2] = write_axis("z.txt", 39, 0.2);
        (void)check_file(&c, "rectilinear");
        free(samples);
    }
}

/* Here a NaN, there a number. */
static void test_missing(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = case_of(70, 60, 50, SAMPLE_F32);
    void *samples = leaf_files_random(&c, 9, 40000);
    c.samples = samples;
    const long bricks = 5 * 4 * 4 + 3 * 2 * 2 + 2 + 1;
    const long known = check_file(&c, "some are missing");
    assert_true(known > 20 && known < bricks);
    free(samples);
}

/* Constant, and linear: nothing is off but at an odd end. */
static void test_flat(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = case_of(65, 65, 65, SAMPLE_U8);
    unsigned char *samples = malloc((size_t)65 * 65 * 65);
    for (int i = 0; i < 65 * 65 * 65; i++)
        samples[i] = 77;
    c.samples = samples;
    leaf_file *f = NULL;
    (void)check_file(&c, "constant");
    assert_int_equal(leaf_file_open(&m, leaf_files_make(&c, "d.leaf"), &f), ST_OK);
    for (size_t i = 0; i < deviation_count(&f->layout); i++)
        assert_int_equal(f->deviations[i], 0);
    leaf_file_close(f);
    for (int i = 0; i < 65 * 65 * 65; i++)
        samples[i] = (unsigned char)(i % 65 + i / 65 % 65);
    (void)check_file(&c, "linear");
    assert_int_equal(leaf_file_open(&m, leaf_files_make(&c, "d.leaf"), &f), ST_OK);
    /* A brick of level 1 that does not touch the border: clamped filters bend there. */
    const uint32_t place[3] = {0, 0, 0};
    const uint32_t t = leaf_layout_find(&f->layout, 1, place);
    const uint16_t *of = f->deviations + deviation_at(&f->layout, 0, t);
    assert_int_equal(of[deviation_brick(&f->layout, 8, 8, 8)], 0);
    assert_true(deviation_value(of[0]) > 0.0);
    leaf_file_close(f);
    free(samples);
}

static void test_same_bytes(void **state) {
    (void)state;
    leaf_case c = case_of(100, 90, 80, SAMPLE_F32);
    void *samples = leaf_files_random(&c, 5, 5000);
    c.samples = samples;
    size_t size = 0, other = 0;
    char *first = scratch_read(leaf_files_make(&c, "one.leaf"), &size);
    for (int threads = 1; threads <= 5; threads += 2)
        for (int tight = 0; tight < 2; tight++) {
            c.options.threads = threads;
            c.options.memory = tight ? leaf_files_least(&c) : 1 << 30;
            char *again = scratch_read(leaf_files_make(&c, "two.leaf"), &other);
            assert_int_equal(size, other);
            assert_memory_equal(first, again, size);
            free(again);
        }
    free(first);
    free(samples);
}

/* Without the section, and where there is nothing to say: files as they were. */
static void test_without(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < 2; i++) {
        leaf_case c = case_of(i ? 17 : 40, 16, 15, SAMPLE_U8);
        c.options.file.deviations = i;
        void *samples = leaf_files_random(&c, 2, 0);
        leaf_file *f = NULL;
        c.samples = samples;
        const char *path = leaf_files_make(&c, "old.leaf");
        assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
        assert_null(f->deviations);
        assert_int_equal(f->layout.levels, i ? 1 : 3);
        leaf_file_close(f);
        assert_int_equal(verify(path), ST_OK);
        free(samples);
    }
}

/* ---- Where there may be something ---- */

/* Whether any sample of level 0 in a box of cells of a level lies in [lo, hi]. */
static bool any_in(const leaf_case *c, uint32_t level, const uint32_t first[3], uint32_t cells,
                   const float in[2]) {
    uint32_t from[3], to[3];
    for (int a = 0; a < 3; a++) {
        from[a] = first[a] << level;
        to[a] = from[a] + (cells << level);
        to[a] = to[a] < c->dims[a] ? to[a] : c->dims[a] - 1;
    }
    for (uint32_t z = from[2]; z <= to[2]; z++)
        for (uint32_t y = from[1]; y <= to[1]; y++)
            for (uint32_t x = from[0]; x <= to[0]; x++) {
                const size_t at = x + c->dims[0] * (y + (size_t)c->dims[1] * z);
                const float v = ((const unsigned char *)c->samples)[at];
                if (v >= in[0] && v <= in[1])
                    return true;
            }
    return false;
}

/* Blocks of treelet t, of 2^3 or 4^3; counts[0]: those that are left out, [1]: that have it. */
static void check_wide(const leaf_case *c, const leaf_file *f, uint32_t t, const active_masks *wide,
                       const float in[2], size_t counts[2]) {
    const leaf_layout *l = &f->layout;
    const leaf_payload p = leaf_layout_payload(l, t);
    for (uint32_t b = 0; b < 1u << (3 * p.node_levels); b++) {
        uint32_t at[3] = {0, 0, 0}, first[3];
        bool there = true;
        for (uint32_t bit = 0; bit < p.node_levels; bit++)
            for (uint32_t a = 0; a < 3; a++)
                at[a] |= (b >> (3 * bit + a) & 1u) << bit;
        for (int a = 0; a < 3; a++) {
            there &= 4 * at[a] < p.cells[a];
            first[a] = (l->place[t][a] << l->cells_log2) + 4 * at[a];
        }
        const bool has = there && any_in(c, l->level_of[t], first, 4, in);
        if ((has || !there) && (wide->cells[b] != 0) != has)
            fail_msg("treelet %u, block %u: %016llx", t, b, (unsigned long long)wide->cells[b]);
        counts[has] += has || !wide->cells[b];
    }
}

/* Blocks where level 0 has something of interest are walked, and not all others. */
static void test_wide(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = case_of(69, 60, 41, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 21, 0);
    leaf_file *f = NULL;
    size_t counts[2] = {0, 0};
    c.samples = samples;
    assert_int_equal(leaf_file_open(&m, leaf_files_make(&c, "wide.leaf"), &f), ST_OK);
    const leaf_layout *l = &f->layout;
    const uint32_t levels = l->cells_log2 - LEAF_BLOCK_LOG2;
    void *payload = mem_alloc(&m, leaf_layout_payload_max(l));
    void *blocks[2] = {mem_alloc(&m, active_bytes(levels)), mem_alloc(&m, active_bytes(levels))};
    active_masks *exact = active_init(blocks[0], levels), *wide = active_init(blocks[1], levels);
    for (uint32_t t = 0; t < l->level[0].first; t++) {
        assert_int_equal(leaf_file_load(f, t, NULL, payload), ST_OK);
        for (int v = 0; v < 255; v += 15) {
            const float in[2] = {(float)v, (float)v + 3};
            const interest_interval of = {.lo = v, .hi = v + 3};
            const interest some = interest_of_intervals(&of, 1);
            active_compute(exact, f, t, payload, &some);
            active_wide(wide, exact, f, t, payload, &some);
            check_wide(&c, f, t, wide, in, counts);
        }
    }
    assert_true(counts[0] > 100 && counts[1] > 1000);
    for (int i = 0; i < 2; i++)
        mem_free(&m, blocks[i]);
    mem_free(&m, payload);
    leaf_file_close(f);
    free(samples);
}

/* What stands in for a treelet of level 0: the greatest of all bricks that its cells are in. */
static void check_over(uint32_t cells_log2) {
    leaf_case c = case_of(133, 70, 41, SAMPLE_U8);
    const uint32_t side = 1u << cells_log2, bricks = side / DEVIATION_BRICK;
    c.options.file.cells_log2 = cells_log2;
    void *samples = leaf_files_random(&c, 22, 0);
    leaf_file *f = NULL;
    c.samples = samples;
    assert_int_equal(leaf_file_open(&m, leaf_files_make(&c, "over.leaf"), &f), ST_OK);
    const leaf_layout *l = &f->layout;
    for (uint32_t t = l->level[0].first; t < l->treelets; t++)
        for (uint32_t k = 1; k < l->levels; k++) {
            const leaf_payload p = leaf_layout_payload(l, t);
            double most = 0.0;
            uint32_t up, place[3], at[3];
            const double off = deviation_over(l, f->deviations, 0, t, k, &up);
            for (uint32_t i = 0; i < p.cells[0] * p.cells[1] * p.cells[2]; i++) {
                const uint32_t in[3] = {i % p.cells[0], i / p.cells[0] % p.cells[1],
                                        i / p.cells[0] / p.cells[1]};
                for (int a = 0; a < 3; a++) {
                    const uint32_t cell = (l->place[t][a] * side + in[a]) >> k;
                    place[a] = cell / side;
                    at[a] = cell % side / DEVIATION_BRICK;
                }
                const uint32_t brick = at[0] + bricks * (at[1] + bricks * at[2]);
                assert_int_equal(leaf_layout_find(l, k, place), up);
                most = fmax(most,
                            deviation_value(f->deviations[up * bricks * bricks * bricks + brick]));
            }
            assert_true(off == most);
        }
    leaf_file_close(f);
    free(samples);
}

static void test_over(void **state) {
    (void)state;
    skip_under_thread();
    check_over(4); /* a treelet is over one brick */
    check_over(5); /* over some */
}

/* ---- Damage ---- */

typedef struct damage {
    leaf_image image;
    uint16_t *codes;
    leaf_layout layout;
} damage;

static void damage_begin(damage *d, const leaf_case *c) {
    size_t size = 0;
    char *bytes = scratch_read(leaf_files_make(c, "sound.leaf"), &size);
    d->image = leaf_image_of(bytes, size);
    d->codes = leaf_image_section(&d->image, LEAF_SECTION_DEVIATIONS);
    assert_non_null(d->codes);
    assert_int_equal(
        leaf_layout_init(&d->layout, &m, c->dims, c->options.file.cells_log2, 1, c->type), ST_OK);
}

/* Opening and verify of a file with one code changed. */
static void damage_try(damage *d, size_t i, uint16_t code, status opens, status verifies) {
    const uint16_t before = d->codes[i];
    leaf_file *f = NULL;
    d->codes[i] = code;
    leaf_image_seal(&d->image);
    const char *path = scratch_write("bad.leaf", d->image.bytes, d->image.size);
    const status st = leaf_file_open(&m, path, &f);
    leaf_file_close(f);
    if (st != opens || verify(path) != verifies)
        fail_msg("code %zu, %04x for %04x: opening says %d, verify %d", i, code, before, st,
                 verify(path));
    d->codes[i] = before;
}

/* Whether a brick begins before its treelet's cells end. */
static bool is_there(const leaf_layout *l, uint32_t t, uint32_t brick) {
    const leaf_payload p = leaf_layout_payload(l, t);
    return brick % 2 * 8 < p.cells[0] && brick / 2 % 2 * 8 < p.cells[1] &&
           brick / 4 * 8 < p.cells[2];
}

static void test_damage(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = case_of(40, 30, 20, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 11, 0);
    damage d;
    size_t lowered = 0, outside = 0;
    c.samples = samples;
    damage_begin(&d, &c);
    for (size_t i = 0; i < deviation_count(&d.layout); i++) {
        const uint32_t t = (uint32_t)(i / deviation_bricks(&d.layout));
        const uint32_t brick = (uint32_t)(i % deviation_bricks(&d.layout));
        damage_try(&d, i, DEVIATION_UNKNOWN + 1, ST_CORRUPT, ST_CORRUPT);
        damage_try(&d, i, 0x8000, ST_CORRUPT, ST_CORRUPT);
        if (!is_there(&d.layout, t, brick)) {
            damage_try(&d, i, 1, ST_CORRUPT, ST_CORRUPT);
            outside++;
            continue;
        }
        if (d.codes[i] > 0) {
            damage_try(&d, i, (uint16_t)(d.codes[i] - 1), ST_OK, ST_CORRUPT);
            lowered++;
        }
        /* More than is needed is no lie, if it is so above, too. */
        if (t == 0)
            damage_try(&d, i, DEVIATION_UNKNOWN, ST_OK, ST_OK);
    }
    assert_true(lowered > 10 && outside > 5);
    leaf_layout_release(&d.layout);
    free(d.image.bytes);
    free(samples);
}

int main(int argc, char **argv) {
    if (argc == 2)
        cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_codes),       cmocka_unit_test(test_rounding),
        cmocka_unit_test(test_types),       cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_rectilinear), cmocka_unit_test(test_missing),
        cmocka_unit_test(test_flat),        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_without),     cmocka_unit_test(test_wide),
        cmocka_unit_test(test_over),        cmocka_unit_test(test_damage),
    };
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
