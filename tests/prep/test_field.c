/* test_field.c - analytic volumes: their values, their bytes for any threads and blocks, and their
 * way to an NRRD.
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
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/hash.h"
#include "formats/grid/volume.h"
#include "prep/generate/field.h"
#include "prep/generate/generate.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static const long double PI = 3.14159265358979323846264338327950288L;

static double now = 0.6; /* time of the fields that make() makes */

/* The whole volume, in blocks of some shape; malloc'ed. rows: of one slice, when slices is 1. */
static void *make(const char *name, const uint32_t dims[3], sample_type type, uint64_t seed,
                  int threads, uint32_t slices, uint32_t rows) {
    mem m;
    mem_init(&m, 0);
    pool *p;
    field *f;
    assert_int_equal(pool_create(&m, threads, &p), ST_OK);
    const field_choice which = {field_find(name), seed, now};
    assert_int_equal(field_create(&m, &which, dims, (size_t)slices * rows * dims[0], &f), ST_OK);
    size_t row_bytes = dims[0] * sample_size(type);
    char *all = malloc((size_t)dims[2] * dims[1] * row_bytes), *to = all;
    for (field_block b = {0}; b.slice < dims[2]; b.slice += slices)
        for (b.row = 0; b.row < dims[1]; b.row += rows) {
            b.slices = slices < dims[2] - b.slice ? slices : dims[2] - b.slice;
            b.rows = rows < dims[1] - b.row ? rows : dims[1] - b.row;
            assert_int_equal(field_fill(f, p, &b, type, to), ST_OK);
            to += (size_t)b.slices * b.rows * row_bytes;
        }
    field_destroy(f);
    pool_destroy(p);
    assert_int_equal(mem_used(&m), 0);
    return all;
}

/* ---- the same bytes ---- */

static void test_any_threads(void **state) {
    (void)state;
    const uint32_t dims[3] = {WATCHED ? 37 : 133, WATCHED ? 9 : 17, WATCHED ? 11 : 19};
    const size_t samples = dims[0] * dims[1] * dims[2];
    const field_info *info;
    for (size_t i = 0; (info = field_at(i)) != NULL; i++)
        for (int t = 0; t < (WATCHED ? 1 : 3); t++) {
            const sample_type type = (sample_type[]){SAMPLE_U8, SAMPLE_U16, SAMPLE_F32}[t];
            size_t size = samples * sample_size(type);
            void *want = make(info->name, dims, type, 7, 1, dims[2], dims[1]);
            for (int threads = WATCHED_THREADS ? 3 : 1; threads <= 5; threads += WATCHED ? 2 : 1) {
                /* whole slices, several or one, or some rows of one */
                void *got = make(info->name, dims, type, 7, threads,
                                 threads % 2 ? 1 : (uint32_t)threads, threads == 3 ? 5 : dims[1]);
                if (memcmp(want, got, size) != 0)
                    fail_msg("%s %s: %d threads give other bytes", info->name, sample_name(type),
                             threads);
                free(got);
            }
            free(want);
        }
}

static void test_pinned(void **state) {
    (void)state;
    skip_under_thread();
    static const struct {
        const char *name;
        uint64_t hash[3]; /* u8, u16, f32 */
    } cases[] = {
        {"marschner-lobb", {0xee51cdd864210771, 0x1d8ac75dbb3808cf, 0x2d705cefaf849791}},
        {"sphere", {0x8504f083746ff716, 0xebbc70c9a509ed39, 0xda58d1ac8ce2b5ac}},
        {"gyroid", {0x7df57153ddcdefbc, 0x472812d99c74e40a, 0x992e4df13ca37b70}},
        {"buckyball", {0x0ade19dd0f95a832, 0x1bc4981b7d171b6f, 0xc4bd98cda10cb335}},
        {"orbital", {0x2e4f8d666c4f7cef, 0xf60e366141385daf, 0x236339fe0c306a47}},
        {"noise", {0xc4d762eda72dc085, 0x44e8fcb144a1de05, 0xb01565d4ae483381}},
        {"attractor", {0xb604823ac0e0af00, 0x656fc468d287a5ad, 0x2e2f901b6763c18c}},
        {"drop", {0xd970b1ae5c4f66ce, 0x388b06884da88aac, 0x1ec55498dbe4b866}},
        {"jets", {0xede7cc04249781b2, 0x5b31e3e9f182d2c8, 0x3136929d31ed646b}},
        {"vortex", {0x2d6cc3547a38482e, 0x4a9f3bafc62e37fe, 0x6247dffb997f454a}},
    };
    const uint32_t dims[3] = {32, 32, 32};
    bool same = true;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int t = 0; t < 3; t++) {
            const sample_type type = (sample_type[]){SAMPLE_U8, SAMPLE_U16, SAMPLE_F32}[t];
            void *all = make(cases[i].name, dims, type, 1, 2, 32, 32);
            uint64_t hash = hash_bytes(all, 32768 * sample_size(type));
            free(all);
            if (hash != cases[i].hash[t]) {
                print_message("%s %s: 0x%016llx\n", cases[i].name, sample_name(type),
                              (unsigned long long)hash);
                same = false;
            }
        }
    assert_true(same);
}

