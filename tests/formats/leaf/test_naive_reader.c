/* test_naive_reader.c - what the converter writes, read by the second reader, which knows
 * formats/FORMAT.md alone. */
/* marks: bits, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_unpacker.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/naive_bytes.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

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
                                         : fabs(got - want) <=
                                               0x1p-13 * fabs(want) + 1e-6 * (fabs(want) + 1);
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
        for (uint32_t log2 = SLOW ? 4 + (uint32_t)i % 3 : 4; log2 <= 6; log2 += SLOW ? 3 : 1) {
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

/* ---- raw and compressed files ---- */

/* What the codes of compressed files have said, over all tests. */
static struct {
    long plain, background, along, how[4], width[5], map, decimal, binary, shells;
} seen;

static void see_code(const naive_leaf *leaf, const naive_stored *stored) {
    const unsigned char *code = leaf->bytes + stored->offset;
    if (!stored->size)
        return;
    if (code[0] == 0) {
        seen.plain++;
        return;
    }
    seen.background += code[2] >> 3 & 1;
    seen.along += code[2] >> 2 & 1;
    seen.how[code[2] & 3]++;
    seen.width[code[3]]++;
    seen.map += leaf->sample_type == 5 && code[1] == 0;
    seen.decimal += code[1] >= 1 && code[1] <= 7;
    seen.binary += code[1] > 7;
}

static void see_codes(const naive_leaf *leaf) {
    for (long i = 0; i < leaf->treelet_count * leaf->sets; i++) {
        see_code(leaf, &leaf->treelets[i].stored);
        see_code(leaf, &leaf->treelets[i].shell);
        seen.shells += leaf->treelets[i].shell.size > 0;
    }
}

static void compare_samples(const naive_leaf *raw, const naive_leaf *coded) {
    assert_int_equal(raw->levels, coded->levels);
    for (int level = 0; level < raw->levels; level++) {
        const long *nodes = raw->level[level].nodes;
        assert_memory_equal(raw->level[level].samples, coded->level[level].samples,
                            (size_t)(nodes[0] * nodes[1] * nodes[2]) * sizeof(float));
    }
    assert_int_equal(raw->treelet_count, coded->treelet_count);
    for (long i = 0; i < raw->treelet_count * raw->sets; i++) {
        const naive_treelet *a = &raw->treelets[i], *b = &coded->treelets[i];
        assert_int_equal(a->stored.size == 0, b->stored.size == 0);
        assert_memory_equal(a->own, b->own, sizeof a->own);
        assert_memory_equal(a->merged, b->merged, sizeof a->merged);
    }
}

static void compare_payload(const naive_leaf *raw, leaf_file *f, leaf_unpacker *u, long p,
                            char *payload) {
    const naive_treelet *t = &raw->treelets[p];
    memset(payload, 0x55, t->payload_size);
    assert_int_equal(leaf_file_load(f, (uint32_t)p, u, payload), ST_OK);
    if (t->stored.size)
        assert_memory_equal(payload, raw->bytes + t->stored.offset, t->payload_size);
}

/* What is loaded from the compressed file is what the raw one holds, codes of trees, too, which
 * naive_leaf_load() has made anew: in their order, and in any. */
static void compare_payloads(const naive_leaf *raw, const char *coded) {
    const long count = raw->treelet_count * raw->sets;
    mem m;
    leaf_file *f = NULL;
    leaf_unpacker *u = NULL;
    field_random r = {(uint64_t)count};
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, coded, &f), ST_OK);
    assert_int_equal(leaf_unpacker_create(&m, f, &u), ST_OK);
    char *payload = mem_alloc(&m, leaf_layout_payload_max(&f->layout));
    assert_non_null(payload);
    for (long i = 0; i < 2 * count; i++)
        compare_payload(raw, f, u, i < count ? i : field_random_below(&r, count), payload);
    mem_free(&m, payload);
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

