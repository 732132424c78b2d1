/* test_live_samples.c - samples that change in two buffers: regions of all types and strides, by
 * every ISA and some threads; boxes, extents and stamps against plain loops over one array.
 */
/* marks: threads bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/live_samples.h"
#include "tests/support/fields.h"
#include "tests/support/watched.h"

enum { WRITINGS = SLOW ? 6 : 24, BYTES = 8 };

typedef struct subject {
    mem m;
    field_random r;
    sample_type type, stored;
    uint32_t dims[3];
    live_samples *s;
    float *model;      /* what the newest step has, */
    uint64_t *changed; /* and with which writing each sample changed last */
    float *shown[LIVE_BUFFERS];
} subject;

static size_t count_of(const subject *t) {
    return (size_t)t->dims[0] * t->dims[1] * t->dims[2];
}

static size_t at(const subject *t, uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * t->dims[1] + y) * t->dims[0] + x;
}

/* A random sample as it is given, and what is kept of it. */
static float draw(subject *t, bool quiet, char sample[BYTES]) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, -0.0f, 1e30f, -1e-30f};
    const long v = quiet ? 7 : field_random_below(&t->r, 200) - (t->type == SAMPLE_U8 ? 0 : 90);
    float f = (float)v * 0.5f;
    double d = (double)f;
    uint32_t u = (uint32_t)(v + 100);
    int32_t i = (int32_t)v;
    if (!quiet && field_random_below(&t->r, 40) == 0)
        f = odd[field_random_below(&t->r, 6)];
    memset(sample, 0, BYTES);
    switch (t->type) {
    case SAMPLE_U8: memcpy(sample, &u, 1); return (float)(u & 0xFF);
    case SAMPLE_I8: memcpy(sample, &i, 1); return (float)(int8_t)i;
    case SAMPLE_U16: memcpy(sample, &u, 2); return (float)(u & 0xFFFF);
    case SAMPLE_I16: memcpy(sample, &i, 2); return (float)(int16_t)i;
    case SAMPLE_F32: memcpy(sample, &f, 4); return f;
    case SAMPLE_U32: memcpy(sample, &u, 4); return (float)u;
    case SAMPLE_I32: memcpy(sample, &i, 4); return (float)i;
    default: memcpy(sample, &d, 8); return (float)d;
    }
}

/* One region with gaps, or none, in any direction, in memory that is exactly as large. */
static void put(subject *t, int buffer, uint64_t writing) {
    live_region g = {.type = t->type};
    const size_t width = sample_size(t->type);
    const bool whole = field_random_below(&t->r, 6) == 0, quiet = field_random_below(&t->r, 4) == 0;
    ptrdiff_t step = (ptrdiff_t)width + (field_random_below(&t->r, 3) == 0 ? 3 : 0), low = 0,
              high = 0;
    for (int a = 0; a < 3; a++) {
        g.first[a] = whole ? 0 : (uint32_t)field_random_below(&t->r, (long)t->dims[a]);
        const uint32_t left = t->dims[a] - g.first[a];
        g.size[a] = whole ? left : 1 + (uint32_t)field_random_below(&t->r, (long)left);
        g.strides[a] = field_random_below(&t->r, 3) == 0 ? -step : step;
        const ptrdiff_t end = g.strides[a] * (ptrdiff_t)(g.size[a] - 1);
        low += end < 0 ? end : 0;
        high += end > 0 ? end : 0;
        step *= (ptrdiff_t)g.size[a] + (field_random_below(&t->r, 4) == 0);
    }
    char *block = malloc((size_t)(high - low) + width), *first = block - low;
    assert_non_null(block);
    for (uint32_t z = 0; z < g.size[2]; z++)
        for (uint32_t y = 0; y < g.size[1]; y++)
            for (uint32_t x = 0; x < g.size[0]; x++) {
                char sample[BYTES];
                const size_t i = at(t, g.first[0] + x, g.first[1] + y, g.first[2] + z);
                const float kept = draw(t, quiet, sample);
                memcpy(first + (ptrdiff_t)x * g.strides[0] + (ptrdiff_t)y * g.strides[1] +
                           (ptrdiff_t)z * g.strides[2],
                       sample, width);
                if (memcmp(&kept, &t->model[i], sizeof kept) != 0)
                    t->changed[i] = writing;
                t->model[i] = kept;
            }
    g.samples = first;
    assert_int_equal(live_samples_put(t->s, buffer, &g), ST_OK);
    free(block);
}