/* A seed makes a difference exactly where a field says so, and so does time. */
static void test_seed(void **state) {
    (void)state;
    skip_under_thread();
    const uint32_t dims[3] = {16, 16, 16};
    const field_info *info;
    int timed = 0;
    for (size_t i = 0; (info = field_at(i)) != NULL; i++) {
        void *one = make(info->name, dims, SAMPLE_F32, 1, 1, 16, 16);
        void *two = make(info->name, dims, SAMPLE_F32, 2, 1, 16, 16);
        now = 0.7;
        void *later = make(info->name, dims, SAMPLE_F32, 1, 1, 16, 16);
        now = 0.6;
        assert_true((memcmp(one, two, 4096 * sizeof(float)) != 0) == info->seeded);
        assert_true((memcmp(one, later, 4096 * sizeof(float)) != 0) == info->timed);
        timed += info->timed;
        free(one);
        free(two);
        free(later);
    }
    assert_int_equal(timed, 3);
}

/* ---- the values ---- */

static long double marschner_lobb(long double x, long double y, long double z) {
    long double r = sqrtl(x * x + y * y);
    return (1 - sinl(PI * z / 2) + 0.25L * (1 + cosl(2 * PI * 6 * cosl(PI * r / 2)))) / 2.5L;
}

static long double sphere(long double x, long double y, long double z) {
    return 1 - sqrtl(x * x + y * y + z * z) / 2;
}

static long double gyroid(long double x, long double y, long double z) {
    long double s = 4 * PI;
    return sinl(s * x) * cosl(s * y) + sinl(s * y) * cosl(s * z) + sinl(s * z) * cosl(s * x);
}

static long double orbital(long double x, long double y, long double z) {
    long double s = 28, r2 = (x * x + y * y + z * z) * s * s, r = sqrtl(r2), u = 3 - sqrtl(3);
    long double most = 32 * u * u * (1 - u / 3) * expl(-u);
    long double amplitude = (3 * z * z * s * s - r2) * (1 - r / 12) * expl(-r / 4) / most;
    return amplitude * amplitude;
}

/* The corners of a truncated icosahedron: all even permutations of (0, 1, 3 phi), (1, 2 + phi, 2
 * phi), (phi, 2, 2 phi + 1). */
static long double buckyball(long double x, long double y, long double z) {
    const long double phi = (1 + sqrtl(5)) / 2, size = 0.75L / sqrtl(9 * phi + 10);
    const long double corner[3][3] = {
        {0, 1, 3 * phi}, {1, 2 + phi, 2 * phi}, {phi, 2, 2 * phi + 1}};
    const long double p[3] = {x / size, y / size, z / size};
    long double sum = 0;
    for (int c = 0; c < 3; c++)
        for (int turn = 0; turn < 3; turn++)
            for (int signs = c == 0 ? 4 : 0; signs < 8; signs++) {
                /* signs of the first coordinate in bit 2: that of 0 is taken once */
                long double d2 = 0;
                for (int a = 0; a < 3; a++) {
                    long double at = corner[c][a] * (signs >> (2 - a) & 1 ? 1 : -1);
                    long double d = p[(a + turn) % 3] - at;
                    d2 += d * d;
                }
                sum += expl(-d2 * size * size / (2 * 0.11L * 0.11L));
            }
    return sum;
}

