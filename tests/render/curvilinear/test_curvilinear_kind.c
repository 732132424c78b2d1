/* test_curvilinear_kind.c - files of curvilinear grids, drawn: first surfaces against brute force
 * in long double, under any budget; points; media and projections; files that lie.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/hexahedron.h"
#include "prep/leafcast_prep.h"
#include "render/ray/open_volume.h"
#include "stream/curvilinear_resident.h"
#include "tests/support/curvilinear_file.h"
#include "tests/support/fields.h"
#include "tests/support/fixture.h"
#include "tests/support/hex_judge.h"
#include "tests/support/hex_truth.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* Two zones that share a face, of several treelets each, bent and shaken so that no face is flat.
 */
enum { NODES_J = 6, NODES_K = 34, LONG = 36, SHORT = 7, ZONES = 2 };
enum { NODES_MAX = LONG * NODES_J * NODES_K };

typedef struct two_zones {
    float p[ZONES][NODES_MAX][3], values[ZONES][NODES_MAX];
    curvilinear_zone zone[ZONES];
} two_zones;

/* Of one node of both zones together; i counts through them. */
static void place_node(uint32_t i, uint32_t j, uint32_t k, float p[3], float *value) {
    field_random r = {FIELD_SEED + i + 100 * (j + 100 * (uint64_t)k)};
    const double shake = 0.35;
    const double x = i + shake * (field_random_unit(&r) - 0.5),
                 y = j + shake * (field_random_unit(&r) - 0.5),
                 z = k + shake * (field_random_unit(&r) - 0.5);
    p[0] = (float)(x + 2.0 * sin(0.2 * z));
    p[1] = (float)(y + 1.5 * cos(0.15 * x));
    p[2] = (float)(z + 0.5 * sin(y));
    *value = (float)(sin(0.35 * x) + cos(0.3 * z) + 0.4 * y - 1.0 + 0.2 * field_random_unit(&r));
}

static void make_zones(two_zones *s) {
    for (uint32_t z = 0; z < ZONES; z++) {
        const uint32_t along = z ? SHORT : LONG, from = z ? LONG - 1 : 0;
        uint32_t n = 0;
        for (uint32_t k = 0; k < NODES_K; k++)
            for (uint32_t j = 0; j < NODES_J; j++)
                for (uint32_t i = 0; i < along; i++, n++)
                    place_node(from + i, j, k, s->p[z][n], &s->values[z][n]);
        s->zone[z] = (curvilinear_zone){
            {along, NODES_J, NODES_K}, (const float(*)[3])s->p[z], s->values[z], NULL};
    }
}

static hexahedron cell_of(const curvilinear_zone *z, uint32_t i, uint32_t j, uint32_t k) {
    hexahedron h;
    for (uint32_t c = 0; c < HEX_CORNERS; c++) {
        const uint32_t n =
            i + (c & 1) + z->nodes[0] * (j + (c >> 1 & 1) + z->nodes[1] * (k + (c >> 2)));
        h.value[c] = (double)z->values[n];
        for (int a = 0; a < 3; a++)
            h.p[c][a] = (double)z->p[n][a];
    }
    return h;
}

static leafcast *open_zones(const two_zones *s, const leafcast_options *o) {
    const leaf_image image = curvilinear_file(s->zone, ZONES);
    leafcast *v = fixture_open(scratch_write("curvilinear.leaf", image.bytes, image.size), o);
    free(image.bytes);
    return v;
}

static void test_surfaces(void **state) {
    enum { SIDE = SLOW ? 12 : 40 };
    (void)state;
    static two_zones s;
    static picture p;
    const double iso = 0.3;
    hex_tally tally = {0};
    hex_judge j;
    make_zones(&s);
    leafcast *v = open_zones(&s, NULL);
    const leafcast_info info = leafcast_describe(v);
    assert_string_equal(info.kind, "curvilinear grid");
    assert_int_equal(info.cells, (LONG - 1 + SHORT - 1) * (NODES_J - 1) * (NODES_K - 1));
    const leafcast_surface surface = leafcast_surface_default(iso);
    const leafcast_scene scene = leafcast_scene_default();
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    hex_judge_open(&j, v);
    const leafcast_camera small = leafcast_standard_view(v, 1.1, SIDE, SIDE);
    (void)hex_judge_picture(&j, v, iso, &small, &tally);
    hex_tally_row(stdout, "two zones", &tally);
    assert_true(tally.surfaces > tally.rays / 8 && tally.doubtful <= tally.rays / 50);
    assert_int_equal(hex_tally_faults(&tally), 0);
    assert_true(tally.worst < 1e-9);
    const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
    pictures_draw(v, &scene, &c, &p, NULL);
    for (uint32_t i = 0; i < PICTURE_PIXELS; i++) {
        double square = 0.0;
        for (int a = 0; a < 3; a++)
            square += (double)p.normal[a][i] * (double)p.normal[a][i];
        assert_true(p.id[i] < 0 || fabs(square - 1.0) < 1e-5);
    }
    hex_judge_release(&j);
    leafcast_close(v);
}

