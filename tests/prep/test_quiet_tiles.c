/* test_quiet_tiles.c - work that is left out where samples are 0: files are what they are where
 * nothing can be left out, whatever the memory and the threads.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/grid/slice_tiles.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/naive_deviation.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

/* ---- Maps ---- */

static bool tile_is(const uint32_t dims[3], size_t index, size_t width, const char *slice,
                    const char *value) {
    const slice_tile t = slice_tiles_at(dims, index);
    bool all = true;
    for (uint32_t y = t.y; y < t.end_y; y++)
        for (uint32_t x = t.x; x < t.end_x; x++)
            all &= memcmp(slice + ((size_t)y * dims[0] + x) * width, value, width) == 0;
    return all;
}

static void test_maps(void **state) {
    (void)state;
    skip_under_thread();
    field_random r = {FIELD_SEED};
    for (int n = 0; n < 300; n++) {
        const uint32_t dims[3] = {2 + (uint32_t)field_random_below(&r, 90),
                                  2 + (uint32_t)field_random_below(&r, 60), 2};
        const size_t width = (size_t)1 << field_random_below(&r, 3);
        const size_t bytes = dims[0] * dims[1] * width, tiles = slice_tiles_count(dims);
        char *slice = malloc(bytes), *to = malloc(bytes);
        uint8_t *busy = malloc(tiles), *to_busy = malloc(tiles);
        const char value[4] = {(char)(n % 3), 0, (char)(n % 2), 0};
        for (size_t i = 0; i < bytes; i += width) {
            memcpy(slice + i, value, width);
            memcpy(to + i, value, width);
        }
        for (uint64_t k = field_random_below(&r, 8); k > 0; k--)
            slice[field_random_below(&r, (long)bytes)] ^= 1;
        slice_tiles_find(dims, width, slice, value, busy);
        for (size_t i = 0; i < tiles; i++) {
            const slice_tile t = slice_tiles_at(dims, i);
            assert_int_equal(!busy[i], tile_is(dims, i, width, slice, value));
            to_busy[i] = field_random_below(&r, 2) != 0;
            if (to_busy[i])
                to[((size_t)t.y * dims[0] + t.end_x - 1) * width] ^= 1;
        }
        for (uint32_t row = 0; row < slice_tiles_along(dims[1]); row++) {
            const uint32_t across = slice_tiles_along(dims[0]);
            bool any = false;
            for (uint32_t i = 0; i < across; i++)
                any |= busy[row * across + i];
            assert_int_equal(slice_tiles_row_busy(dims, busy, row), any);
        }
        slice_tiles_copy(dims, width, slice, busy, to, to_busy);
        assert_memory_equal(to, slice, bytes);
        assert_memory_equal(to_busy, busy, tiles);
        free(slice);
        free(to);
        free(busy);
        free(to_busy);
    }
}

/* ---- Files ---- */

/* A volume of zeros but for some boxes of waves and noise, at its corners, too. */
static void *make_sparse(const leaf_case *c, uint64_t seed) {
    field_random r = {seed};
    const size_t size = sample_size(c->type);
    const size_t count = (size_t)c->dims[0] * c->dims[1] * c->dims[2];
    char *noise = leaf_files_random(c, seed, 0), *samples = calloc(count, size);
    for (int n = 0; n < 3; n++) {
        uint32_t from[3], to[3];
        for (int a = 0; a < 3; a++) {
            from[a] = (uint32_t)field_random_below(&r, c->dims[a]);
            to[a] = from[a] + 1 + (uint32_t)field_random_below(&r, 20);
            from[a] = n == 0 ? c->dims[a] - 1 : n == 1 ? 0 : from[a];
            to[a] = to[a] < c->dims[a] ? to[a] : c->dims[a];
        }
        for (uint32_t z = from[2]; z < to[2]; z++)
            for (uint32_t y = from[1]; y < to[1]; y++)
                for (uint32_t x = from[0]; x < to[0]; x++) {
                    const size_t at = ((size_t)z * c->dims[1] + y) * c->dims[0] + x;
                    memcpy(samples + at * size, noise + at * size, size);
                }
    }
    for (int n = 0; n < 4; n++) { /* where families and their halos begin and end */
        size_t at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = 32 * (size_t)field_random_below(&r, 1 + c->dims[a] / 32);
            at[a] += (size_t)field_random_below(&r, 2);
            at[a] = at[a] < c->dims[a] ? at[a] : 0;
        }
        samples[((at[2] * c->dims[1] + at[1]) * c->dims[0] + at[0]) * size + size - 1] = 64;
    }
    free(noise);
    return samples;
}

