/* test_histogram.c - histograms against counting by hand, and suggestions where they are known.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/histogram.h"
#include "formats/leaf/histogram_draw.h"
#include "formats/leaf/histogram_text.h"

enum { NX = 24, NY = 20, NZ = 17, NODES = NX * NY * NZ };

static const uint32_t dims[3] = {NX, NY, NZ};
static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/* All of a box of nodes, in boxes of `side` nodes; each with the samples of one node more. */
static void take(const uint32_t n[3], sample_type type, const void *samples, uint32_t side,
                 const double to_world[12], histogram_cell *cells) {
    const histogram_draw d = histogram_draw_grid(n);
    const histogram_space s = histogram_space_of(to_world);
    const size_t row = n[0], slice = (size_t)n[0] * n[1];
    for (uint32_t z = 0; z < n[2]; z += side)
        for (uint32_t y = 0; y < n[1]; y += side)
            for (uint32_t x = 0; x < n[0]; x += side) {
                histogram_block b = {.first = {x, y, z},
                                     .end = {x + side < n[0] ? x + side : n[0],
                                             y + side < n[1] ? y + side : n[1],
                                             z + side < n[2] ? z + side : n[2]},
                                     .type = type,
                                     .samples = (const char *)samples +
                                                (x + y * row + z * slice) * sample_size(type),
                                     .row = row,
                                     .slice = slice};
                histogram_draw_take(&d, &s, &b, cells);
            }
}

static double at(sample_type type, const void *samples, int x, int y, int z) {
    return (double)sample_get(type, samples, (size_t)x + (size_t)NX * (y + (size_t)NY * z));
}

