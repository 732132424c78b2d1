/* test_naive_reader.c - what the converter writes, read by the second reader, which knows
 * formats/FORMAT.md alone. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/leaf_files.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"

/* Sample i as the file is to hold it. */
static float want_sample(sample_type type, const void *samples, size_t i) {
    switch (type) {
    case SAMPLE_U8: return (float)((const uint8_t *)samples)[i];
    case SAMPLE_I8: return (float)((const int8_t *)samples)[i];
    case SAMPLE_U16: return (float)((const uint16_t *)samples)[i];
    case SAMPLE_I16: return (float)((const int16_t *)samples)[i];
    case SAMPLE_U32: return (float)((const uint32_t *)samples)[i];
    case SAMPLE_I32: return (float)((const int32_t *)samples)[i];
    case SAMPLE_F32: return ((const float *)samples)[i];
    default: return (float)((const double *)samples)[i];
    }
}

static bool same_bits(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

static void check_level0(const naive_leaf *leaf, const leaf_case *c) {
    size_t n = 0;
    for (int a = 0; a < 3; a++)
        assert_int_equal(leaf->dims[a], c->dims[a]);
    for (long k = 0; k < leaf->dims[2]; k++)
        for (long j = 0; j < leaf->dims[1]; j++)
            for (long i = 0; i < leaf->dims[0]; i++, n++)
                if (!same_bits(naive_leaf_sample(leaf, 0, i, j, k),
                               want_sample(c->type, c->samples, n)))
                    fail_msg("node %ld %ld %ld", i, j, k);
}

static long clamped(long i, long end) {
    return i < 0 ? 0 : i > end ? end : i;
}

/* The 1-4-6-4-1 mean about fine node (2i, 2j, 2k) of level - 1, from 125 weights; NaN where the
 * centre is no number. */
static double filtered(const naive_leaf *leaf, int level, const long at[3]) {
    static const double weight[5] = {1, 4, 6, 4, 1};
    const long *nodes = leaf->level[level - 1].nodes;
    double sum = 0, weights = 0;
    long node[3];
    for (int n = 0; n < 125; n++) {
        const int step[3] = {n % 5, n / 5 % 5, n / 25};
        double w = weight[step[0]] * weight[step[1]] * weight[step[2]];
        for (int a = 0; a < 3; a++)
            node[a] = clamped(2 * at[a] + step[a] - 2, nodes[a] - 1);
        float value = naive_leaf_sample(leaf, level - 1, node[0], node[1], node[2]);
        if (n == 62 && !isfinite(value))
            return NAN;
        if (isfinite(value)) {
            sum += w * (double)value;
            weights += w;
        }
    }
    return sum / weights;
}

static void check_pyramid(const naive_leaf *leaf) {
    bool integers = leaf->sample_type != 5;
    long at[3];
    for (int level = 1; level < leaf->levels; level++) {
        const long *nodes = leaf->level[level].nodes;
        for (at[2] = 0; at[2] < nodes[2]; at[2]++)
            for (at[1] = 0; at[1] < nodes[1]; at[1]++)
                for (at[0] = 0; at[0] < nodes[0]; at[0]++) {
                    double want = filtered(leaf, level, at);
                    double got = (double)naive_leaf_sample(leaf, level, at[0], at[1], at[2]);
                    bool good = integers ? got == nearbyint(want) /* sums are exact: half to even */
                                         : fabs(got - want) <= 1e-6 * (fabs(want) + 1);
                    if (!good && !(isnan(got) && isnan(want)))
                        fail_msg("level %d node %ld %ld %ld: %.9g, not %.9g", level, at[0], at[1],
                                 at[2], got, want);
                }
    }
}

static void check_case(const leaf_case *c) {
    naive_leaf leaf;
    const char *path = leaf_files_make(c, "naive.leaf");
    if (!naive_leaf_load(&leaf, path))
        fail_msg("%ux%ux%u type %d B 2^%u halo %u codec %d: %s", c->dims[0], c->dims[1], c->dims[2],
                 (int)c->type, c->options.file.cells_log2, c->options.file.halo,
                 (int)c->options.file.codec, leaf.why);
    check_level0(&leaf, c);
    check_pyramid(&leaf);
    naive_leaf_release(&leaf);
}

static void check_random(leaf_case c, uint64_t seed, int non_finite) {
    void *samples = leaf_files_random(&c, seed, non_finite);
    c.samples = samples;
    check_case(&c);
    free(samples);
}

/* 1, 2, B, B + 1, 2B + 1 nodes and cells and their neighbours on an axis. */
static void every_size(void **state) {
    (void)state;
    static const uint32_t dims[][3] = {
        {2, 2, 2},    {3, 2, 2},   {16, 17, 18}, {17, 17, 17}, {18, 16, 2},
        {33, 32, 34}, {34, 33, 2}, {65, 3, 49},  {2, 2, 130},  {50, 66, 35},
    };
    for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++)
        for (uint32_t log2 = 4; log2 <= 6; log2++) {
            leaf_case c = leaf_files_case(dims[i][0], dims[i][1], dims[i][2], SAMPLE_U8);
            c.options.file.cells_log2 = log2;
            c.options.file.halo = (uint32_t)(i + log2) % 2;
            check_random(c, 10 * i + log2, 0);
        }
}