static void compare_files(const char *raw, const char *coded, long sets) {
    for (long set = 0; set < sets; set++) {
        naive_leaf a, b;
        if (!naive_leaf_load_set(&a, raw, set) || !naive_leaf_load_set(&b, coded, set))
            fail_msg("set %ld: %s", set, a.why[0] ? a.why : b.why);
        assert_int_equal(a.codec, 0);
        assert_int_equal(b.codec, 1);
        compare_samples(&a, &b);
        if (set == 0) {
            compare_payloads(&a, coded);
            see_codes(&b);
        }
        naive_leaf_release(&a);
        naive_leaf_release(&b);
    }
}

/* Samples of all kinds: what a coder could meet. */
typedef enum content {
    WAVES,
    NOISE,
    CONSTANT,
    SPARSE,
    DECIMALS,
    BINARIES,
    HOLES,
    STEEP,
    CONTENTS
} content;

static float real_of(content what, const long p[3], field_random *r) {
    static const uint32_t strange[] = {0x7fc00000, 0x7fc00000, 0x7fc00001, 0xffc12345,
                                       0x7f800001, 0x7f800000, 0xff800000, 0x80000000};
    const double wave = 400 * sin(0.21 * (double)p[0]) + (double)(p[1] * p[2] % 70);
    switch (what) {
    case NOISE: return naive_float_of(field_random_bits(r));
    case CONSTANT: return -2.5F;
    case SPARSE: return p[0] + p[1] + p[2] > 60 && p[0] < 30 ? (float)wave : 0;
    case DECIMALS:
        if (p[0] % 13 == 5 && p[2] > 9)
            return NAN;
        return (float)((double)lround(wave) * (p[2] % 2 ? 0.1 : 0.01));
    case BINARIES: return (float)(lround(wave) + (long)field_random_below(r, 16)) / 16;
    case HOLES:
        return field_random_below(r, 9) ? (float)wave
                                        : naive_float_of(strange[field_random_below(r, 8)]);
    case STEEP: return (float)ldexp(wave, (int)(p[1] % 60) - 30);
    default: return (float)wave + (float)field_random_unit(r);
    }
}

static long whole_of(content what, const long p[3], field_random *r) {
    switch (what) {
    case NOISE: return (long)(field_random_bits(r) & 0xffff);
    case CONSTANT: return 77;
    case SPARSE: return p[0] + p[1] + p[2] > 60 && p[0] < 30 ? p[0] * p[1] : 3;
    case HOLES: return field_random_below(r, 50) ? 0 : 200;
    case DECIMALS: return 100 * p[0] + 30 * p[1] - 7 * p[2];
    case STEEP: return p[0] * p[1] * p[2] * p[2];
    default:
        return (long)(30000 + 9000 * sin(0.21 * (double)p[0]) * cos(0.1 * (double)p[1])) + p[2];
    }
}

static void *make_content(const leaf_case *c, content what, uint64_t seed) {
    const size_t count = (size_t)c->dims[0] * c->dims[1] * c->dims[2], width = sample_size(c->type);
    unsigned char *samples = malloc(count * width);
    assert_non_null(samples);
    field_random r = {seed};
    for (size_t i = 0; i < count; i++) {
        const long p[3] = {(long)(i % c->dims[0]), (long)(i / c->dims[0] % c->dims[1]),
                           (long)(i / c->dims[0] / c->dims[1])};
        const float real = c->type == SAMPLE_F32 ? real_of(what, p, &r) : 0;
        const uint16_t whole = (uint16_t)(c->type == SAMPLE_F32 ? 0 : whole_of(what, p, &r));
        if (c->type == SAMPLE_F32)
            memcpy(samples + i * width, &real, width);
        else
            memcpy(samples + i * width, &whole, width); /* the lower byte */
    }
    return samples;
}

static void check_content(leaf_case c, content what, uint64_t seed) {
    void *samples = make_content(&c, what, seed);
    c.samples = samples;
    for (int codec = 0; codec <= 1; codec++) {
        naive_leaf leaf;
        c.options.file.codec = codec ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
        const char *path = leaf_files_make(&c, codec ? "coded.leaf" : "raw.leaf");
        if (!naive_leaf_load(&leaf, path))
            fail_msg("%ux%ux%u type %d B 2^%u halo %u codec %d content %d: %s", c.dims[0],
                     c.dims[1], c.dims[2], (int)c.type, c.options.file.cells_log2,
                     c.options.file.halo, codec, (int)what, leaf.why);
        check_level0(&leaf, &c);
        naive_leaf_release(&leaf);
    }
    compare_files(scratch_path("raw.leaf"), scratch_path("coded.leaf"), 1);
    free(samples);
}