/* The same picture, to the bit, with room for a treelet or two, by any backend and threads. What is
 * too little names what is enough, which depends on the processor. */
static void test_budgets(void **state) {
    (void)state;
    static two_zones s;
    static picture whole, p;
    make_zones(&s);
    const leafcast_surface surface = leafcast_surface_default(0.3);
    leafcast_scene scene = leafcast_scene_default();
    scene.shadows = true;
    size_t memory[] = {0, (size_t)1 << 20, 0};
    for (int n = 0; n < 3; n++) {
        const leafcast_options o = {.size = sizeof o, .threads = n ? 2 : 1, .memory = memory[n]};
        leafcast *v = open_zones(&s, &o);
        assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
        const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
        if (n == 1)
            memory[2] = pictures_least_memory(v, &scene, &c);
        else
            pictures_draw(v, &scene, &c, n ? &p : &whole, NULL);
        leafcast_close(v);
    }
    assert_memory_equal(p.z, whole.z, sizeof p.z);
    assert_memory_equal(p.rgba, whole.rgba, sizeof p.rgba);
}

/* ---- Values ---- */

/* The cell of a number in the file. */
static hexahedron numbered(const two_zones *s, const leafcast *v, uint64_t number) {
    const curvilinear_directory *d = curvilinear_directory_of(v->file);
    uint32_t t = 0;
    while (d->first[t + 1] <= number)
        t++;
    const uint32_t n = (uint32_t)(number - d->first[t]), *cells = d->counts[t],
                   *first = d->where[t].first;
    return cell_of(&s->zone[d->where[t].zone], first[0] + n % cells[0],
                   first[1] + n / cells[0] % cells[1], first[2] + n / (cells[0] * cells[1]));
}

/* What is told of a cell by its number. */
static void check_cell(const two_zones *s, leafcast *v, uint64_t number) {
    const hexahedron h = numbered(s, v, number);
    leafcast_cell told = {.size = sizeof told};
    uint32_t index[3];
    assert_int_equal(leafcast_get_cell(v, 0, number, &told), LEAFCAST_OK);
    assert_int_equal(told.corners, HEX_CORNERS);
    assert_memory_equal(told.position, h.p, sizeof h.p);
    for (int c = 0; c < HEX_CORNERS; c++)
        assert_true((double)told.value[c] == h.value[c]);
    assert_int_equal(leafcast_cell_indices(v, 0, number, index), 3);
    assert_memory_equal(told.index, index, sizeof index);
    const curvilinear_directory *d = curvilinear_directory_of(v->file);
    uint32_t t = 0;
    while (d->first[t + 1] <= number)
        t++;
    const hexahedron again =
        cell_of(&s->zone[d->where[t].zone], told.index[0], told.index[1], told.index[2]);
    assert_memory_equal(again.p, h.p, sizeof h.p);
}

/* Where a hit is in its cell. */
static void check_hit(const two_zones *s, const leafcast *v, const leafcast_hit *met, double iso) {
    const hexahedron h = numbered(s, v, met->cell);
    double value = 0.0;
    assert_false(met->flat);
    for (int c = 0; c < HEX_CORNERS; c++)
        value += h.value[c] * (c & 1 ? met->at[0] : 1.0 - met->at[0]) *
                 (c >> 1 & 1 ? met->at[1] : 1.0 - met->at[1]) *
                 (c >> 2 ? met->at[2] : 1.0 - met->at[2]);
    assert_true(fabs(value - iso) < 1e-9);
}

