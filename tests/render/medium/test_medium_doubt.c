/* test_medium_doubt.c - previews of media: whatever treelets are there, a pixel is within its
 * stated error of the exact picture; the same bits from all kernels; and that is not said of
 * everything.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "render/door/leafcast_volume.h"
#include "render/medium/medium_doubt.h"
#include "render/mesh/mesh_kind.h"
#include "tests/support/fixture.h"
#include "tests/support/hostile_transfer.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"
#include "tests/support/ref_media.h"

typedef long double real;

#if defined __SANITIZE_THREAD__ || defined __SANITIZE_ADDRESS__ /* where all take minutes */
enum { ROUNDS = 1, EVERY = 5, LEAST = 50 };
#else
enum { ROUNDS = 4, EVERY = 1, LEAST = 1000 };
#endif

/* ---- One stretch after the other ---- */

enum { TRANSFERS = 60, WAYS = 40, DOUBTS = 6, PARTS = 5 };

typedef struct bench {
    mem m;
    leafcast_transfer_point points[HOSTILE_POINTS_MAX];
    leafcast_medium medium;
    transfer t;
    medium_rule rule;
    transfer_range values;
    field_random random;
} bench;

static void bench_begin(bench *b, int of_kind, uint64_t seed) {
    static const float samples[2] = {-3.0f, 252.0f};
    *b = (bench){.random = {seed}};
    b->values = transfer_range_of(samples, 2, 100.0, &b->random);
    b->medium.points = b->points;
    b->medium.count = hostile_transfer(of_kind, &b->values, &b->random, b->points);
    mem_init(&b->m, 0);
    assert_int_equal(transfer_init(&b->t, &b->m, &b->medium), ST_OK);
    b->rule = (medium_rule){.transfer = &b->t};
}

/* Behind what was seen, the value jumps about in the range; or there is none. */
static void add_truth(bench *b, const double range[2], bool gaps, double length, real rgb[3],
                      real *through) {
    for (int i = 0; i < PARTS; i++) {
        const real part = (real)length / PARTS;
        real colour[3], k;
        double value = field_random_below(&b->random, 3) > 0
                           ? range[field_random_below(&b->random, 2)]
                           : range[0] + (range[1] - range[0]) * field_random_unit(&b->random);
        value = fmin(value, range[1]);
        if (gaps && field_random_below(&b->random, 2))
            continue;
        ref_transfer(b->points, b->medium.count, value, colour, &k);
        for (int c = 0; c < 3; c++)
            rgb[c] += *through * colour[c] * -expm1l(-k * part);
        *through *= expl(-k * part);
    }
}

static medium_stretch any_guess(bench *b) {
    field_random *r = &b->random;
    medium_stretch s = {.through = field_random_unit(r)};
    for (int c = 0; c < 3; c++)
        s.rgb[c] = field_random_unit(r);
    return field_random_below(r, 3) > 0 ? s : medium_nothing();
}

static void any_range(bench *b, double range[2]) {
    field_random *r = &b->random;
    const double size = b->values.most - b->values.least;
    range[0] = b->values.least + size * field_random_unit(r);
    range[1] = range[0] + (b->values.most - range[0]) * pow(field_random_unit(r), 3.0);
}

/* A ray through several doubts. Returns whether its bound says something. */
static bool check_way(bench *b) {
    medium_stretch all = medium_nothing();
    real rgb[3] = {0}, through = 1;
    for (int i = 0; i < DOUBTS; i++) {
        const double length = b->values.length * pow(10.0, field_random_in(&b->random, -4, 0));
        const bool gaps = field_random_below(&b->random, 2);
        medium_stretch next = any_guess(b);
        double range[2];
        any_range(b, range);
        const medium_doubtful what = {.extent = transfer_extent_of(&b->t, range[0], range[1]),
                                      .gaps = gaps};
        medium_doubt_within(&b->rule, &what, length, &next);
        medium_doubt_join(&all, &next, b->t.most_rgb);
        add_truth(b, range, gaps, length, rgb, &through);
        if (!(fabsl(through - all.through) <= all.through_error + 1e-290L))
            fail_msg("values %a to %a, length %a: through %.17Lg, not %.17g +- %.3g", range[0],
                     range[1], length, through, all.through, all.through_error);
        for (int c = 0; c < 3; c++)
            if (!(fabsl(rgb[c] - all.rgb[c]) <= all.rgb_error + 1e-290L)) /* denormal numbers */
                fail_msg("values %a to %a, length %a: light %.17Lg, not %.17g +- %.3g", range[0],
                         range[1], length, rgb[c], all.rgb[c], all.rgb_error);
        assert_true(all.through_error <= 1.0 + 1e-9);
        assert_true(all.rgb_error <= b->t.most_rgb * (1.0 + 1e-9));
    }
    return all.rgb_error < 0.5 * b->t.most_rgb && all.through < 0.9;
}