/* Numbers of a seed, in [0, 1): SplitMix64, as its authors have it. */
static uint64_t state_of_random;

static long double random_number(void) {
    uint64_t z = (state_of_random += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (long double)(z >> 11) / 9007199254740992.0L;
}

/* All of seed 1. */
static long double drop(long double x, long double y, long double z) {
    state_of_random = 1;
    x -= 0.6L * random_number() - 0.3L;
    y -= 0.6L * random_number() - 0.3L;
    long double t = now, since = fmaxl(0, t - sqrtl(0.83L / 4)), fallen = 0.7L - 4 * t * t;
    long double u = (hypotl(x, y) - 1.2L * since) / 0.2L;
    long double ring = fabsl(u) < 1 ? 0.4L * since * (1 - since) * powl(1 - u * u, 2) : 0;
    long double depth = -0.35L + ring - z, dz = z - fallen;
    long double ball = 0.22L - sqrtl(x * x + y * y + dz * dz);
    return fminl(1, fmaxl(0, 0.5L + 4 * fmaxl(depth, ball)));
}

static long double jets(long double x, long double y, long double z) {
    long double sum = 0, up = (z + 1) / 2, sigma = 0.1L * (1 + up);
    state_of_random = 1;
    for (int wave = 0; wave < 32;) {
        long double k[4], k2 = 0;
        for (int c = 0; c < 3; c++) {
            k[c] = 3 * (2 * random_number() - 1);
            k2 += k[c] * k[c];
        }
        k[3] = random_number() + now * (0.3L + 0.45L * (wave % 4));
        if (k2 < 2.25L || k2 > 9)
            continue;
        sum += 0.1L * 0.25L * cosl(2 * PI * (k[0] * x + k[1] * y + k[2] * z + k[3]));
        wave++;
    }
    state_of_random = ~(uint64_t)1;
    for (int jet = 0; jet < 5; jet++) {
        long double angle = 2 * PI * (jet + 0.4L * random_number()) / 5;
        long double rise = up - 2.2L * now, sway = 0.2L * up;
        long double cx = 0.5L * cosl(angle) + sway * cosl(2 * PI * (rise + random_number()));
        long double cy = 0.5L * sinl(angle) + sway * cosl(2 * PI * (rise + random_number()));
        long double d2 = (x - cx) * (x - cx) + (y - cy) * (y - cy);
        sum += expl(-d2 / (2 * sigma * sigma));
    }
    return sum;
}

static long double vortex(long double x, long double y, long double z) {
    long double sum = 0;
    state_of_random = 1;
    for (int n = 0; n < 60; n++) {
        long double radius = 0.1L + 0.7L * random_number();
        long double turns = (n % 3) / 3.0L + radius / 2 + 0.15L * random_number() + now / 4.0L;
        long double dx = x - radius * cosl(2 * PI * turns), dy = y - radius * sinl(2 * PI * turns);
        long double dz = z - (1.6L * random_number() - 0.8L);
        sum += expl(-(dx * dx + dy * dy + dz * dz) / (2 * 0.11L * 0.11L));
    }
    return sum;
}

static void check_values(const char *name,
                         long double (*formula)(long double, long double, long double),
                         const uint32_t dims[3]) {
    float *f32 = make(name, dims, SAMPLE_F32, 1, 1, dims[2], dims[1]);
    uint8_t *u8 = make(name, dims, SAMPLE_U8, 1, 1, dims[2], dims[1]);
    uint16_t *u16 = make(name, dims, SAMPLE_U16, 1, 1, dims[2], dims[1]);
    const field_info *info = field_find(name);
    uint32_t most = 0;
    for (int a = 0; a < 3; a++)
        most = dims[a] > most ? dims[a] : most;
    size_t n = 0;
    for (uint32_t k = 0; k < dims[2]; k++)
        for (uint32_t j = 0; j < dims[1]; j++)
            for (uint32_t i = 0; i < dims[0]; i++, n++) {
                const uint32_t at[3] = {i, j, k};
                long double p[3];
                for (int a = 0; a < 3; a++)
                    p[a] = (2.0L * at[a] - (dims[a] - 1)) / (most - 1);
                long double want = formula(p[0], p[1], p[2]);
                long double part = (want - info->lo) / (info->hi - info->lo);
                part = part < 0 ? 0 : part > 1 ? 1 : part;
                if (!(fabsl(f32[n] - want) <= 1e-7L * fmaxl(1, want)) ||
                    !(fabsl(u8[n] - 255 * part) <= 0.5L + 1e-9L) ||
                    !(fabsl(u16[n] - 65535 * part) <= 0.5L + 1e-9L))
                    fail_msg("%s at %u,%u,%u: %.9g, %u, %u; expected %.12Lg", name, i, j, k, f32[n],
                             u8[n], u16[n], want);
            }
    free(f32);
    free(u8);
    free(u16);
}

static void test_values(void **state) {
    (void)state;
    skip_under_thread();
    static const struct {
        const char *name;
        long double (*formula)(long double, long double, long double);
    } cases[] = {{"marschner-lobb", marschner_lobb},
                 {"sphere", sphere},
                 {"gyroid", gyroid},
                 {"buckyball", buckyball},
                 {"orbital", orbital},
                 {"drop", drop},
                 {"jets", jets},
                 {"vortex", vortex}};
    const uint32_t cube[3] = {21, 21, 21}, slab[3] = {150, 2, 9};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const bool timed = field_find(cases[i].name)->timed;
        for (int step = 0; step <= (timed ? 4 : 0); step++) {
            now = step / 4.0;
            check_values(cases[i].name, cases[i].formula, cube);
            check_values(cases[i].name, cases[i].formula, slab);
        }
    }
    now = 0.6;
}