/* Families of one treelet or two on each axis, of full treelets and of one cell; one level alone.
 */
static void compressed_sizes(void **state) {
    (void)state;
    static const uint32_t dims[][3] = {
        {33, 33, 33}, {34, 33, 18}, {17, 40, 16}, {16, 17, 50}, {2, 2, 2},   {3, 60, 2},
        {49, 2, 19},  {18, 18, 18}, {50, 52, 20}, {65, 30, 66}, {66, 67, 2}, {129, 5, 20},
    };
    for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++)
        for (uint32_t log2 = 4; log2 <= 6; log2++)
            for (uint32_t halo = SLOW ? log2 % 2 : 0; halo <= 1; halo += SLOW ? 2 : 1) {
                static const sample_type types[] = {SAMPLE_U16, SAMPLE_F32, SAMPLE_I8};
                leaf_case c = leaf_files_case(dims[i][0], dims[i][1], dims[i][2], types[log2 - 4]);
                c.options.file.cells_log2 = log2;
                c.options.file.halo = halo;
                check_content(c, i % 2 ? SPARSE : WAVES, i);
            }
}

static void compressed_contents(void **state) {
    (void)state;
    static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
    for (int type = 0; type < 5; type++)
        for (int what = 0; what < CONTENTS; what++) {
            leaf_case c = leaf_files_case(37, 50, 35, types[type]);
            c.options.file.halo = (uint32_t)(type + what) % 2;
            c.options.file.cells_log2 = what % 3 ? 4 : 5;
            check_content(c, (content)what, (uint64_t)what);
        }
}

/* The files above had codes of every kind that the format knows. */
static void all_kinds_of_codes(void **state) {
    (void)state;
    for (int how = 0; how < 4; how++)
        assert_true(seen.how[how] > 0);
    for (int width = 0; width < 5; width++)
        assert_true(seen.width[width] > 0);
    assert_true(seen.plain > 0 && seen.background > 0 && seen.along > 0 && seen.shells > 0);
    assert_true(seen.map > 0 && seen.decimal > 0 && seen.binary > 0);
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
    return leaf_files_series(&s->of, &s->c.options, name);
}

static void check_sets(series *s, const char *path) {
    for (long set = 0; set < SETS; set++) {
        naive_leaf leaf;
        if (!naive_leaf_load_set(&leaf, path, set))
            fail_msg("set %ld: %s", set, leaf.why);
        assert_int_equal(leaf.fields, FIELDS);
        assert_int_equal(leaf.steps, STEPS);
        assert_int_equal(leaf.version, 4);
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
            s.c.options.file.codec = LEAF_CODEC_RAW;
            check_sets(&s, convert_series(&s, "sets.leaf"));
            s.c.options.file.codec = LEAF_CODEC_ZSTD;
            check_sets(&s, convert_series(&s, "coded.leaf"));
            compare_files(scratch_path("sets.leaf"), scratch_path("coded.leaf"), SETS);
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
    c.type = SAMPLE_F32;
    c.options.file.codec = LEAF_CODEC_ZSTD;
    c.samples = samples = make_content(&c, SPARSE, 1);
    check_every_byte(leaf_files_make(&c, "naive.leaf"), 4096 + 400, 61);
    free(samples);
    series s;
    make_series(&s, (const uint32_t[3]){9, 8, 7}, SAMPLE_U8);
    check_every_byte(convert_series(&s, "sets.leaf"), 4096 + 2000, 499);
    release_series(&s);
}
int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_size),          cmocka_unit_test(every_type),
        cmocka_unit_test(missing_data),        cmocka_unit_test(constant_and_extreme_values),
        cmocka_unit_test(rectilinear_axes),    cmocka_unit_test(every_byte_counts),
        cmocka_unit_test(several_sets),        cmocka_unit_test(compressed_sizes),
        cmocka_unit_test(compressed_contents), cmocka_unit_test(all_kinds_of_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