static void test_ranges(void **state) {
    (void)state;
    int said = 0;
    for (int i = 0; i < TRANSFERS; i++) {
        bench b;
        bench_begin(&b, i % hostile_transfer_kinds(), (uint64_t)i);
        for (int n = 0; n < WAYS; n++)
            said += check_way(&b);
        transfer_release(&b.t, &b.m);
    }
    assert_true(said > 50);
}

/* ---- Guesses that say how far they are off ---- */

enum { NEAR = 60 };

/* The value along the piece from x on, moved by off, by powers. */
static void shifted(const segment *is, real x, real off, real k[4]) {
    const real l = is->t1, b0 = is->b[0], b1 = is->b[1], b2 = is->b[2], b3 = is->b[3];
    const real c[4] = {b0 + off, 3 * (b1 - b0) / l, 3 * (b2 - 2 * b1 + b0) / (l * l),
                       (b3 - 3 * b2 + 3 * b1 - b0) / (l * l * l)};
    k[0] = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
    k[1] = c[1] + x * (2 * c[2] + x * 3 * c[3]);
    k[2] = c[2] + 3 * c[3] * x;
    k[3] = c[3];
}

/* What may be true: off by all that is said, or less, or there is nothing. */
static size_t make_truth(bench *b, const segment *is, bool gaps, ref_piece of[PARTS]) {
    static const real share[] = {-1, 1, 0};
    const long way = field_random_below(&b->random, 4);
    size_t count = 0;
    for (int i = 0; i < PARTS; i++) {
        const long n = way < 2 ? way : field_random_below(&b->random, 4);
        const real by = n < 3 ? share[n] : (real)field_random_in(&b->random, -1, 1);
        ref_piece *p = &of[count];
        *p = (ref_piece){.t0 = is->t1 * (real)i / PARTS, .t1 = is->t1 * (real)(i + 1) / PARTS};
        shifted(is, p->t0, by * (real)is->spread, p->k);
        if (!gaps || field_random_below(&b->random, 2))
            count++;
    }
    return count;
}

static segment any_piece(bench *b) {
    const double size = b->values.most - b->values.least;
    segment s = {.degree = 3,
                 .t1 = b->values.length * pow(10.0, field_random_in(&b->random, -4, 0)),
                 .spread = size * pow(10.0, field_random_in(&b->random, -6, 0))};
    const double change = size * pow(10.0, field_random_in(&b->random, -5, 0));
    s.b[0] = b->values.least + size * field_random_unit(&b->random);
    for (int i = 1; i < 4; i++)
        s.b[i] = s.b[0] + change * field_random_in(&b->random, -1, 1);
    return s;
}