/* Active cells at v by the definition, straight from the samples. */
static uint32_t active_cells(sample_type type, const void *samples, double v) {
    uint32_t count = 0;
    for (int z = 0; z + 1 < NZ; z++)
        for (int y = 0; y + 1 < NY; y++)
            for (int x = 0; x + 1 < NX; x++) {
                double lo = (double)INFINITY, hi = -(double)INFINITY;
                bool finite = true;
                for (int i = 0; i < 8; i++) {
                    double s = at(type, samples, x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
                    finite &= isfinite(s) != 0;
                    lo = s < lo ? s : lo;
                    hi = s > hi ? s : hi;
                }
                count += finite && lo < v && v <= hi;
            }
    return count;
}

static void range_of(sample_type type, const void *samples, double range[2]) {
    range[0] = (double)INFINITY;
    range[1] = -(double)INFINITY;
    for (size_t i = 0; i < NODES; i++) {
        const double v = (double)sample_get(type, samples, i);
        if (isfinite(v)) {
            range[0] = v < range[0] ? v : range[0];
            range[1] = v > range[1] ? v : range[1];
        }
    }
}

static histogram_cell cells[NODES];

static void check_counts(const char *what, sample_type type, const void *samples, histogram *h) {
    double range[2];
    memset(cells, 0xA5, sizeof cells);
    take(dims, type, samples, 7, identity, cells);
    range_of(type, samples, range);
    histogram_build(h, cells, NODES, type, range, NODES);
    assert_null(histogram_fault(h));
    assert_true(h->edges[0] <= range[0] && h->edges[h->bins] > range[1]);
    uint64_t finite = 0;
    for (size_t i = 0; i < NODES; i++)
        finite += isfinite(sample_get(type, samples, i)) != 0;
    assert_int_equal(h->drawn, finite);
    for (uint32_t k = 0; k < h->bins; k++) {
        uint32_t inside = 0;
        for (size_t i = 0; i < NODES; i++) {
            const double v = (double)sample_get(type, samples, i);
            inside += v >= h->edges[k] && v < h->edges[k + 1];
        }
        if (inside != h->samples[k] || h->active[k] != active_cells(type, samples, h->edges[k]))
            fail_msg("%s: bin %u from %.17g: %u samples, expected %u; %u cells, expected %u", what,
                     k, h->edges[k], h->samples[k], inside, h->active[k],
                     active_cells(type, samples, h->edges[k]));
    }
}

static double wave(int i) {
    const int x = i % NX, y = i / NX % NY, z = i / (NX * NY);
    return sin(0.4 * x) * cos(0.3 * y) + 0.5 * sin(0.7 * z);
}

static void test_bytes(void **state) {
    (void)state;
    static uint8_t u8[NODES];
    histogram h;
    for (int i = 0; i < NODES; i++)
        u8[i] = (uint8_t)lround(130 + 80 * wave(i));
    check_counts("u8", SAMPLE_U8, u8, &h);
    double range[2];
    range_of(SAMPLE_U8, u8, range);
    assert_int_equal(h.bins, (int)(range[1] - range[0]) + 1);
    assert_true(h.edges[0] == range[0] - 0.5);
}

static void test_wide_integers(void **state) {
    (void)state;
    static int16_t i16[NODES];
    histogram h;
    for (int i = 0; i < NODES; i++)
        i16[i] = (int16_t)lround(-3000 + 9000 * wave(i));
    check_counts("i16", SAMPLE_I16, i16, &h);
    assert_true(h.bins > 200);
    for (uint32_t k = 0; k <= h.bins; k++)
        assert_true(h.edges[k] - floor(h.edges[k]) == 0.5);
}

static float f32[NODES];

static void test_floats(void **state) {
    (void)state;
    histogram h;
    for (int i = 0; i < NODES; i++)
        f32[i] = (float)(1e-30 * wave(i));
    check_counts("f32", SAMPLE_F32, f32, &h);
    assert_int_equal(h.bins, HISTOGRAM_BINS);
    for (int i = 0; i < NODES; i++)
        f32[i] = 1000 + (float)wave(i) * 1e-3F;
    check_counts("f32, near 1000", SAMPLE_F32, f32, &h);
    for (int i = 0; i < NODES; i += 97)
        f32[i] = i % 2 ? NAN : -INFINITY;
    check_counts("f32 with NaN and inf", SAMPLE_F32, f32, &h);
    assert_true(h.cells < (NX - 1) * (NY - 1) * (NZ - 1));
}

/* One sample at 1e30 leaves the others their bins. */
static void test_outlier(void **state) {
    (void)state;
    histogram h;
    uint32_t used = 0;
    for (int i = 0; i < NODES; i++)
        f32[i] = (float)wave(i);
    f32[NODES / 2 + 5] = 1e30F;
    check_counts("an outlier", SAMPLE_F32, f32, &h);
    for (uint32_t k = 0; k < h.bins; k++)
        used += h.samples[k] > 0;
    assert_true(used > HISTOGRAM_BINS / 2);
    double isovalue;
    assert_int_equal(histogram_suggest(&h, &isovalue, 1), 1);
    assert_true(fabs(isovalue) < 2);
}

static void test_none(void **state) {
    (void)state;
    histogram h;
    double isovalues[HISTOGRAM_ISOVALUES];
    for (int i = 0; i < NODES; i++)
        f32[i] = NAN;
    check_counts("NaN alone", SAMPLE_F32, f32, &h);
    assert_int_equal(h.bins, 0);
    assert_int_equal(histogram_suggest(&h, isovalues, HISTOGRAM_ISOVALUES), 0);
    for (int i = 0; i < NODES; i++)
        f32[i] = -0.0F;
    check_counts("all the same", SAMPLE_F32, f32, &h);
    assert_int_equal(h.bins, 1);
    assert_int_equal(histogram_suggest(&h, isovalues, HISTOGRAM_ISOVALUES), 0);
}

static bool find_marker(histogram_marker *m) {
    double range[2];
    range_of(SAMPLE_F32, f32, range);
    take(dims, SAMPLE_F32, f32, 100, identity, cells);
    return histogram_find_marker(cells, NODES, range, m);
}

/* Every so many samples are `value`, the others 5 to 9, some of them no numbers. */
static void fill_marked(int every, float value) {
    for (int i = 0; i < NODES; i++)
        f32[i] = i % every == every / 2 ? value : i % 11 == 0 ? NAN : 5 + (float)(i % 9) / 2;
}

static void test_marker(void **state) {
    (void)state;
    histogram_marker m;
    static const float values[] = {-9999, 1e30F, -91, 91};
    for (int k = 0; k < 4; k++) {
        fill_marked(100, values[k]);
        assert_true(find_marker(&m));
        assert_true(m.value == (double)values[k] && m.others[0] == 5 && m.others[1] == 9);
        assert_true(fabs(m.share - 0.011) < 0.0005); /* of what is a number */
    }
    fill_marked(100, 89); /* too near */
    assert_false(find_marker(&m));
    fill_marked(100, 0); /* nearer to 0 than the others */
    assert_false(find_marker(&m));
    fill_marked(3000, -9999); /* too few */
    assert_false(find_marker(&m));
    for (int i = 0; i < NODES; i++)
        f32[i] = i % 2 ? 255 : 0; /* a mask */
    assert_false(find_marker(&m));
}

/* Distances from a point, 0 to 18, but for the nodes near it, which have the marker. */
static void fill_hole(float marker) {
    for (int i = 0; i < NODES; i++) {
        const double x = i % NX - NX / 2, y = i / NX % NY - NY / 2, z = i / (NX * NY) - NZ / 2;
        const double r = sqrt(x * x + y * y + z * z);
        f32[i] = r < 4 ? marker : (float)(r < 10 ? r : r + 10);
    }
}

static uint32_t bins_used(const histogram *h, const uint32_t bins[2]) {
    uint32_t used = 0;
    for (uint32_t k = bins[0]; k < bins[1]; k++)
        used += h->samples[k] > 0;
    return used;
}

static void check_aside(const char *what, sample_type type, const void *samples, double value) {
    histogram h;
    histogram_marker m = {0};
    uint32_t data[2];
    double isovalues[HISTOGRAM_ISOVALUES];
    check_counts(what, type, samples, &h);
    assert_true(histogram_data(&h, data, &m));
    assert_true(m.value == value && m.share > 0.01 && m.share < 0.1);
    assert_true(data[1] - data[0] + 2 == h.bins && data[0] == (value < 0 ? 2 : 0));
    assert_true(m.others[0] > 3 && m.others[0] <= 4 && m.others[1] < 40);
    assert_true(bins_used(&h, data) > 10);
    const int count = histogram_suggest(&h, isovalues, HISTOGRAM_ISOVALUES);
    assert_true(count == 3 && isovalues[0] >= 9.5 && isovalues[0] <= 20);
    assert_true(isovalues[1] > isovalues[0] && isovalues[2] < isovalues[0] && isovalues[2] > 4);
}

/* What may be missing leaves the others their bins, and is not what is suggested. */
static void test_aside(void **state) {
    (void)state;
    static const float values[] = {-9999, -1e34F, 1e30F};
    static int16_t whole[NODES];
    histogram h;
    histogram_marker m;
    uint32_t data[2];
    for (int k = 0; k < 3; k++) {
        fill_hole(values[k]);
        check_aside("a marker", SAMPLE_F32, f32, (double)values[k]);
    }
    for (int side = -1; side < 2; side += 2) {
        fill_hole((float)(side * 9999));
        for (int i = 0; i < NODES; i++)
            whole[i] = (int16_t)f32[i];
        check_aside("a marker, i16", SAMPLE_I16, whole, side * 9999);
    }
    fill_hole(-20); /* not far enough to be one */
    check_counts("none", SAMPLE_F32, f32, &h);
    assert_false(histogram_data(&h, data, &m));
    assert_true(data[0] == 0 && data[1] == h.bins);
    check_counts("three values", SAMPLE_U8, (uint8_t[NODES]){0, 1, 2}, &h); /* integers' bins */
    assert_false(histogram_data(&h, data, &m));
}

/* Beside a marker, too, one value far away does not take the others' bins. A gap that is no wider
 * than the data makes none. */
static void test_aside_of_what(void **state) {
    (void)state;
    static uint8_t bytes[NODES];
    histogram h;
    histogram_marker m;
    uint32_t data[2];
    fill_hole(-1e34F);
    f32[NODES - 1] = 1e6F;
    check_counts("a tail", SAMPLE_F32, f32, &h);
    assert_true(histogram_data(&h, data, &m));
    assert_true(bins_used(&h, data) > 10);
    for (int i = 0; i < NODES; i++)
        bytes[i] = (uint8_t)(i % 4 ? 2 + i % 5 : 0);
    check_counts("a gap", SAMPLE_U8, bytes, &h);
    assert_int_equal(h.samples[1], 0);
    assert_false(histogram_data(&h, data, &m));
}

/* Where there is most on both sides, not where one lies far off. */
static void test_parting(void **state) {
    (void)state;
    static const uint32_t few[10] = {100, 100, 100, 100, 100, 0, 0, 0, 0, 1}, none[10] = {7};
    double edges[11];
    for (int i = 0; i < 11; i++)
        edges[i] = 1e6 + i;
    const uint32_t at = histogram_parting(edges, few, 0, 10);
    assert_in_range(at, 2, 3);
    assert_int_equal(histogram_parting(edges, none, 0, 10), 0);
    assert_int_equal(histogram_parting(edges, few, 4, 10), 5);
}

/* f = distance from a point, on nodes that are stretched and turned: every surface is a sphere, the
 * gradient is 1 everywhere. */
static void test_measures(void **state) {
    (void)state;
    const double c = 0.8, s = 0.6;
    const double to_world[12] = {2 * c, -1.5 * s, 0, 5, 2 * s, 1.5 * c, 0, -7, 0, 0, -2.5, 1};
    histogram h;
    double range[2];
    for (int i = 0; i < NODES; i++) {
        const double x = 2.0 * (i % NX - 11.5), y = 1.5 * (i / NX % NY - 9.5);
        const double z = 2.5 * (i / (NX * NY) - 8.0);
        f32[i] = (float)sqrt(x * x + y * y + z * z);
    }
    take(dims, SAMPLE_F32, f32, 100, to_world, cells);
    range_of(SAMPLE_F32, f32, range);
    histogram_build(&h, cells, NODES, SAMPLE_F32, range, NODES);
    for (uint32_t k = 0; k < h.bins; k++)
        if (h.edges[k] > 8 && h.edges[k] < 12) {
            const double sphere = 4 * 3.14159265358979 * h.edges[k] * h.edges[k];
            if (fabs((double)h.gradient[k] - 1) > 0.02 ||
                fabs((double)h.area[k] / sphere - 1) > 0.08)
                fail_msg("radius %g: gradient %g, area %g of %g", h.edges[k], (double)h.gradient[k],
                         (double)h.area[k], sphere);
        }
}

/* A volume of which a part is drawn: one node a block, whatever boxes they come in, and shares that
 * are near the truth. */
static void test_drawn(void **state) {
    (void)state;
    const uint32_t n[3] = {150, 101, 70};
    const size_t nodes = (size_t)n[0] * n[1] * n[2];
    const histogram_draw d = histogram_draw_grid(n);
    assert_true(d.step == 3 && d.count == 50 * 34 * 24);
    uint8_t *samples = malloc(nodes);
    histogram_cell *one = malloc(d.count * sizeof *one), *other = malloc(d.count * sizeof *other);
    assert_true(samples && one && other);
    for (size_t i = 0; i < nodes; i++)
        samples[i] = (uint8_t)(i * 2654435761u >> 24);
    memset(one, 1, d.count * sizeof *one);
    memset(other, 2, d.count * sizeof *other);
    take(n, SAMPLE_U8, samples, 200, identity, one);
    take(n, SAMPLE_U8, samples, 13, identity, other);
    assert_memory_equal(one, other, d.count * sizeof *one);
    histogram h;
    histogram_build(&h, one, d.count, SAMPLE_U8, (const double[2]){0, 255}, nodes);
    assert_int_equal(h.drawn, d.count);
    assert_int_equal(h.total, nodes);
    uint32_t below = 0;
    for (uint32_t k = 0; k < 64; k++)
        below += h.samples[k];
    assert_true(fabs((double)below / d.count - 0.25) < 0.02);
    free(samples);
    free(one);
    free(other);
}

static void test_draw_places(void **state) {
    (void)state;
    const uint32_t n[3] = {1000, 3, 777};
    const histogram_draw d = histogram_draw_grid(n);
    uint32_t i[3], seen = 0;
    assert_true(d.count <= HISTOGRAM_DRAWS);
    for (i[2] = 0; i[2] < d.blocks[2]; i[2]++)
        for (i[1] = 0; i[1] < d.blocks[1]; i[1]++)
            for (i[0] = 0; i[0] < d.blocks[0]; i[0]++) {
                uint32_t node[3];
                assert_int_equal(histogram_draw_node(&d, i, node), seen++);
                for (int a = 0; a < 3; a++)
                    assert_true(node[a] / d.step == i[a] && node[a] < n[a]);
            }
    const histogram_run r = histogram_draw_tets(1000003, 8);
    assert_true(r.count <= HISTOGRAM_TETS / 8 && r.count > HISTOGRAM_TETS / 16);
    for (uint32_t k = 0; k < r.count; k++) {
        const uint64_t tet = histogram_draw_tet(&r, k);
        assert_true(tet / r.step == k && tet < r.total);
    }
    assert_int_equal(histogram_draw_tets(100, 1u << 20).count, 1);
}

static void test_tet(void **state) {
    (void)state;
    static const float p[4][3] = {{1, 1, 1}, {3, 1, 1}, {1, 4, 1}, {1, 1, 5}};
    const float *corners[4] = {p[0], p[1], p[2], p[3]};
    /* f = 3x + 4z: gradient of length 5, volume 4. */
    const float values[4] = {7, 13, 7, 23};
    histogram_cell c = histogram_tet(corners, values);
    assert_true(c.lo == 7 && c.hi == 23 && c.value == 12.5F);
    assert_true(fabsf(c.slope - 5) < 1e-5F && fabsf(c.area - 4 * 5 / 16.0F) < 1e-5F);
    const float holed[4] = {7, NAN, 7, 23};
    c = histogram_tet(corners, holed);
    assert_true(isnan(c.value) && c.lo > c.hi);
    corners[3] = p[0];
    c = histogram_tet(corners, values);
    assert_true(c.lo == 7 && c.slope == 0 && c.area == 0);
}

/* A parallelepiped: f = 3x + 4z is linear in it, and its edges span a volume of 24. */
static void test_hex(void **state) {
    (void)state;
    static const float edge[3][3] = {{2, 0, 0}, {1, 3, 0}, {0, 1, 4}};
    float p[HISTOGRAM_CORNERS][3], values[HISTOGRAM_CORNERS];
    const float *corners[HISTOGRAM_CORNERS];
    for (int c = 0; c < HISTOGRAM_CORNERS; c++) {
        for (int a = 0; a < 3; a++)
            p[c][a] = (float)(c & 1) * edge[0][a] + (float)(c >> 1 & 1) * edge[1][a] +
                      (float)(c >> 2) * edge[2][a] + 5;
        values[c] = 3 * p[c][0] + 4 * p[c][2];
        corners[c] = p[c];
    }
    histogram_cell h = histogram_hex(corners, values);
    assert_true(h.lo == 35 && h.hi == 60 && h.value == 47.5F);
    assert_true(fabsf(h.slope - 5) < 1e-5F && fabsf(h.area - 24 * 5 / 25.0F) < 1e-5F);
    values[6] = INFINITY;
    h = histogram_hex(corners, values);
    assert_true(isnan(h.value) && h.lo > h.hi);
    values[6] = 60;
    for (int c = 0; c < HISTOGRAM_CORNERS; c++)
        p[c][1] = 0;
    h = histogram_hex(corners, values);
    assert_true(h.lo == 35 && h.slope == 0 && h.area == 0);
}

static void test_faults(void **state) {
    (void)state;
    histogram h, bad;
    for (int i = 0; i < NODES; i++)
        f32[i] = (float)wave(i);
    check_counts("sound", SAMPLE_F32, f32, &h);
    bad = h;
    bad.bins = 257;
    assert_non_null(histogram_fault(&bad));
    bad = h;
    bad.edges[9] = bad.edges[8];
    assert_non_null(histogram_fault(&bad));
    bad = h;
    bad.samples[3]++;
    assert_non_null(histogram_fault(&bad));
    bad = h;
    bad.gradient[100] = NAN;
    assert_non_null(histogram_fault(&bad));
    bad = h;
    bad.reserved[1] = 1;
    assert_non_null(histogram_fault(&bad));
    bad = h;
    bad.edges[bad.bins] = 0x1p129;
    assert_non_null(histogram_fault(&bad));
    bad = h;
    bad.active[7] = 0;
    bad.gradient[7] = bad.area[7] = 0;
    memset(bad.box[7], 3, sizeof bad.box[7]);
    assert_non_null(histogram_fault(&bad));
    memset(bad.box[7], 0, sizeof bad.box[7]);
    assert_null(histogram_fault(&bad));
}

/* Bytes behind the edges that are used, be it none. */
static void test_unused_edges(void **state) {
    (void)state;
    for (uint32_t bins = 0; bins < HISTOGRAM_BINS; bins += 5) {
        histogram h = {.bins = bins};
        for (uint32_t i = 0; i <= bins && bins; i++)
            h.edges[i] = 3 + i;
        assert_null(histogram_fault(&h));
        for (uint32_t i = bins ? bins + 1 : 0; i <= HISTOGRAM_BINS; i++) {
            h.edges[i] = 1e9;
            assert_non_null(histogram_fault(&h));
            h.edges[i] = 0;
        }
    }
}

/* Of any widths, as a hostile file may have them: no more rows than there is room for. */
static void test_rows(void **state) {
    (void)state;
    for (uint32_t bins = 1; bins <= HISTOGRAM_BINS; bins++)
        for (uint32_t narrow = 0; narrow < 3 && narrow < bins; narrow++) {
            histogram h = {.bins = bins};
            for (uint32_t i = 0; i < bins; i++)
                h.edges[i + 1] = h.edges[i] + (i == narrow ? 1 : 100);
            assert_null(histogram_fault(&h));
            char *text = NULL;
            size_t size = 0, lines = 0;
            FILE *to = open_memstream(&text, &size);
            histogram_print(to, &h, "samples", true);
            fclose(to);
            for (size_t i = 0; i < size; i++)
                lines += text[i] == '\n';
            free(text);
            assert_in_range(lines, 3, 2 + 26); /* an empty one and a title before them */
        }
}

/* Two materials and noise around zero: what is suggested lies between them. */
static void test_suggestion(void **state) {
    (void)state;
    static uint8_t u8[NODES];
    histogram h;
    uint32_t seed = 12345;
    for (int i = 0; i < NODES; i++) {
        const int x = i % NX - 12, y = i / NX % NY - 10, z = i / (NX * NY) - 8;
        seed = seed * 1664525u + 1013904223u;
        u8[i] = (uint8_t)((x * x + y * y + z * z < 36 ? 180 : 10) + (seed >> 24) % 12);
    }
    check_counts("a ball", SAMPLE_U8, u8, &h);
    double isovalues[HISTOGRAM_ISOVALUES];
    assert_true(histogram_suggest(&h, isovalues, HISTOGRAM_ISOVALUES) >= 1);
    assert_true(isovalues[0] > 21 && isovalues[0] < 180);
}

/* Cells of a mesh, evenly from 0 to 1, but that `far` of a thousand go on to 5, ever steeper. */
static void make_stress(histogram *h, uint32_t far) {
    enum { CELLS = 20000 };
    static histogram_cell stressed[CELLS];
    const double range[2] = {0.0, 5.0};
    for (uint32_t i = 0; i < CELLS; i++) {
        const uint32_t bulk = CELLS - CELLS / 1000 * far;
        const float v = i < bulk ? (float)i / (float)bulk
                                 : 1.0f + 4.0f * (float)(i - bulk) / (float)(CELLS - bulk);
        const float half = i < bulk ? 0.02f : 0.4f;
        stressed[i] = (histogram_cell){.value = v,
                                       .lo = fmaxf(0.0f, v - half),
                                       .hi = fminf(5.0f, v + half),
                                       .slope = i < bulk ? 1.0f : 300.0f,
                                       .area = 1.0f};
    }
    histogram_build(h, stressed, CELLS, SAMPLE_F32, range, CELLS);
}

/* What is suggested of a mesh is no corner of it: one in a hundred lies beyond, on either side. */
static void test_mesh_suggestion(void **state) {
    (void)state;
    for (uint32_t far = 4; far <= 9; far++) {
        histogram h;
        double isovalues[HISTOGRAM_ISOVALUES];
        make_stress(&h, far);
        const int count = histogram_suggest(&h, isovalues, HISTOGRAM_ISOVALUES);
        assert_true(count >= 1);
        assert_true(isovalues[0] > 0.2 && isovalues[0] < 0.8);
        for (int i = 0; i < count; i++)
            assert_true(isovalues[i] >= 0.01 && isovalues[i] <= 0.99);
    }
    histogram h;
    double isovalue;
    make_stress(&h, 0);
    memset(h.samples, 0, sizeof h.samples);
    h.samples[40] = 4;
    h.samples[20] = (uint32_t)h.drawn - 4;
    assert_int_equal(histogram_suggest(&h, &isovalue, 1), 1); /* better than none */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bytes),
        cmocka_unit_test(test_wide_integers),
        cmocka_unit_test(test_floats),
        cmocka_unit_test(test_outlier),
        cmocka_unit_test(test_none),
        cmocka_unit_test(test_measures),
        cmocka_unit_test(test_drawn),
        cmocka_unit_test(test_draw_places),
        cmocka_unit_test(test_tet),
        cmocka_unit_test(test_hex),
        cmocka_unit_test(test_faults),
        cmocka_unit_test(test_suggestion),
        cmocka_unit_test(test_mesh_suggestion),
        cmocka_unit_test(test_unused_edges),
        cmocka_unit_test(test_rows),
        cmocka_unit_test(test_marker),
        cmocka_unit_test(test_aside),
        cmocka_unit_test(test_aside_of_what),
        cmocka_unit_test(test_parting),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