/* ---- What is there ---- */

static uint32_t clamp(int64_t i, uint32_t nodes) {
    return i < 0 ? 0 : i >= nodes ? nodes - 1 : (uint32_t)i;
}

static void check_box(const subject *t, int buffer, const int64_t first[3],
                      const uint32_t size[3]) {
    const size_t width = sample_size(t->stored);
    const size_t count = (size_t)size[0] * size[1] * size[2];
    char *is = malloc(count * width);
    live_samples_load(t->s, buffer, first, size, is);
    size_t i = 0;
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++, i++) {
                const float want = t->shown[buffer][at(t, clamp(first[0] + x, t->dims[0]),
                                                       clamp(first[1] + y, t->dims[1]),
                                                       clamp(first[2] + z, t->dims[2]))];
                const float got = sample_get(t->stored, is, i);
                assert_memory_equal(&got, &want, sizeof want);
            }
    free(is);
}

/* The extent of a treelet, and when what it has with its halo changed last, by whole blocks. */
static void check_treelet(const subject *t, const uint32_t place[3], uint64_t *changed) {
    live_range want = {INFINITY, -INFINITY, false};
    int64_t low[3], high[3];
    *changed = 0;
    for (int a = 0; a < 3; a++) {
        low[a] = (int64_t)place[a] * LIVE_BLOCK;
        high[a] = low[a] + LIVE_BLOCK;
    }
    for (int64_t z = low[2] - LIVE_BLOCK; z < high[2] + LIVE_BLOCK && z < t->dims[2]; z++)
        for (int64_t y = low[1] - LIVE_BLOCK; y < high[1] + LIVE_BLOCK && y < t->dims[1]; y++)
            for (int64_t x = low[0] - LIVE_BLOCK; x < high[0] + LIVE_BLOCK && x < t->dims[0]; x++) {
                if (x < 0 || y < 0 || z < 0)
                    continue;
                const size_t i = at(t, (uint32_t)x, (uint32_t)y, (uint32_t)z);
                *changed = t->changed[i] > *changed ? t->changed[i] : *changed;
                if (x < low[0] || y < low[1] || z < low[2] || x > high[0] || y > high[1] ||
                    z > high[2])
                    continue;
                const float v = t->model[i];
                want.bad |= !isfinite(v);
                want.lo = isfinite(v) && v < want.lo ? v : want.lo;
                want.hi = isfinite(v) && v > want.hi ? v : want.hi;
            }
    const live_range is = live_samples_range(t->s, place);
    assert_true(is.lo == want.lo && is.hi == want.hi && is.bad == want.bad);
}

static void check(subject *t, int buffer) {
    for (int i = 0; i < 4; i++) {
        int64_t first[3];
        uint32_t size[3];
        for (int a = 0; a < 3; a++) {
            first[a] = field_random_below(&t->r, (long)t->dims[a] + 1) - 1;
            size[a] = 1 + (uint32_t)field_random_below(&t->r, (long)t->dims[a] - first[a] + 1);
            size[a] += first[a] < 0 && size[a] == 1; /* it has a node, at least */
        }
        check_box(t, i & 1 ? buffer : !buffer, first, size);
    }
    for (uint32_t z = 0; z * LIVE_BLOCK + 1 < t->dims[2]; z++)
        for (uint32_t y = 0; y * LIVE_BLOCK + 1 < t->dims[1]; y++)
            for (uint32_t x = 0; x * LIVE_BLOCK + 1 < t->dims[0]; x++) {
                const uint32_t place[3] = {x, y, z};
                uint64_t changed;
                check_treelet(t, place, &changed);
                /* Samples that changed within a writing, and back, count as changed. */
                assert_true(live_samples_stamp(t->s, place) >= changed + 1);
            }
}