/* Returns whether what is true is off by a good part of what is said. */
static bool check_near(bench *b) {
    const segment is = any_piece(b);
    const bool gaps = field_random_below(&b->random, 4) == 0;
    medium_doubt d = {.to = is.t1, .bounded = true};
    medium_stretch seen = medium_of_piece(&b->rule, &is);
    ref_piece of[PARTS];
    const size_t count = make_truth(b, &is, gaps, of);
    const ref_medium medium = {of, count, b->points, b->medium.count};
    const ref_media media = {.of = &medium, .count = 1};
    const ref_colour is_true = ref_media_colour(&media);
    double lo = is.b[0], hi = is.b[0];
    for (int i = 1; i < 4; i++) {
        lo = fmin(lo, is.b[i]);
        hi = fmax(hi, is.b[i]);
    }
    d.what.gaps = gaps;
    d.what.range[0] = lo - is.spread;
    d.what.range[1] = hi + is.spread;
    medium_doubt_near(&d, &b->rule, &is, &seen);
    real most = fabsl(is_true.transmittance - seen.through);
    bool good = most > 0.2L * seen.through_error;
    if (!(most <= seen.through_error + 1e-18L))
        fail_msg("spread %g, length %g: through %.17Lg, not %.17g +- %.3g", is.spread, is.t1,
                 is_true.transmittance, seen.through, seen.through_error);
    for (int c = 0; c < 3; c++) {
        most = fabsl(is_true.rgb[c] - seen.rgb[c]);
        if (!(most <= seen.rgb_error + is_true.error + 1e-18L))
            fail_msg("spread %g, length %g: light %.17Lg, not %.17g +- %.3g", is.spread, is.t1,
                     is_true.rgb[c], seen.rgb[c], seen.rgb_error);
        good &= most > 0.05L * seen.rgb_error;
    }
    return good && seen.rgb_error > 1e-9;
}

static void test_near(void **state) {
    (void)state;
    int good = 0;
    for (int i = 0; i < TRANSFERS; i++) {
        bench b;
        bench_begin(&b, i % hostile_transfer_kinds(), (uint64_t)i + 1000);
        b.rule.share = b.rule.per_length = b.rule.drop = 1e-4;
        for (int n = 0; n < NEAR; n++)
            good += check_near(&b);
        transfer_release(&b.t, &b.m);
    }
    print_message("# %d of %d are off by a good part of what is said\n", good, TRANSFERS * NEAR);
    assert_true(good > TRANSFERS * NEAR / 50);
}

/* What changes over a range, by values one by one. */
static void test_change(void **state) {
    (void)state;
    int tried = 0;
    for (int i = 0; i < TRANSFERS; i++) {
        bench b;
        bench_begin(&b, i % hostile_transfer_kinds(), (uint64_t)i + 2000);
        for (int n = 0; n < WAYS; n++) {
            double range[2];
            any_range(&b, range);
            const double apart = (range[1] - range[0]) * field_random_unit(&b.random);
            const transfer_change by = transfer_change_of(&b.t, range[0], range[1], apart);
            for (int k = 0; k < 20; k++) {
                const double from = field_random_in(&b.random, range[0], range[1] - apart);
                const double to = from + apart;
                real rgb[2][3], extinction[2];
                if (from < range[0] || to > range[1] || to - from > apart)
                    continue; /* rounded */
                tried++;
                ref_transfer(b.points, b.medium.count, from, rgb[0], &extinction[0]);
                ref_transfer(b.points, b.medium.count, to, rgb[1], &extinction[1]);
                assert_true(fabsl(extinction[1] - extinction[0]) <= by.k * (1 + 1e-9L) + 1e-300L);
                for (int c = 0; c < 3; c++) {
                    assert_true(fabsl(rgb[1][c] - rgb[0][c]) <= by.rgb * (1 + 1e-9L) + 1e-12L);
                    assert_true(rgb[0][c] <= by.most_rgb * (1 + 1e-9L));
                }
            }
        }
        transfer_release(&b.t, &b.m);
    }
    assert_true(tried > 10 * TRANSFERS * WAYS);
}