static void test_hits(void **state) {
    enum { RAYS = SLOW ? 40 : 400, HITS = 64 };
    static two_zones s;
    static leafcast_hit hits[HITS];
    (void)state;
    field_random r = {FIELD_SEED};
    const leafcast_scene scene = leafcast_scene_default();
    long found = 0;
    make_zones(&s);
    leafcast *v = open_zones(&s, NULL);
    const double iso = 0.5 * (v->file->header.value_min + v->file->header.value_max);
    const leafcast_surface surface = leafcast_surface_default(iso);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    for (int i = 0; i < RAYS; i++) {
        const float *b = v->file->header.bounds;
        double o[3], d[3];
        int count = 0;
        for (int a = 0; a < 3; a++) {
            const double size = (double)(b[a + 3] - b[a]);
            o[a] = (double)b[a] + size * field_random_in(&r, -1.0, 2.0);
            d[a] = (double)b[a] + size * field_random_unit(&r) - o[a];
        }
        assert_int_equal(leafcast_probe_ray(v, &scene, o, d, hits, HITS, &count), LEAFCAST_OK);
        for (int n = 0; n < count; n++, found++)
            check_hit(&s, v, &hits[n], iso);
    }
    assert_true(found > RAYS / 4);
    leafcast_close(v);
}

/* ---- A grid that happens to be regular ---- */

enum { REGULAR = 20, REGULAR_NODES = REGULAR * REGULAR * REGULAR };

/* Both have nodes at whole numbers, so their surfaces are the same function's. */
static void open_both(leafcast *both[2]) {
    static float p[REGULAR_NODES][3], values[REGULAR_NODES];
    field_random r = {FIELD_SEED};
    leafcast_grid g = {.size = sizeof g};
    for (uint32_t n = 0; n < REGULAR_NODES; n++) {
        p[n][0] = (float)(n % REGULAR);
        p[n][1] = (float)(n / REGULAR % REGULAR);
        p[n][2] = (float)(n / REGULAR / REGULAR);
        values[n] = (float)(sin(0.6 * (double)p[n][0]) * cos(0.5 * (double)p[n][1]) +
                            0.4 * sin(0.9 * (double)p[n][2]) + 0.2 * field_random_unit(&r));
    }
    for (int a = 0; a < 3; a++)
        g.dims[a] = REGULAR;
    g.type = LEAFCAST_F32;
    assert_int_equal(leafcast_convert_array(&g, values, NULL, scratch_path("regular.leaf"), NULL),
                     LEAFCAST_OK);
    const curvilinear_zone zone = {{REGULAR, REGULAR, REGULAR}, (const float(*)[3])p, values, NULL};
    const leaf_image image = curvilinear_file(&zone, 1);
    both[0] = fixture_open(scratch_path("regular.leaf"), NULL);
    both[1] = fixture_open(scratch_write("bent.leaf", image.bytes, image.size), NULL);
    free(image.bytes);
}

static void test_regular(void **state) {
    enum { RAYS = SLOW ? 60 : 1000, HITS = 256 };
    static leafcast_hit hits[2][HITS];
    (void)state;
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_surface surface = leafcast_surface_default(0.25);
    field_random r = {FIELD_SEED};
    leafcast *both[2];
    long met = 0;
    open_both(both);
    for (int i = 0; i < 2; i++)
        assert_int_equal(leafcast_select(both[i], &surface, 1), LEAFCAST_OK);
    for (int n = 0; n < RAYS; n++) {
        double o[3], d[3], square = 0.0;
        int count[2] = {0, 0};
        for (int a = 0; a < 3; a++) {
            o[a] = REGULAR * field_random_in(&r, -1.0, 2.0);
            d[a] = REGULAR * field_random_unit(&r) - o[a];
            square += d[a] * d[a];
        }
        for (int i = 0; i < 2; i++)
            assert_int_equal(leafcast_probe_ray(both[i], &scene, o, d, hits[i], HITS, &count[i]),
                             LEAFCAST_OK);
        assert_int_equal(count[0], count[1]);
        for (int k = 0; k < count[0]; k++, met++) {
            assert_true(fabs(hits[0][k].t - hits[1][k].t) * sqrt(square) < 1e-12);
            assert_int_equal(hits[0][k].entering, hits[1][k].entering);
        }
    }
    assert_true(met > RAYS);
    for (int i = 0; i < 2; i++)
        leafcast_close(both[i]);
}