/* How many samples of a field keep their bits from one time to another. */
static double same_share(const char *name, double from, double to) {
    enum { N = 48 };
    const uint32_t dims[3] = {N, N, N};
    now = from;
    float *one = make(name, dims, SAMPLE_F32, 1, 2, N, N);
    now = to;
    float *two = make(name, dims, SAMPLE_F32, 1, 2, N, N);
    size_t same = 0;
    for (size_t n = 0; n < (size_t)N * N * N; n++)
        same += memcmp(&one[n], &two[n], sizeof *one) == 0;
    free(one);
    free(two);
    now = 0.6;
    return (double)same / (N * N * N);
}

static void test_changes(void **state) {
    (void)state;
    skip_under_thread();
    for (int step = 0; step < 8; step++) {
        assert_true(same_share("drop", step / 8.0, (step + 1) / 8.0) > 0.9);
        assert_true(same_share("drop", step / 8.0, (step + 1) / 8.0) < 1);
        assert_true(same_share("jets", step / 8.0, (step + 1) / 8.0) < 1e-3);
    }
}

/* A quarter of a turn: the last step is the first one, turned. */
static void test_vortex_turns(void **state) {
    (void)state;
    skip_under_thread();
    enum { N = 40 };
    const uint32_t dims[3] = {N, N, N};
    now = 0;
    float *first = make("vortex", dims, SAMPLE_F32, 5, 2, N, N);
    now = 1;
    float *last = make("vortex", dims, SAMPLE_F32, 5, 2, N, N);
    now = 0.6;
    float most = 0;
    for (int k = 0; k < N; k++)
        for (int j = 0; j < N; j++)
            for (int i = 0; i < N; i++) {
                float turned = first[(k * N + N - 1 - i) * N + j];
                assert_true(fabsf(last[(k * N + j) * N + i] - turned) < 1e-6f);
                most = fmaxf(most, turned);
            }
    assert_true(most > 0.75f);
    free(first);
    free(last);
}

static void test_noise(void **state) {
    (void)state;
    skip_under_thread();
    enum { N = 64 };
    const uint32_t dims[3] = {N, N, N};
    for (uint64_t seed = 1; seed <= 3; seed++) {
        float *v = make("noise", dims, SAMPLE_F32, seed, 2, N, N);
        double sum = 0, squares = 0, jump = 0;
        for (size_t n = 0; n < (size_t)N * N * N; n++) {
            sum += v[n];
            squares += (double)v[n] * v[n];
            if (n % N)
                jump = fmax(jump, fabs(v[n] - v[n - 1]));
        }
        double count = (double)N * N * N;
        assert_true(fabs(sum / count) < 0.2);
        assert_true(fabs(sqrt(squares / count) - 1) < 0.2);
        /* Band-limited: no wave is shorter than a third of a unit, and 32 of amplitude 1/4 make at
         * most this slope. */
        assert_true(jump <= 32 * 0.25 * 2 * (double)PI * 3 * 2 / (N - 1));
        free(v);
    }
}