/* Black fog of unknown density, and something bright behind it. */
static void test_fog(void **state) {
    (void)state;
    const leafcast_transfer_point points[] = {
        {0.0, {0.0f, 0.0f, 0.0f}, 0.0},
        {1.0, {0.0f, 0.0f, 0.0f}, 1.0},
        {1.0, {0.8f, 0.8f, 0.8f}, 100.0},
        {2.0, {0.8f, 0.8f, 0.8f}, 100.0},
    };
    const leafcast_medium medium = {points, 4};
    medium_stretch all = medium_nothing(), behind = medium_nothing();
    transfer t;
    mem m;
    mem_init(&m, 0);
    assert_int_equal(transfer_init(&t, &m, &medium), ST_OK);
    const medium_rule rule = {.transfer = &t};
    const medium_doubtful fog = {.extent = transfer_extent_of(&t, 0.0, 0.75)};
    const medium_doubtful lamp = {.extent = transfer_extent_of(&t, 1.5, 1.5)};
    medium_doubt_within(&rule, &fog, 1.0, &all);
    assert_true(all.through == 1.0 && all.rgb_error < 1e-12);
    assert_true(fabs(all.through_error - (1.0 - exp(-0.75))) < 1e-12);
    medium_doubt_within(&rule, &lamp, 1.0, &behind);
    assert_true(behind.rgb_error < 1e-12 && behind.through < 1e-12);
    medium_doubt_join(&all, &behind, 1.0);
    assert_true(fabs(all.rgb[0] - 0.8) < 1e-6 &&
                fabs(all.rgb_error - 0.8 * (1.0 - exp(-0.75))) < 1e-6);
    transfer_release(&t, &m);
}

/* Treelets that overlap on a ray, with a piece between. */
static void test_beside(void **state) {
    (void)state;
    float own[3][2] = {{0.0f, 1.0f}, {5.0f, 6.0f}, {2.0f, 3.0f}};
    uint8_t flags[3] = {0, 0, LEAF_FLAG_NON_FINITE};
    const leafcast_transfer_point points[] = {{0.0, {0.5f, 0.5f, 0.5f}, 3.0},
                                              {6.0, {0.5f, 0.5f, 0.5f}, 0.0}};
    const leafcast_medium medium = {points, 2};
    leaf_file f = {.own = own, .flags = flags};
    f.layout.treelets = 3;
    loader l = {.file = &f};
    const tracer tr = {.kind = &mesh_kind, .treelets = &l, .layout = &f.layout};
    double range[2];
    medium_doubt d = {0};
    medium_stretch seen = medium_nothing();
    transfer t;
    mem m;
    mem_init(&m, 0);
    assert_int_equal(transfer_init(&t, &m, &medium), ST_OK);
    const medium_rule rule = {.transfer = &t};
    assert_true(!segment_doubted(&tr, 1, range) && range[0] == 5.0 && range[1] == 6.0);
    assert_true(segment_doubted(&tr, 2, range) && range[0] == 2.0 && range[1] == 3.0);
    for (uint32_t first = 0; first < 2; first++) {
        const segment a = segment_doubt(&tr, first, SEGMENT_BESIDE, 1.0, 4.0);
        const segment b = segment_doubt(&tr, 1 - first, SEGMENT_BESIDE, 2.0, 3.5);
        const medium_doubtful of[2] = {medium_doubtful_of(&t, &tr, first),
                                       medium_doubtful_of(&t, &tr, 1 - first)};
        d = (medium_doubt){0};
        medium_doubt_begin(&d, &a, &of[0]);
        assert_true(medium_doubt_take(&d, &rule, 2.0, &seen) && d.from == 2.0);
        medium_doubt_begin(&d, &b, &of[1]);
        assert_true(d.what.gaps && d.from == 2.0 && d.to == 4.0);
        assert_true(d.what.extent.k[0] == 0.0 && d.what.extent.k[1] == 3.0);
        assert_false(medium_doubt_guess(&d, 3.0, &seen));
        assert_true(medium_doubt_take(&d, &rule, 9.0, &seen) && d.from == 4.0);
        assert_true(seen.through == 1.0 && fabs(seen.through_error - (1.0 - exp(-3.0))) < 1e-12);
        assert_false(medium_doubt_take(&d, &rule, 9.0, &seen));
    }
    transfer_release(&t, &m);
}

/* ---- Pictures ---- */

enum { SIDE = 14, PIXELS = SIDE * SIDE, NODES = 68 };

typedef struct planes {
    double rgba[PIXELS][4], error[PIXELS];
    uint8_t provisional[PIXELS];
    leafcast_stats stats;
} planes;

/* A volume and how it is looked at. */
typedef struct shot {
    const char *path;
    leafcast_scene scene;
    leafcast_camera camera;
    leafcast_transfer_point points[HOSTILE_POINTS_MAX];
    leafcast_medium medium;
    leafcast_surface surface;
    int surfaces;
    planes exact;
    /* What was seen of all previews: */
    size_t pixels, off, told; /* provisional; of them, not as exact; with an error below 0.1 */
} shot;