static void run(sample_type type, const uint32_t dims[3], cpu_isa isa, int threads, uint64_t seed) {
    subject t = {.type = type, .stored = sample_stored(type), .r = {seed}};
    memcpy(t.dims, dims, sizeof t.dims);
    mem_init(&t.m, 0);
    t.model = calloc(count_of(&t), sizeof *t.model);
    t.changed = calloc(count_of(&t), sizeof *t.changed);
    for (int b = 0; b < LIVE_BUFFERS; b++)
        t.shown[b] = calloc(count_of(&t), sizeof *t.model);
    assert_int_equal(live_samples_create(&t.m, dims, t.stored, isa, threads, &t.s), ST_OK);
    int buffer = 0;
    for (uint64_t writing = 1; writing <= WRITINGS; writing++, buffer = !buffer) {
        for (long n = field_random_below(&t.r, 4); n > 0; n--)
            put(&t, buffer, writing);
        assert_int_equal(live_samples_finish(t.s, buffer), ST_OK);
        memcpy(t.shown[buffer], t.model, count_of(&t) * sizeof *t.model);
        check(&t, buffer);
    }
    live_samples_destroy(t.s);
    for (int b = 0; b < LIVE_BUFFERS; b++)
        free(t.shown[b]);
    free(t.changed);
    free(t.model);
    assert_int_equal(mem_used(&t.m), 0);
}

static void test_random(void **state) {
    static const uint32_t dims[][3] = {{67, 45, 34}, {33, 65, 2}, {2, 3, 97}, {64, 32, 33}};
    (void)state;
    uint64_t seed = 1;
    for (int isa = 0; isa <= (int)cpu_best(); isa++)
        for (int type = SAMPLE_U8; type <= SAMPLE_F64; type++)
            for (size_t d = 0; d < sizeof dims / sizeof *dims; d++, seed++)
                if (!SLOW || seed % 3 == 0)
                    run((sample_type)type, dims[d], (cpu_isa)isa, 1 + (int)(seed % 3), seed);
}

/* More samples in a row than are taken at once. */
static void test_long_rows(void **state) {
    (void)state;
    run(SAMPLE_F32, (uint32_t[3]){2 * LIVE_ROW_MAX + 33, 3, 2}, cpu_best(), 2, 5);
    run(SAMPLE_U8, (uint32_t[3]){LIVE_ROW_MAX + 1, 2, 34}, CPU_SCALAR, 1, 6);
}

/* Stamps stay where nothing has changed, in the block and around it, although it was given. */
static void test_stamps(void **state) {
    (void)state;
    enum { SIDE = 129 };
    static char samples[SIDE * SIDE * SIDE];
    const uint32_t dims[3] = {SIDE, SIDE, SIDE}, far_place[3] = {3, 3, 3}, near[3] = {0, 0, 0};
    live_region g = {.size = {SIDE, SIDE, SIDE},
                     .type = SAMPLE_U8,
                     .samples = samples,
                     .strides = {1, SIDE, SIDE * SIDE}};
    mem m;
    live_samples *s;
    mem_init(&m, 0);
    assert_int_equal(live_samples_create(&m, dims, SAMPLE_U8, cpu_best(), 2, &s), ST_OK);
    uint64_t before[2] = {live_samples_stamp(s, near), live_samples_stamp(s, far_place)};
    for (int i = 0; i < 4; i++) {
        samples[5]++;
        assert_int_equal(live_samples_put(s, i & 1, &g), ST_OK);
        assert_int_equal(live_samples_finish(s, i & 1), ST_OK);
        assert_true(live_samples_stamp(s, near) > before[0]);
        assert_true(live_samples_stamp(s, far_place) == before[1]);
        before[0] = live_samples_stamp(s, near);
    }
    /* Given twice within one writing: changed by the first, the same by the second. */
    samples[5]++;
    assert_int_equal(live_samples_put(s, 0, &g), ST_OK);
    assert_int_equal(live_samples_put(s, 0, &g), ST_OK);
    assert_int_equal(live_samples_finish(s, 0), ST_OK);
    assert_true(live_samples_stamp(s, near) > before[0]);
    /* And back to what the other buffer has. */
    samples[5]++;
    assert_int_equal(live_samples_put(s, 1, &g), ST_OK);
    samples[5]--;
    assert_int_equal(live_samples_put(s, 1, &g), ST_OK);
    assert_int_equal(live_samples_finish(s, 1), ST_OK);
    char is;
    live_samples_load(s, 1, (int64_t[3]){5, 0, 0}, (uint32_t[3]){1, 1, 1}, &is);
    assert_int_equal(is, samples[5]);
    assert_true(live_samples_range(s, near).hi == (float)samples[5]);
    live_samples_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random),
                                       cmocka_unit_test(test_long_rows),
                                       cmocka_unit_test(test_stamps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