/* The density is that of a surface, symmetric about the z axis, and nearly the same at any
 * resolution. */
static void test_attractor(void **state) {
    (void)state;
    skip_under_thread();
    double mean[2];
    for (int r = 0; r < 2; r++) {
        const uint32_t n = r ? 64 : 48, dims[3] = {n, n, n};
        float *v = make("attractor", dims, SAMPLE_F32, 1, 2, n, n);
        double sum = 0;
        size_t filled = 0;
        for (uint32_t k = 0; k < n; k++)
            for (uint32_t j = 0; j < n; j++)
                for (uint32_t i = 0; i < n; i++) {
                    float here = v[(k * n + j) * n + i];
                    float mirrored = v[(k * n + n - 1 - j) * n + n - 1 - i];
                    assert_true(fabsf(here - mirrored) <= 0.1f * fmaxf(here, mirrored) + 2);
                    sum += here;
                    filled += here > 0;
                }
        mean[r] = sum / (double)filled;
        /* All points are counted: 64 for each node of a face, but for the few outside. */
        assert_true(fabs(sum / (64.0 * n * n) - 1) < 0.01);
        assert_true(filled < (size_t)n * n * n / 10);
        free(v);
    }
    assert_true(mean[0] / mean[1] < 1.5 && mean[1] / mean[0] < 1.5);
}

/* ---- to an NRRD ---- */

static grid make_grid(uint32_t n, sample_type type) {
    grid g;
    const uint32_t dims[3] = {n, n, n};
    grid_init(&g, dims, type);
    g.to_world[0][0] = 0.5;
    return g;
}

static status generate(mem *m, const grid *g, const char *name, int threads, const progress *p) {
    const generate_options options = {
        .info = field_find(name), .seed = 1, .threads = threads, .output = scratch_path("g.nrrd")};
    return generate_volume(m, g, &options, p);
}

static void test_generate(void **state) {
    (void)state;
    grid g = make_grid(48, SAMPLE_U16);
    uint16_t *want = make("gyroid", g.dims, SAMPLE_U16, 1, 1, 48, 48);
    size_t bytes = 48 * 48 * 48 * 2;
    /* 64 KiB: blocks of some rows; 256 KiB: of slices; no limit: all at once. */
    static const size_t limits[] = {1 << 16, 1 << 18, 0};
    for (int i = 0; i < 3; i++) {
        mem m;
        mem_init(&m, limits[i]);
        if (generate(&m, &g, "gyroid", 2, NULL) != ST_OK)
            fail_msg("%s", status_text());
        assert_int_equal(mem_used(&m), 0);
        mem_init(&m, 0);
        volume *v;
        char *got = malloc(bytes);
        assert_int_equal(volume_open(&m, scratch_path("g.nrrd"), NULL, &v), ST_OK);
        assert_true(volume_grid(v)->to_world[0][0] == 0.5);
        assert_int_equal(volume_read(v, 48, got), ST_OK);
        assert_memory_equal(got, want, bytes);
        volume_close(v);
        free(got);
        assert_int_equal(generate(&m, &g, "gyroid", 2, NULL), ST_EXISTS);
        remove(scratch_path("g.nrrd"));
    }
    free(want);
}

/* As many files, each that of its time; none where one of them exists. */
static void test_series(void **state) {
    (void)state;
    static const char *const names[] = {"s_0000.nrrd", "s_0001.nrrd", "s_0002.nrrd"};
    grid g = make_grid(24, SAMPLE_F32);
    const size_t samples = 24 * 24 * 24;
    generate_options o = {.info = field_find("jets"),
                          .seed = 4,
                          .threads = 2,
                          .output = scratch_path("s.nrrd"),
                          .steps = 3};
    mem m;
    mem_init(&m, 1 << 19); /* blocks of slices */
    assert_int_equal(generate_volume(&m, &g, &o, NULL), ST_OK);
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(scratch_count(), 3);
    float *got = malloc(samples * sizeof *got);
    for (int step = 0; step < 3; step++) {
        volume *v;
        now = step / 2.0;
        float *want = make("jets", g.dims, SAMPLE_F32, 4, 1, 24, 24);
        assert_int_equal(volume_open(&m, scratch_path(names[step]), NULL, &v), ST_OK);
        assert_int_equal(volume_read(v, 24, got), ST_OK);
        assert_memory_equal(got, want, samples * sizeof *got);
        volume_close(v);
        free(want);
    }
    free(got);
    now = 0.6;
    remove(scratch_path(names[0]));
    remove(scratch_path(names[1]));
    assert_int_equal(generate_volume(&m, &g, &o, NULL), ST_EXISTS);
    assert_int_equal(scratch_count(), 1);
    remove(scratch_path(names[2]));
}