static void draw(shot *s, leafcast *v, bool preview, planes *out) {
    const leafcast_shown shown = {.volume = v, .surfaces = &s->surface, .count = s->surfaces};
    const leafcast_image image = {.size = sizeof image,
                                  .rgba = out->rgba[0],
                                  .error = out->error,
                                  .provisional = out->provisional};
    out->stats = (leafcast_stats){.size = sizeof out->stats};
    s->scene.volumes = &shown;
    s->scene.volume_count = 1;
    s->scene.media = &s->medium;
    s->scene.media_count = 1;
    s->scene.preview = preview;
    assert_int_equal(leafcast_trace(v, &s->scene, &s->camera, &image, &out->stats, NULL, NULL),
                     LEAFCAST_OK);
}

/* So many treelets, at random or the coarse ones first, and no room for others. */
static void bring_in(leafcast *v, uint32_t count, field_random *r) {
    loader *l = v->treelets;
    const uint32_t treelets = v->file->layout.treelets;
    loader_request *requests = malloc(treelets * sizeof *requests);
    const bool shuffled = field_random_below(r, 4) > 0;
    uint32_t active = 0;
    assert_non_null(requests);
    assert_int_equal(loader_settle(l), ST_OK);
    for (uint32_t t = 0; t < treelets; t++)
        if (l->own[t])
            requests[active++] = (loader_request){t, t};
    for (uint32_t i = 0; i < active && shuffled; i++) {
        const uint32_t other = (uint32_t)field_random_below(r, active);
        const loader_request swap = requests[i];
        requests[i] = requests[other];
        requests[other] = swap;
    }
    loader_clear(l);
    if (active > 0)
        assert_int_equal(loader_admit(l, requests, count < active ? count : active), ST_OK);
    assert_int_equal(loader_settle(l), ST_OK);
    free(requests);
}

/* A preview of some treelets. */
static void draw_some(shot *s, const char *isa, uint32_t limit, uint64_t seed, planes *out) {
    const leafcast_options o = {.size = sizeof o,
                                .threads = 2,
                                .isa = isa,
                                .experiments = EXPERIMENTS(.treelet_limit = limit)};
    leafcast *v = fixture_open(s->path, &o);
    field_random r = {seed};
    draw(s, v, true, out);
    bring_in(v, limit, &r);
    draw(s, v, true, out);
    leafcast_close(v);
}

static double difference(const planes *a, const planes *b, int i) {
    double most = 0.0;
    for (int c = 0; c < 4; c++)
        most = fmax(most, fabs(a->rgba[i][c] - b->rgba[i][c]));
    return most;
}

static void check_stats(const planes *p) {
    double most = 0.0, sum = 0.0;
    uint64_t count = 0;
    for (int i = 0; i < PIXELS; i++) {
        count += p->provisional[i];
        most = fmax(most, p->provisional[i] ? p->error[i] : 0.0);
        sum += p->provisional[i] ? p->error[i] : 0.0;
    }
    assert_true(p->stats.provisional_pixels == count);
    assert_true(p->stats.provisional_error_most == most);
    if (count > 0)
        assert_true(fabs(p->stats.provisional_error_mean - sum / (double)count) < 1e-6);
}

static void check_preview(shot *s, uint64_t seed, const char *what) {
    static planes some, again;
    field_random r = {seed};
    const uint32_t limit =
        1 + (uint32_t)field_random_below(&r, (long)s->exact.stats.treelets_active + 1);
    draw_some(s, NULL, limit, seed, &some);
    check_stats(&some);
    for (int i = 0; i < PIXELS; i++) {
        const double off = difference(&some, &s->exact, i);
        if (!(off <= some.error[i] + s->exact.error[i]))
            fail_msg("%s, seed %llu, pixel %d: %.17g off, but said %.3g and %.3g; provisional %d",
                     what, (unsigned long long)seed, i, off, some.error[i], s->exact.error[i],
                     some.provisional[i]);
        s->pixels += some.provisional[i];
        s->off += some.provisional[i] && off > s->exact.error[i];
        s->told += some.provisional[i] && some.error[i] < 0.1;
    }
    if (seed % 2 > 0)
        return;
    draw_some(s, "scalar", limit, seed, &again);
    assert_memory_equal(again.rgba, some.rgba, sizeof some.rgba);
    assert_memory_equal(again.error, some.error, sizeof some.error);
}