static double value_of(const leafcast_segment *s, double at) {
    const double *b = s->control, rest = 1.0 - at;
    return rest * rest * rest * b[0] + 3.0 * rest * rest * at * b[1] + 3.0 * rest * at * at * b[2] +
           at * at * at * b[3];
}

enum { PIECES = 4096 };

/* The pieces of a ray have the cells' own values, by brute force, and follow one another; so does
 * the value at a point on the way. */
static void judge_ray(const two_zones *s, leafcast *v, field_random *r, long *judged) {
    static leafcast_segment got[PIECES];
    const leafcast_scene scene = leafcast_scene_default();
    const float *b = v->file->header.bounds;
    const double near = 1e-6 * (v->file->header.value_max - v->file->header.value_min);
    double o[3], d[3];
    int count = 0;
    for (int a = 0; a < 3; a++) {
        const double size = (double)(b[a + 3] - b[a]);
        o[a] = (double)b[a] + size * field_random_in(r, -1.0, 2.0);
        d[a] = (double)b[a] + size * field_random_unit(r) - o[a];
    }
    assert_int_equal(leafcast_probe_segments(v, &scene, o, d, got, PIECES, &count), LEAFCAST_OK);
    assert_in_range(count, 0, PIECES - 1);
    for (int n = 0; n < count; n++) {
        const hexahedron h = numbered(s, v, got[n].cell);
        check_cell(s, v, got[n].cell);
        const double inside = field_random_in(r, 0.1, 0.9);
        const double t = got[n].t0 + inside * (got[n].t1 - got[n].t0);
        const double point[3] = {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
        long double at[3] = {0.5L, 0.5L, 0.5L}, truth;
        assert_true(n == 0 || got[n].t0 >= got[n - 1].t0);
        if (!hex_truth_value(h.p, h.value, o, d, t, at, &truth))
            continue;
        assert_true(fabs(value_of(&got[n], inside) - (double)truth) < near);
        assert_true(got[n].most >= (double)truth - near && got[n].least <= (double)truth + near);
        leafcast_sample sample = {.inside = false};
        assert_int_equal(leafcast_probe_point(v, point, &sample), LEAFCAST_OK);
        assert_true(sample.inside && fabs(sample.value - (double)truth) < near);
        ++*judged;
    }
}

static void test_pieces(void **state) {
    enum { RAYS = SLOW ? 20 : 300 };
    (void)state;
    static two_zones s;
    field_random r = {FIELD_SEED};
    long judged = 0;
    make_zones(&s);
    leafcast *v = open_zones(&s, NULL);
    for (int i = 0; i < RAYS; i++)
        judge_ray(&s, v, &r, &judged);
    assert_true(judged > 3 * RAYS);
    leafcast_close(v);
}

/* A medium's opacity, and the extremes, of each pixel are those of its ray's pieces; opacities to
 * within their certificate. */
static void test_media(void **state) {
    enum { STEP = SLOW ? 23 : 7 };
    (void)state;
    static two_zones s;
    static leafcast_segment got[PIECES];
    static double rgba[4 * PICTURE_PIXELS], error[PICTURE_PIXELS], most[PICTURE_PIXELS];
    make_zones(&s);
    leafcast *v = open_zones(&s, NULL);
    const double lo = v->file->header.value_min, hi = v->file->header.value_max;
    const double density = 0.05;
    const leafcast_transfer_point points[2] = {
        {.value = lo, .rgb = {1, 1, 1}},
        {.value = hi, .rgb = {1, 1, 1}, .extinction = density * (hi - lo)}};
    const leafcast_medium medium = {points, 2};
    leafcast_scene scene = leafcast_scene_default();
    scene.media = &medium;
    scene.media_count = 1;
    const leafcast_camera c = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_image image = {.size = sizeof image, .rgba = rgba, .error = error};
    const leafcast_image values = {.size = sizeof values, .value = most};
    assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_OK);
    scene.project = LEAFCAST_PROJECT_MAX;
    assert_int_equal(leafcast_trace(v, &scene, &c, &values, NULL, NULL, NULL), LEAFCAST_OK);
    int seen = 0;
    for (uint32_t i = 0; i < PICTURE_PIXELS; i += STEP) {
        double o[3], d[3], depth = 0.0, greatest = -INFINITY;
        int count = 0;
        leafcast_pixel_ray(&c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        assert_int_equal(leafcast_probe_segments(v, &scene, o, d, got, PIECES, &count),
                         LEAFCAST_OK);
        for (int n = 0; n < count; n++) {
            const double *b = got[n].control;
            depth += (got[n].t1 - got[n].t0) * density * ((b[0] + b[1] + b[2] + b[3]) / 4.0 - lo);
            greatest = fmax(greatest, got[n].most);
        }
        assert_true(fabs(rgba[4 * i + 3] - (1.0 - exp(-depth))) <= error[i] + 1e-6);
        assert_true(error[i] <= 1.0 / 510.0);
        if (count > 0)
            assert_true(fabs(most[i] - greatest) < 1e-6 * (hi - lo));
        seen += count > 0;
    }
    assert_true(seen > 10);
    leafcast_close(v);
}

/* ---- Files that lie ---- */

typedef struct lie {
    const char *said;
    uint32_t section; /* 0: the header, at a byte; PAYLOAD: the first one, at a float */
    size_t at;
    uint32_t value;
} lie;
enum { PAYLOAD = UINT32_MAX };

static void test_lies(void **state) {
    (void)state;
    static two_zones s;
    const lie lies[] = {
        {"cannot have 1 x", LEAF_SECTION_ZONES, 0, 1},
        {"cannot have", LEAF_SECTION_ZONES, 1, CURVILINEAR_NODES_MAX + 1},
        {"cannot have", LEAF_SECTION_ZONES, 3, 1},
        {"do not have", LEAF_SECTION_ZONES, 0, 1000},
        {"do not have", LEAF_SECTION_ZONES, 2, 5},
        {"do not have", LEAF_SECTION_ZONES, 4, 100000000},
        {"zones", 0, offsetof(leaf_header, zones), 0},
        {"zones", 0, offsetof(leaf_header, zones), 1000},
        {"codec", 0, offsetof(leaf_header, codec), LEAF_CODEC_ZSTD + 1},
        {"cells_log2", 0, offsetof(leaf_header, cells_log2), 4},
        {"moving", 0, offsetof(leaf_header, moving), 1},
        {"reserved", 0, offsetof(leaf_header, treelet_tets), 1},
        {"reserved", 0, offsetof(leaf_header, reserved), 1},
        {"is not inside of it", PAYLOAD, 5, UINT32_C(0x7f800000)},
        {"is not inside of it", PAYLOAD, 7, UINT32_C(0x46000000)},
    };
    make_zones(&s);
    for (size_t n = 0; n < sizeof lies / sizeof *lies; n++) {
        leaf_image i = curvilinear_file(s.zone, ZONES);
        const uint64_t first = ((uint64_t *)leaf_image_section(&i, LEAF_SECTION_OFFSETS))[0];
        uint32_t *to = lies[n].section == PAYLOAD ? (uint32_t *)(i.bytes + first) + lies[n].at
                       : lies[n].section == 0
                           ? (uint32_t *)(i.bytes + lies[n].at)
                           : (uint32_t *)leaf_image_section(&i, lies[n].section) + lies[n].at;
        *to = lies[n].value;
        if (lies[n].section == PAYLOAD)
            leaf_image_seal_payloads(&i);
        leaf_image_seal(&i);
        leafcast *v = NULL;
        leafcast_status st = leafcast_open(scratch_write("lie.leaf", i.bytes, i.size), NULL, &v);
        if (lies[n].section == PAYLOAD && st == LEAFCAST_OK) {
            static picture p;
            const leafcast_surface surface = leafcast_surface_default(0.3);
            const leafcast_scene scene = leafcast_scene_default();
            const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
            const leafcast_image image = {.size = sizeof image, .z = p.z};
            assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
            st = leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL);
        }
        if (st == LEAFCAST_OK || !strstr(leafcast_error_text(), lies[n].said) ||
            !strstr(leafcast_error_text(), "lie.leaf"))
            fail_msg("lie %zu: %s", n, leafcast_error_text());
        leafcast_close(v);
        free(i.bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_surfaces), cmocka_unit_test(test_budgets),
        cmocka_unit_test(test_hits),     cmocka_unit_test(test_regular),
        cmocka_unit_test(test_pieces),   cmocka_unit_test(test_media),
        cmocka_unit_test(test_lies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