static bool stop_late(void *ctx) {
    return ++*(int *)ctx > 2;
}

static void test_stopped(void **state) {
    (void)state;
    grid g = make_grid(48, SAMPLE_F32);
    mem m;
    mem_init(&m, 1 << 18);
    int asked = 0;
    const progress p = {.stop = stop_late, .ctx = &asked};
    assert_int_equal(generate(&m, &g, "sphere", 1, &p), ST_STOPPED);
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(scratch_count(), 0);
}

static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE, FAULT_THREAD};
    static const status wanted[] = {ST_NOMEM, ST_NOSPACE, ST_NOMEM};
    static const char *const names[] = {"marschner-lobb", "attractor"};
    for (int i = 0; i < 6; i++) {
        const fault_kind kind = kinds[i / 2];
        long k = 0;
        for (bool fired = true; fired;) {
            grid g = make_grid(8, SAMPLE_U8);
            mem m;
            mem_init(&m, 0);
            fault_arm(kind, k += 1 + (WATCHED ? k / 4 : 0));
            status st = generate(&m, &g, names[i % 2], 3, NULL);
            fired = fault_fired(kind);
            fault_arm(kind, 0);
            assert_int_equal(mem_used(&m), 0);
            if (st == ST_OK) {
                remove(scratch_path("g.nrrd"));
            } else {
                assert_true(fired);
                assert_int_equal(st, wanted[i / 2]);
            }
            assert_int_equal(scratch_count(), 0);
        }
        assert_true(k > 2);
    }
}

/* What a series had before it failed is whole. */
static void test_series_faults(void **state) {
    (void)state;
    skip_under_thread();
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE};
    static const status wanted[] = {ST_NOMEM, ST_NOSPACE};
    for (int i = 0; i < 2; i++) {
        int most = 0;
        for (long k = 1, fired = 1; fired; k++) {
            grid g = make_grid(8, SAMPLE_U8);
            const generate_options o = {.info = field_find("drop"),
                                        .threads = 2,
                                        .output = scratch_path("f_%d.nrrd"),
                                        .steps = 3};
            mem m;
            mem_init(&m, 0);
            fault_arm(kinds[i], k);
            status st = generate_volume(&m, &g, &o, NULL);
            fired = fault_fired(kinds[i]);
            fault_arm(kinds[i], 0);
            assert_int_equal(mem_used(&m), 0);
            assert_true(st == ST_OK || (fired && st == wanted[i]));
            int files = 0;
            static const char *const names[] = {"f_0.nrrd", "f_1.nrrd", "f_2.nrrd"};
            for (; files < 3; files++) {
                uint8_t samples[512];
                volume *v;
                if (access(scratch_path(names[files]), F_OK) != 0)
                    break;
                assert_int_equal(volume_open(&m, scratch_path(names[files]), NULL, &v), ST_OK);
                assert_int_equal(volume_read(v, 8, samples), ST_OK);
                volume_close(v);
                remove(scratch_path(names[files]));
            }
            assert_int_equal(scratch_count(), 0);
            assert_true((st == ST_OK) == (files == 3));
            most = files > most && st != ST_OK ? files : most;
        }
        assert_int_equal(most, 2);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_threads),   cmocka_unit_test(test_pinned),
        cmocka_unit_test(test_seed),          cmocka_unit_test(test_values),
        cmocka_unit_test(test_noise),         cmocka_unit_test(test_attractor),
        cmocka_unit_test(test_generate),      cmocka_unit_test(test_stopped),
        cmocka_unit_test(test_faults),        cmocka_unit_test(test_changes),
        cmocka_unit_test(test_vortex_turns),  cmocka_unit_test(test_series),
        cmocka_unit_test(test_series_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