static void choose_scene(shot *s, const leafcast_info *info, int number, field_random *r) {
    s->scene = leafcast_scene_default();
    for (int c = 0; c < 4; c++)
        s->scene.background[c] = (float)field_random_unit(r);
    s->scene.clip_box = field_random_below(r, 3) == 0;
    for (int a = 0; a < 3; a++) {
        const double lo = info->bounds[0][a], size = info->bounds[1][a] - lo;
        s->scene.clip_min[a] = lo + size * field_random_in(r, -0.1, 0.45);
        s->scene.clip_max[a] = lo + size * field_random_in(r, 0.55, 1.1);
    }
    if (info->levels > 1 && number % 4 == 1)
        s->scene.lod = LEAFCAST_LOD_PIXEL;
    if (info->levels > 1 && number % 4 == 3) {
        s->scene.lod = LEAFCAST_LOD_LEVEL;
        s->scene.lod_level = 1;
    }
    s->surface = leafcast_surface_default(0.5 * (info->value_min + info->value_max));
    s->surface.opacity = 0.5f;
    s->surfaces = field_random_below(r, 5) == 0;
}

/* All kinds of transfer functions by turns. */
static void check_volume(shot *s, const float *samples, size_t count, uint64_t seed,
                         const char *name) {
    leafcast *v = fixture_open(s->path, NULL);
    const leafcast_info info = leafcast_describe(v);
    double length = 0.0;
    leafcast_close(v);
    for (int a = 0; a < 3; a++)
        length = hypot(length, info.bounds[1][a] - info.bounds[0][a]);
    for (int round = 0; round < ROUNDS; round++) {
        field_random r = {seed * 1000 + (uint64_t)round};
        const int of_kind = (int)field_random_below(&r, hostile_transfer_kinds());
        const transfer_range range = transfer_range_of(samples, count, length, &r);
        char what[160];
        s->medium = (leafcast_medium){s->points, hostile_transfer(of_kind, &range, &r, s->points)};
        choose_scene(s, &info, (int)seed + round, &r);
        v = fixture_open(s->path, NULL);
        s->camera = pictures_view(v, (int)field_random_below(&r, PICTURE_VIEWS), &r);
        s->camera.width = s->camera.height = SIDE;
        draw(s, v, false, &s->exact);
        leafcast_close(v);
        snprintf(what, sizeof what, "%s, %s, round %d", name, hostile_transfer_name(of_kind),
                 round);
        for (uint64_t i = 0; i < 3; i++)
            check_preview(s, r.state + i, what);
    }
}

/* Returns how many pixels said that they are within 0.1. */
static size_t check_grids(bool deviations) {
    static shot s;
    s = (shot){0};
    for (int i = 0; i < field_count(); i += EVERY) {
        field f;
        assert_true(field_make(&f, field_name(i), NODES, FIELD_SEED));
        leaf_parameters how = leaf_parameters_default();
        how.cells_log2 = 4;
        how.codec = i % 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
        how.zstd_level = 3;
        how.deviations = deviations;
        s.path = fixture_leaf_of(&f, &how);
        check_volume(&s, f.samples, (size_t)(f.dims[0] * f.dims[1] * f.dims[2]), (uint64_t)i + 1,
                     f.name);
        field_release(&f);
    }
    print_message("# %zu provisional pixels, %zu off, %zu said to be within 0.1\n", s.pixels, s.off,
                  s.told);
    assert_true(s.pixels > LEAST && s.off > s.pixels / 10);
    assert_true(EVERY > 1 || s.told > s.pixels / 20);
    return s.told;
}

/* Also of files without deviations; which say more. */
static void test_grids(void **state) {
    (void)state;
    const size_t before = check_grids(false), told = check_grids(true);
    assert_true(EVERY > 1 || told > before + before / 4);
}