static void every_type(void **state) {
    (void)state;
    for (int type = SAMPLE_U8; type <= SAMPLE_F64; type++)
        for (int codec = 0; codec <= 1; codec++) {
            leaf_case c = leaf_files_case(37, 20, 29, (sample_type)type);
            c.options.file.codec = codec ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
            check_random(c, (uint64_t)type, 0);
        }
}

static void missing_data(void **state) {
    (void)state;
    for (int one_in = 2; one_in <= 2000; one_in *= 10) {
        leaf_case c = leaf_files_case(35, 40, 21, SAMPLE_F32);
        check_random(c, (uint64_t)one_in, one_in);
    }
    /* Nothing but missing data; and -0, of which ranges make +0. */
    leaf_case c = leaf_files_case(20, 20, 20, SAMPLE_F32);
    float *samples = malloc(8000 * sizeof samples[0]);
    assert_non_null(samples);
    for (int kind = 0; kind < 2; kind++) {
        for (int i = 0; i < 8000; i++)
            samples[i] = kind ? -0.0f : i % 2 ? NAN : INFINITY;
        c.samples = samples;
        check_case(&c);
    }
    free(samples);
}

static void constant_and_extreme_values(void **state) {
    (void)state;
    static const float pairs[][2] = {{5, 5},
                                     {-1e30f, 1e30f},
                                     {1e-30f, 2e-30f},
                                     {0x1p-149f, 0x1p-148f},
                                     {-3.4e38f, 3.4e38f},
                                     {16777214, 16777215}};
    leaf_case c = leaf_files_case(33, 18, 19, SAMPLE_F32);
    size_t count = 33 * 18 * 19;
    float *samples = malloc(count * sizeof samples[0]);
    assert_non_null(samples);
    for (size_t n = 0; n < sizeof pairs / sizeof pairs[0]; n++) {
        for (size_t i = 0; i < count; i++)
            samples[i] = pairs[n][i * 2654435761u >> 7 & 1];
        c.samples = samples;
        naive_leaf leaf;
        if (!naive_leaf_load(&leaf, leaf_files_make(&c, "naive.leaf")))
            fail_msg("values %g %g: %s", (double)pairs[n][0], (double)pairs[n][1], leaf.why);
        check_level0(&leaf, &c);
        naive_leaf_release(&leaf);
    }
    free(samples);
}

static void rectilinear_axes(void **state) {
    (void)state;
    leaf_case c = leaf_files_case(21, 5, 40, SAMPLE_I16);
    for (int a = 0; a < 3; a++) {
        char text[4096] = "", name[16];
        for (uint32_t i = 0; i < c.dims[a]; i++)
            snprintf(text + strlen(text), sizeof text - strlen(text), "%.17g\n",
                     -3 + i * (1 + 0.125 * i));
        snprintf(name, sizeof name, "axis-%c.txt", 'x' + a);
        c.axis_file[a] = scratch_text(name, text);
    }
    void *samples = leaf_files_random(&c, 3, 0);
    c.samples = samples;
    naive_leaf leaf;
    if (!naive_leaf_load(&leaf, leaf_files_make(&c, "naive.leaf")))
        fail_msg("%s", leaf.why);
    assert_true(leaf.rectilinear);
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 0; i < c.dims[a]; i++)
            assert_true(leaf.axis[a][i] == -3 + i * (1 + 0.125 * i));
    naive_leaf_release(&leaf);
    free(samples);
}

/* ---- several sets ---- */

enum { FIELDS = 2, STEPS = 3, SETS = FIELDS * STEPS };

/* Steps of files of random samples, read twice: both fields have them, so that each set's samples
 * are known. One is a single value, whose payloads are implied. */
typedef struct series {
    leaf_case c;
    void *samples[STEPS];
    const char *paths[STEPS];
    grid_series of;
} series;