/* The same where no tile is quiet: integers plus 2, which keeps how means are rounded; of floats
 * each 0 is -0. Returns what was added. */
static float make_busy(const leaf_case *c, const void *samples, void *busy) {
    const size_t count = (size_t)c->dims[0] * c->dims[1] * c->dims[2];
    for (size_t i = 0; i < count; i++)
        switch (c->type) {
        case SAMPLE_U8: ((uint8_t *)busy)[i] = (uint8_t)(((const uint8_t *)samples)[i] + 2); break;
        case SAMPLE_I16: ((int16_t *)busy)[i] = (int16_t)(((const int16_t *)samples)[i] + 2); break;
        default: {
            const float v = ((const float *)samples)[i];
            ((float *)busy)[i] = v == 0 ? -0.0F : v;
        }
        }
    return c->type == SAMPLE_F32 ? 0.0F : 2.0F;
}

/* Leave room for what is added. */
static void dampen(const leaf_case *c, void *samples) {
    const size_t count = (size_t)c->dims[0] * c->dims[1] * c->dims[2];
    for (size_t i = 0; i < count; i++)
        if (c->type == SAMPLE_U8)
            ((uint8_t *)samples)[i] /= 2;
        else if (c->type == SAMPLE_I16)
            ((int16_t *)samples)[i] /= 2;
}

static void load(naive_leaf *leaf, const char *path) {
    if (!naive_leaf_load(leaf, path))
        fail_msg("%s", leaf->why);
}

/* All levels' samples, and the deviations by a second reader. */
static void check_files(const char *sparse, const char *busy, float added, bool deviations) {
    static naive_leaf a, b;
    long known;
    load(&a, sparse);
    load(&b, busy);
    assert_int_equal(a.levels, b.levels);
    for (int level = 0; level < a.levels; level++) {
        const long *n = a.level[level].nodes;
        for (long k = 0; k < n[2]; k++)
            for (long j = 0; j < n[1]; j++)
                for (long i = 0; i < n[0]; i++) {
                    const float x = naive_leaf_sample(&a, level, i, j, k);
                    const float y = naive_leaf_sample(&b, level, i, j, k);
                    if (x + added != y)
                        fail_msg("level %d, node %ld %ld %ld: %g for %g", level, i, j, k, (double)x,
                                 (double)(y - added));
                }
    }
    const char *why = deviations ? naive_deviation_check(&a, 0, 500, 5, &known) : NULL;
    if (why)
        fail_msg("%s", why);
    naive_leaf_release(&a);
    naive_leaf_release(&b);
}

static void check_case(leaf_case *c, uint64_t seed) {
    const size_t bytes = (size_t)c->dims[0] * c->dims[1] * c->dims[2] * sample_size(c->type);
    void *samples = make_sparse(c, seed), *busy = malloc(bytes);
    char first[PATH_MAX], other[PATH_MAX];
    dampen(c, samples);
    const float added = make_busy(c, samples, busy);
    c->samples = busy;
    snprintf(other, sizeof other, "%s", leaf_files_make(c, "busy.leaf"));
    c->samples = samples;
    snprintf(first, sizeof first, "%s", leaf_files_make(c, "quiet.leaf"));
    if (!WATCHED_THREADS)
        check_files(first, other, added, c->options.file.deviations);
    c->options.threads = 3;
    const uint64_t least = leaf_files_least(c);
    for (int i = 0; i <= 4; i += WATCHED ? 4 : 1) {
        c->options.threads = 1 + i % 3;
        c->options.memory = least + (uint64_t)i * (96 << 10);
        scratch_same("memory", first, leaf_files_make(c, "memory.leaf"));
    }
    m.limit = 0;
    free(samples);
    free(busy);
}

static void test_files(void **state) {
    (void)state;
    static const uint32_t sizes[][3] = {{66, 35, 67}, {130, 97, 40}, {33, 150, 70}, {40, 40, 150}};
    static const sample_type types[] = {SAMPLE_U8, SAMPLE_I16, SAMPLE_F32};
    for (uint64_t i = 0; i < (WATCHED_THREADS ? 3 : WATCHED ? 4 : 24); i++) {
        const uint32_t *n = sizes[i % 4];
        leaf_case c = leaf_files_case(n[0], n[1], n[2], types[i % 3]);
        c.options.file.halo = i % 2;
        c.options.file.deviations = true;
        c.options.file.codec = i % 3 == 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
        c.options.file.zstd_level = 1;
        check_case(&c, FIELD_SEED + i);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_maps), cmocka_unit_test(test_files)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