static void test_meshes(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "waves",      "noise-turned", "holes",
                                        "apart",  "noise-open", "plateau",      "needle"};
    static shot s;
    for (size_t i = 0; i < sizeof names / sizeof *names; i += EVERY) {
        lab_mesh lab;
        assert_true(lab_mesh_make(&lab, names[i], 5, FIELD_SEED));
        s.path = lab_leaf_make(&lab, 30, false);
        check_volume(&s, lab.values, lab.point_count, i + 100, names[i]);
        lab_mesh_release(&lab);
    }
    print_message("# %zu provisional pixels, %zu off, %zu said to be within 0.1\n", s.pixels, s.off,
                  s.told);
    assert_true(s.pixels > LEAST && s.off > s.pixels / 10);
    assert_true(EVERY > 1 || s.told > s.pixels / 20);
}

/* Where nothing but holes may make a difference: values do not. */
static void test_holes(void **state) {
    (void)state;
    static shot s;
    field f;
    assert_true(field_make(&f, "missing", NODES, FIELD_SEED));
    s.path = fixture_leaf(&f, 4, 1, false);
    leafcast *v = fixture_open(s.path, NULL);
    s.points[0] = (leafcast_transfer_point){0.0, {0.1f, 0.2f, 0.3f}, 0.02};
    s.medium = (leafcast_medium){s.points, 1};
    s.scene = leafcast_scene_default();
    s.camera = leafcast_standard_view(v, 1.2, SIDE, SIDE);
    draw(&s, v, false, &s.exact);
    leafcast_close(v);
    for (uint64_t seed = 0; seed < 6; seed++)
        check_preview(&s, seed, "holes");
    assert_true(s.pixels > PIXELS && s.off > 0);
    field_release(&f);
}

/* ---- Where data are flat ---- */

/* A smooth field of which nothing but the coarse levels is there: most is known for all that. */
static void test_smooth(void **state) {
    (void)state;
    static shot s;
    static planes some;
    field f;
    int seen = 0, told = 0;
    assert_true(field_make(&f, "linear", 130, FIELD_SEED));
    s.path = fixture_leaf(&f, 4, 1, false);
    leafcast *v = fixture_open(s.path, NULL);
    const leafcast_info info = leafcast_describe(v);
    s.points[0] = (leafcast_transfer_point){info.value_min, {0.1f, 0.2f, 0.3f}, 0.002};
    s.points[1] = (leafcast_transfer_point){info.value_max, {0.4f, 0.5f, 0.4f}, 0.006};
    s.medium = (leafcast_medium){s.points, 2};
    s.scene = leafcast_scene_default();
    s.camera = leafcast_standard_view(v, 1.2, SIDE, SIDE);
    draw(&s, v, false, &s.exact);
    leafcast_close(v);
    const leafcast_options o = {
        .size = sizeof o, .threads = 2, .experiments = EXPERIMENTS(.treelet_limit = 9)};
    v = fixture_open(s.path, &o);
    field_random r = {1};
    draw(&s, v, true, &some);
    bring_in(v, 9, &r);
    draw(&s, v, true, &some);
    for (int i = 0; i < PIXELS; i++) {
        seen += some.provisional[i] && s.exact.rgba[i][3] > 0.1;
        told += some.provisional[i] && s.exact.rgba[i][3] > 0.1 && some.error[i] < 0.1;
        assert_true(difference(&some, &s.exact, i) <= some.error[i] + s.exact.error[i]);
    }
    print_message("# %d of %d said to be within 0.1\n", told, seen);
    assert_true(seen > PIXELS / 4 && told > seen / 2);
    leafcast_close(v);
    field_release(&f);
}

int main(int argc, char **argv) {
    if (argc == 2)
        cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_near),   cmocka_unit_test(test_change),
                                       cmocka_unit_test(test_ranges), cmocka_unit_test(test_fog),
                                       cmocka_unit_test(test_beside), cmocka_unit_test(test_holes),
                                       cmocka_unit_test(test_smooth), cmocka_unit_test(test_grids),
                                       cmocka_unit_test(test_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