static void make_series(series *s, const uint32_t dims[3], sample_type type) {
    static const char *const names[FIELDS] = {"speed", "heat"};
    static const double times[STEPS] = {-1, 0.5, 7};
    const size_t count = (size_t)dims[0] * dims[1] * dims[2];
    s->c = leaf_files_case(dims[0], dims[1], dims[2], type);
    for (int step = 0; step < STEPS; step++) {
        char name[32];
        s->samples[step] = leaf_files_random(&s->c, (uint64_t)step + 40, 300);
        if (step == 1)
            memset(s->samples[step], 0, count * sample_size(type));
        snprintf(name, sizeof name, "step%d.bin", step);
        s->paths[step] = strdup(scratch_write(name, s->samples[step], count * sample_size(type)));
    }
    s->of = (grid_series){.of = {.paths = s->paths, .sets = {FIELDS, STEPS, names, times, NULL}},
                          .hints = {.dims = {dims[0], dims[1], dims[2]}, .type = type}};
}

static void release_series(series *s) {
    for (int step = 0; step < STEPS; step++) {
        free(s->samples[step]);
        free((void *)(uintptr_t)s->paths[step]);
    }
}

static const char *convert_series(series *s, const char *name) {
    mem m;
    volume *v = NULL;
    convert_plan plan;
    convert_result result;
    mem_init(&m, 0);
    s->c.options.series = &s->of;
    s->c.options.force = true;
    assert_int_equal(grid_series_open(&m, &s->of, 0, &v), ST_OK);
    assert_int_equal(convert_plan_make(&m, volume_grid(v), &s->c.options, &plan), ST_OK);
    assert_int_equal(convert_run(&m, v, scratch_path(name), &s->c.options, &plan, NULL, &result),
                     ST_OK);
    volume_close(v);
    assert_int_equal(mem_used(&m), 0);
    return scratch_path(name);
}

static void check_sets(series *s, const char *path) {
    for (long set = 0; set < SETS; set++) {
        naive_leaf leaf;
        if (!naive_leaf_load_set(&leaf, path, set))
            fail_msg("set %ld: %s", set, leaf.why);
        assert_int_equal(leaf.fields, FIELDS);
        assert_int_equal(leaf.steps, STEPS);
        assert_int_equal(leaf.version, 2);
        assert_string_equal(leaf.field_names[1], "heat");
        assert_true(leaf.times[0] == -1 && leaf.times[2] == 7);
        s->c.samples = s->samples[set % STEPS];
        check_level0(&leaf, &s->c);
        check_pyramid(&leaf);
        naive_leaf_release(&leaf);
    }
}

static void several_sets(void **state) {
    (void)state;
    static const uint32_t dims[][3] = {{18, 17, 19}, {37, 20, 33}, {9, 8, 7}};
    for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++)
        for (int type = 0; type < 2; type++) {
            series s;
            make_series(&s, dims[i], type ? SAMPLE_F32 : SAMPLE_U8);
            s.c.options.file.codec = i % 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
            check_sets(&s, convert_series(&s, "sets.leaf"));
            release_series(&s);
        }
}

/* Each of the first bytes, and then some, changed; and prefixes. */
static void check_every_byte(const char *path, size_t all, size_t step) {
    size_t size;
    char *bytes = scratch_read(path, &size);
    for (size_t i = 0; i < size; i += i < all ? 1 : step) {
        naive_leaf leaf;
        bytes[i] ^= 0x10;
        if (naive_leaf_load(&leaf, scratch_write("changed.leaf", bytes, size)))
            fail_msg("byte %zu of %zu does not count", i, size);
        bytes[i] ^= 0x10;
        naive_leaf_release(&leaf);
    }
    for (size_t i = 0; i < size; i += 997) {
        naive_leaf leaf;
        assert_false(naive_leaf_load(&leaf, scratch_write("changed.leaf", bytes, i)));
        naive_leaf_release(&leaf);
    }
    free(bytes);
}

/* The second reader is a judge only if it sees everything: each byte of a file, changed, is found
 * out. */
static void every_byte_counts(void **state) {
    (void)state;
    leaf_case c = leaf_files_case(18, 17, 19, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 9, 0);
    c.samples = samples;
    check_every_byte(leaf_files_make(&c, "naive.leaf"), 4096 + 400, 61);
    free(samples);
    series s;
    make_series(&s, (const uint32_t[3]){9, 8, 7}, SAMPLE_U8);
    check_every_byte(convert_series(&s, "sets.leaf"), 4096 + 2000, 499);
    release_series(&s);
}
int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_size),       cmocka_unit_test(every_type),
        cmocka_unit_test(missing_data),     cmocka_unit_test(constant_and_extreme_values),
        cmocka_unit_test(rectilinear_axes), cmocka_unit_test(every_byte_counts),
        cmocka_unit_test(several_sets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
