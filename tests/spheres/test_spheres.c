/* test_spheres.c - a third kind of geometry is one folder (tests/spheres) and a row of each table:
 * it draws, streams, suspends and gives the same bits as the two that are built in do.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/spheres/spheres.h"
#include "tests/spheres/spheres_facts.h"
#include "tests/spheres/spheres_truth.h"
#include "tests/support/cells_file.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/third_kind.h"
#include "tests/support/watched.h"

THIRD_KIND(SPHERES_KIND, spheres_geometry, spheres_kind)

/* ---- A file ---- */

enum { TREELETS = 27, MOST = 24, BALLS = TREELETS * MOST };

typedef struct lab {
    sphere spheres[BALLS];
    uint32_t counts[TREELETS], count;
    leaf_image file;
    const char *path;
    spheres_truth truth;
} lab;

static const double isovalues[2] = {0.35, 0.95};
static const float colours[2][3] = {{0.9f, 0.1f, 0.2f}, {0.1f, 0.7f, 0.9f}};

/* Treelet t is a block of 3 x 3 x 3, whose balls reach into its neighbours. Every third treelet
 * has low ones alone. */
static void make_treelet(lab *l, uint32_t t, field_random *r) {
    const uint32_t place[3] = {t % 3, t / 3 % 3, t / 9};
    l->counts[t] = 3 + (uint32_t)(field_random_unit(r) * (MOST - 3));
    for (uint32_t i = 0; i < l->counts[t]; i++) {
        sphere *x = &l->spheres[l->count++];
        *x = (sphere){.radius = 1.0 + 5.0 * field_random_unit(r),
                      .peak = t % 3 == 1 ? 0.6 + 0.3 * field_random_unit(r)
                                         : 0.3 + 1.5 * field_random_unit(r)};
        for (int a = 0; a < 3; a++)
            x->centre[a] = 30.0 * (place[a] + field_random_unit(r)) - 7.0;
    }
}

static lab *lab_make(void) {
    static lab l;
    field_random r = {FIELD_SEED};
    l = (lab){.count = 0};
    for (uint32_t t = 0; t < TREELETS; t++)
        make_treelet(&l, t, &r);
    l.file = cells_file(&(cells_input){.kind = SPHERES_KIND,
                                       .name = "spheres",
                                       .records = l.spheres,
                                       .counts = l.counts,
                                       .treelets = TREELETS,
                                       .steps = 1});
    l.path = scratch_write("spheres.leaf", l.file.bytes, l.file.size);
    l.truth = (spheres_truth){l.spheres, l.count, isovalues, 2};
    return &l;
}

static leafcast *open_with(const lab *l, const leafcast_options *o, float opacity) {
    leafcast *v = fixture_open(l->path, o);
    leafcast_surface surfaces[2];
    for (int i = 0; i < 2; i++) {
        surfaces[i] = leafcast_surface_default(isovalues[i]);
        surfaces[i].opacity = opacity;
        memcpy(surfaces[i].rgb, colours[i], sizeof colours[i]);
    }
    assert_int_equal(leafcast_select(v, surfaces, 2), LEAFCAST_OK);
    return v;
}

/* 0: standard, 1: close, 2: inside, 3: far, along an axis */
enum { VIEWS = 4 };
static leafcast_camera view_of(const leafcast *v, int which) {
    leafcast_camera c =
        leafcast_standard_view(v, which == 1 ? 1.1 : 2.2, PICTURE_WIDTH, PICTURE_HEIGHT);
    if (which == 2)
        memcpy(c.eye, (double[3]){38.0, 41.0, 35.5}, sizeof c.eye);
    if (which == 3) {
        memcpy(c.eye, (double[3]){38.0, 38.0, 4000.0}, sizeof c.eye);
        memcpy(c.look_at, (double[3]){38.0, 38.0, 0.0}, sizeof c.look_at);
        memcpy(c.up, (double[3]){0.0, 1.0, 0.0}, sizeof c.up);
        c.fov = 1.5;
    }
    return c;
}

/* ---- Pictures against the truth ---- */

typedef struct tally {
    int pixels, hits, missed, wrong, grazing;
    double worst;
} tally;

static void judge_pixel(const lab *l, const leafcast_camera *c, const picture *p, uint32_t i,
                        tally *sum) {
    double origin[3], direction[3];
    truth_hit hits[TRUTH_HITS_MAX];
    bool grazing = false;
    leafcast_pixel_ray(c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, origin, direction);
    const int count =
        spheres_truth_hits(&l->truth, origin, direction, 0.0, INFINITY, hits, &grazing);
    sum->pixels++;
    sum->grazing += grazing;
    if (grazing)
        return;
    const int want = count > 0 ? hits[0].iso : -1;
    sum->hits += count > 0;
    sum->missed += p->id[i] != want;
    if (count == 0 || p->id[i] != want)
        return;
    const sphere *x = &l->spheres[hits[0].number];
    double off = fabs((double)((long double)p->z[i] / hits[0].t - 1.0L)), normal = 0.0;
    for (int a = 0; a < 3; a++) {
        const double n = (origin[a] + (double)hits[0].t * direction[a] - x->centre[a]) /
                         (x->radius * sqrt(1.0 - isovalues[want] / x->peak));
        normal = fmax(normal, fabs(n - (double)p->normal[a][i]));
    }
    sum->worst = fmax(sum->worst, off);
    sum->wrong += !(off <= 1e-12) || !(normal <= 1e-6);
}

static void test_first_surfaces(void **state) {
    (void)state;
    static picture p;
    const lab *l = lab_make();
    leafcast *v = open_with(l, NULL, 1.0f);
    const leafcast_scene scene = leafcast_scene_default();
    tally sum = {0};
    for (int view = 0; view < VIEWS; view++) {
        const leafcast_camera c = view_of(v, view);
        leafcast_stats stats = {.size = sizeof stats};
        uint64_t covered = 0;
        pictures_draw(v, &scene, &c, &p, &stats);
        for (uint32_t i = 0; i < PICTURE_PIXELS; i++) {
            judge_pixel(l, &c, &p, i, &sum);
            covered += p.id[i] >= 0;
        }
        assert_int_equal(stats.primary_rays, PICTURE_PIXELS);
        assert_int_equal(stats.covered_pixels, covered);
    }
    print_message("# %d pixels, %d hits, %d missed or false, %d wrong, %d grazing, worst %.2g\n",
                  sum.pixels, sum.hits, sum.missed, sum.wrong, sum.grazing, sum.worst);
    assert_true(sum.hits > sum.pixels / 4 && sum.grazing < sum.pixels / 100);
    assert_int_equal(sum.missed, 0);
    assert_int_equal(sum.wrong, 0);
    leafcast_close(v);
    free(l->file.bytes);
}

/* All surfaces of a ray, each of its own colour, one behind the other. */
static void compose(const truth_hit hits[], int count, float opacity, float rgba[4]) {
    memset(rgba, 0, 4 * sizeof *rgba);
    for (int i = 0; i < count && rgba[3] < 1.0f - 1.0f / 4096.0f; i++) {
        const float weight = (1.0f - rgba[3]) * opacity;
        for (int a = 0; a < 3; a++)
            rgba[a] += weight * colours[hits[i].iso][a];
        rgba[3] += weight;
    }
}

static void test_transparency(void **state) {
    (void)state;
    static picture p;
    const lab *l = lab_make();
    leafcast *v = open_with(l, NULL, 0.25f);
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera c = view_of(v, 1);
    int wrong = 0, deepest = 0;
    scene.shading = LEAFCAST_SHADING_FLAT;
    pictures_draw(v, &scene, &c, &p, NULL);
    for (uint32_t i = 0; i < PICTURE_PIXELS; i++) {
        double origin[3], direction[3];
        truth_hit hits[TRUTH_HITS_MAX];
        bool grazing = false;
        float want[4];
        leafcast_pixel_ray(&c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, origin, direction);
        const int count =
            spheres_truth_hits(&l->truth, origin, direction, 0.0, INFINITY, hits, &grazing);
        deepest = count > deepest ? count : deepest;
        compose(hits, count, 0.25f, want);
        for (int a = 0; a < 4 && !grazing; a++)
            wrong += !(fabsf(p.rgba[a][i] - want[a]) <= 1e-5f);
    }
    print_message("# up to %d surfaces on a ray\n", deepest);
    assert_true(deepest > 10);
    assert_int_equal(wrong, 0);
    leafcast_close(v);
    free(l->file.bytes);
}

/* Whether something lies between a point of a sphere and a light in a direction; its own surface
 * apart, which the point lies on. */
static bool hidden(const lab *l, const truth_hit *from, const double at[3], const double to[3],
                   bool *grazing) {
    truth_hit hits[TRUTH_HITS_MAX];
    const int count = spheres_truth_hits(&l->truth, at, to, -1e-6, INFINITY, hits, grazing);
    bool any = false;
    for (int i = 0; i < count; i++) {
        const bool own = hits[i].number == from->number && hits[i].iso == from->iso;
        if (fabsl(hits[i].t) < 1e-6L)
            *grazing |= !own;
        else
            any = true;
    }
    return any;
}

static void test_shadows(void **state) {
    (void)state;
    static picture p;
    const lab *l = lab_make();
    leafcast *v = open_with(l, NULL, 1.0f);
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera c = view_of(v, 0);
    const double to[3] = {0.48, -0.6, 0.64};
    int wrong = 0, dark = 0, lit = 0, grazes = 0;
    scene.ambient = 0.0f;
    scene.shadows = true;
    scene.light_count = 1;
    scene.lights[0] = (leafcast_light){.vector = {to[0], to[1], to[2]}, .rgb = {1, 1, 1}};
    leafcast_stats stats = {.size = sizeof stats};
    pictures_draw(v, &scene, &c, &p, &stats);
    for (uint32_t i = 0; i < PICTURE_PIXELS; i++) {
        double origin[3], direction[3], at[3], slope = 0.0;
        truth_hit hits[TRUTH_HITS_MAX];
        bool grazing = false;
        leafcast_pixel_ray(&c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, origin, direction);
        if (spheres_truth_hits(&l->truth, origin, direction, 0.0, INFINITY, hits, &grazing) == 0)
            continue;
        const sphere *x = &l->spheres[hits[0].number];
        for (int a = 0; a < 3; a++) {
            at[a] = (double)((long double)origin[a] + hits[0].t * (long double)direction[a]);
            slope += (at[a] - x->centre[a]) * to[a] / x->radius;
        }
        const bool sees = slope > 0.0 && !hidden(l, &hits[0], at, to, &grazing);
        grazing |= fabs(slope) < 1e-3;
        grazes += grazing;
        lit += !grazing && sees;
        dark += !grazing && !sees && slope > 0.0;
        wrong += !grazing && (p.rgba[0][i] > 0.0f) != sees;
    }
    print_message("# %d lit, %d in shadow, %d grazing\n", lit, dark, grazes);
    assert_true(lit > PICTURE_PIXELS / 20 && dark > PICTURE_PIXELS / 80 &&
                grazes < PICTURE_PIXELS / 40);
    assert_true(stats.shadow_rays >= (uint64_t)(lit + dark));
    assert_int_equal(wrong, 0);
    leafcast_close(v);
    free(l->file.bytes);
}

/* ---- The same bits ---- */

static leafcast_scene hard_scene(void) {
    leafcast_scene s = leafcast_scene_default();
    s.shadows = true;
    s.light_count = 2;
    s.lights[0] = (leafcast_light){.vector = {1.0, -0.4, 0.7}, .rgb = {0.9f, 0.8f, 0.7f}};
    s.lights[1] =
        (leafcast_light){.point = true, .vector = {38.0, 30.0, 120.0}, .rgb = {0.3f, 0.4f, 0.5f}};
    s.clip_plane_count = 1;
    memcpy(s.clip_planes[0], (double[4]){0.3, 0.5, -0.2, -12.0}, sizeof s.clip_planes[0]);
    return s;
}

static void assert_same(const lab *l, const picture *want, const leafcast_options *o,
                        leafcast_stats *stats) {
    static picture got;
    leafcast *v = open_with(l, o, 0.5f);
    const leafcast_scene scene = hard_scene();
    const leafcast_camera c = view_of(v, 1);
    *stats = (leafcast_stats){.size = sizeof *stats};
    for (int again = 0; again < 2; again++) {
        pictures_draw(v, &scene, &c, &got, again ? NULL : stats);
        assert_memory_equal(want->z, got.z, sizeof got.z);
        assert_memory_equal(want->id, got.id, sizeof got.id);
        assert_memory_equal(want->normal, got.normal, sizeof got.normal);
        assert_memory_equal(want->rgba, got.rgba, sizeof got.rgba);
    }
    leafcast_close(v);
}

static bool suffices(const lab *l, uint64_t memory, int threads) {
    static picture p;
    const leafcast_scene scene = hard_scene();
    const leafcast_options o = {
        .size = sizeof(leafcast_options), .memory = memory, .threads = threads};
    leafcast *v = NULL;
    if (leafcast_open(l->path, &o, &v) != LEAFCAST_OK)
        return false;
    const leafcast_camera c = view_of(v, 1);
    const leafcast_image image = {.size = sizeof image,
                                  .r = p.rgba[0],
                                  .g = p.rgba[1],
                                  .b = p.rgba[2],
                                  .a = p.rgba[3],
                                  .z = p.z,
                                  .normal = {p.normal[0], p.normal[1], p.normal[2]},
                                  .id = p.id,
                                  .provisional = p.provisional};
    const leafcast_status st = leafcast_check_room(v, &scene, &c, &image, 0);
    leafcast_close(v);
    return st == LEAFCAST_OK;
}

/* The smallest budget that a picture can be drawn in. */
static uint64_t least_memory(const lab *l, int threads) {
    uint64_t lo = 1, hi = UINT64_C(1) << 28;
    while (hi - lo > 1) {
        const uint64_t middle = lo + (hi - lo) / 2;
        if (suffices(l, middle, threads))
            hi = middle;
        else
            lo = middle;
    }
    return hi;
}

static void test_same_bits(void **state) {
    (void)state;
    static picture want;
    const lab *l = lab_make();
    leafcast_options o = {.size = sizeof(leafcast_options), .threads = 1};
    leafcast_stats stats;
    leafcast *v = open_with(l, &o, 0.5f);
    const leafcast_scene scene = hard_scene();
    const leafcast_camera c = view_of(v, 1);
    pictures_draw(v, &scene, &c, &want, NULL);
    leafcast_close(v);
    for (int threads = WATCHED_THREADS ? 4 : 1; threads <= 4; threads += 3) {
        static const char *const isas[] = {"auto", "scalar"};
        for (int i = 0; i < 2; i++) {
            o = (leafcast_options){
                .size = sizeof(leafcast_options), .threads = threads, .isa = isas[i]};
            assert_same(l, &want, &o, &stats);
            o.backend = LEAFCAST_BACKEND_MAPPED;
            assert_same(l, &want, &o, &stats);
        }
        for (uint32_t limit = 1; limit <= 5; limit += 2) {
            o = (leafcast_options){.size = sizeof(leafcast_options),
                                   .threads = threads,
                                   .experiments = EXPERIMENTS(.treelet_limit = limit)};
            assert_same(l, &want, &o, &stats);
            if (limit == 1) /* they take turns */
                assert_true(stats.treelets_loaded > 2 * TREELETS && stats.passes > TREELETS);
        }
        o = (leafcast_options){.size = sizeof(leafcast_options),
                               .threads = threads,
                               .memory = least_memory(l, threads)};
        assert_same(l, &want, &o, &stats);
        assert_true(stats.treelets_loaded > TREELETS && stats.bytes_peak <= o.memory);
    }
    free(l->file.bytes);
}

/* ---- What is read ---- */

static void test_reads_what_is_active(void **state) {
    (void)state;
    static picture p;
    const lab *l = lab_make();
    leafcast *v = fixture_open(l->path, NULL);
    const leafcast_surface high = leafcast_surface_default(1.2);
    const leafcast_scene scene = leafcast_scene_default();
    leafcast_stats stats = {.size = sizeof stats};
    uint64_t active = 0, bytes = 0, at = 0;
    for (uint32_t t = 0; t < TREELETS; at += l->counts[t++]) {
        double peak = 0.0;
        for (uint32_t i = 0; i < l->counts[t]; i++)
            peak = fmax(peak, l->spheres[at + i].peak);
        active += peak >= 1.2;
        bytes += peak >= 1.2 ? l->counts[t] * sizeof(sphere) : 0;
    }
    assert_true(active > 0 && active <= TREELETS - TREELETS / 3);
    assert_int_equal(leafcast_select(v, &high, 1), LEAFCAST_OK);
    const leafcast_camera c = view_of(v, 0);
    pictures_draw(v, &scene, &c, &p, &stats);
    const leafcast_info info = leafcast_describe(v);
    assert_string_equal(info.kind, "spheres");
    assert_int_equal(info.treelets, TREELETS);
    assert_int_equal(stats.treelets_total, TREELETS);
    assert_int_equal(stats.treelets_active, active);
    assert_int_equal(stats.bytes_active, bytes);
    assert_true(stats.treelets_loaded <= active && stats.bytes_read <= bytes);
    assert_int_equal(stats.bytes_read, stats.bytes_visible);
    assert_int_equal(stats.bytes_file, l->file.size);
    leafcast_block map;
    const uint32_t one[3] = {1, 1, 1};
    assert_int_equal(leafcast_map_treelets(v, 0, one, &map), LEAFCAST_OK);
    assert_true(map.treelets == TREELETS && map.wanted == active &&
                map.resident == stats.treelets_loaded);
    assert_true(stats.nodes > 0 && stats.cells > 0 && stats.roots >= stats.covered_pixels);
    /* An isovalue that nothing holds reads nothing. */
    const leafcast_surface none = leafcast_surface_default(3.0);
    assert_int_equal(leafcast_select(v, &none, 1), LEAFCAST_OK);
    stats = (leafcast_stats){.size = sizeof stats};
    pictures_draw(v, &scene, &c, &p, &stats);
    assert_int_equal(stats.treelets_active + stats.bytes_read + stats.covered_pixels, 0);
    leafcast_close(v);
    free(l->file.bytes);
}

/* ---- Rays and points ---- */

static void test_probe_ray(void **state) {
    (void)state;
    const lab *l = lab_make();
    leafcast *v = open_with(l, NULL, 1.0f);
    const leafcast_scene scene = leafcast_scene_default();
    field_random r = {FIELD_SEED + 1};
    int all = 0, grazes = 0;
    double worst = 0.0;
    for (int n = 0; n < 2000; n++) {
        double origin[3], direction[3];
        static leafcast_hit got[TRUTH_HITS_MAX];
        truth_hit want[TRUTH_HITS_MAX];
        bool grazing = false;
        int count = 0;
        for (int a = 0; a < 3; a++) {
            origin[a] = 200.0 * field_random_unit(&r) - 60.0;
            direction[a] = n % 5 == a ? 0.0 : 80.0 * field_random_unit(&r) - origin[a];
        }
        const int hits =
            spheres_truth_hits(&l->truth, origin, direction, 0.0, INFINITY, want, &grazing);
        assert_int_equal(
            leafcast_probe_ray(v, &scene, origin, direction, got, TRUTH_HITS_MAX, &count),
            LEAFCAST_OK);
        grazes += grazing;
        if (grazing)
            continue;
        assert_int_equal(count, hits);
        all += hits;
        for (int i = 0; i < hits; i++) {
            const double off = fabs((double)((long double)got[i].t - want[i].t));
            assert_int_equal(got[i].cell, want[i].number);
            assert_int_equal(got[i].surface, want[i].iso);
            assert_int_equal(got[i].entering, want[i].entering);
            assert_true(off <= got[i].error_bound);
            worst = fmax(worst, off / (double)(want[i].t + 1e-3L));
        }
    }
    print_message("# %d hits, %d grazing rays, worst %.2g\n", all, grazes, worst);
    assert_true(all > 2000 && grazes < 40 && worst <= 1e-12);
    leafcast_close(v);
    free(l->file.bytes);
}

static void test_probe_point(void **state) {
    (void)state;
    const lab *l = lab_make();
    leafcast *v = open_with(l, NULL, 1.0f);
    field_random r = {FIELD_SEED + 2};
    int inside = 0;
    for (int n = 0; n < 3000; n++) {
        double point[3];
        leafcast_sample got;
        uint64_t number = 0;
        long double value = 0.0L;
        for (int a = 0; a < 3; a++)
            point[a] = 100.0 * field_random_unit(&r) - 12.0;
        const bool any = spheres_truth_at(&l->truth, point, &number, &value);
        assert_int_equal(leafcast_probe_point(v, point, &got), LEAFCAST_OK);
        assert_int_equal(got.inside, any);
        inside += any;
        if (!any)
            continue;
        assert_int_equal(got.cell, number);
        leafcast_cell cell = {.size = sizeof cell};
        assert_int_equal(leafcast_get_cell(v, 0, number, &cell), LEAFCAST_OK);
        assert_true(cell.corners == 0 && cell.indices == 0);
        assert_true(fabs((double)((long double)got.value - value)) <= 1e-12);
        assert_true(number < l->count);
    }
    assert_true(inside > 200 && inside < 2800);
    leafcast_close(v);
    free(l->file.bytes);
}

/* ---- Files ---- */

static leafcast_status open_memory(const leaf_image *i) {
    leafcast *v = NULL;
    const leafcast_status st = leafcast_open_memory(i->bytes, i->size, NULL, &v);
    leafcast_close(v);
    return st;
}

static void test_hostile_files(void **state) {
    (void)state;
    lab *l = lab_make();
    const leaf_image *i = &l->file;
    assert_int_equal(open_memory(i), LEAFCAST_OK);
    i->header->kind = SPHERES_KIND + 1;
    leaf_image_seal(i);
    assert_int_equal(open_memory(i), LEAFCAST_UNSUPPORTED);
    assert_non_null(strstr(leafcast_error_text(), "a geometry of kind 8"));
    i->header->kind = SPHERES_KIND;
    uint32_t(*counts)[4] = leaf_image_section(i, LEAF_SECTION_COUNTS);
    counts[3][0]++;
    leaf_image_seal(i);
    assert_int_equal(open_memory(i), LEAFCAST_CORRUPT);
    counts[3][0]--;
    i->header->tets = 1;
    leaf_image_seal(i);
    assert_int_equal(open_memory(i), LEAFCAST_CORRUPT);
    i->header->tets = 0;
    leaf_image_seal(i);
    assert_int_equal(open_memory(i), LEAFCAST_OK);
    free(l->file.bytes);
}

/* A row of facts is all that `info` needs; a kind without a row tells what all kinds have. */
static void test_facts(void **state) {
    (void)state;
    lab *l = lab_make();
    leaf_file *f = NULL;
    mem m;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open_memory(&m, "balls", l->file.bytes, l->file.size, &f), ST_OK);
    assert_ptr_equal(leaf_teller_of(f), &leaf_tell_other);
    const fact_sheet other = {.values = json_object()}, own = {.values = json_object()};
    leaf_tell_other.tell(f, &other);
    spheres_facts.tell(f, &own);
    assert_int_equal(json_integer_value(json_object_get(other.values, "treelets")), TREELETS);
    assert_null(json_object_get(other.values, "spheres"));
    assert_int_equal(json_integer_value(json_object_get(own.values, "spheres")), l->count);
    json_decref(other.values);
    json_decref(own.values);
    leaf_file_close(f);
    free(l->file.bytes);
}

/* A ball beyond its treelet is found when that comes in. */
static void test_hostile_payload(void **state) {
    (void)state;
    static picture p;
    lab *l = lab_make();
    const leaf_image *i = &l->file;
    const uint64_t *offsets = leaf_image_section(i, LEAF_SECTION_OFFSETS);
    ((sphere *)(i->bytes + offsets[7]))[1].centre[2] += 50.0;
    leaf_image_seal_payloads(i);
    leaf_image_seal(i);
    l->path = scratch_write("hostile.leaf", i->bytes, i->size);
    leafcast *v = open_with(l, NULL, 1.0f);
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera c = view_of(v, 0);
    const leafcast_image image = {.size = sizeof image, .z = p.z};
    scene.sweep = true;
    assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_CORRUPT);
    assert_non_null(strstr(leafcast_error_text(), "treelet 7's sphere 1 is not inside of it"));
    leafcast_close(v);
    free(l->file.bytes);
}

/* The other kinds are still there. */
static void test_grid_beside(void **state) {
    (void)state;
    static picture p;
    field f;
    assert_true(field_make(&f, "noise-u8", 19, FIELD_SEED));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    const leafcast_surface s = leafcast_surface_default(f.iso);
    const leafcast_scene scene = leafcast_scene_default();
    leafcast_stats stats = {.size = sizeof stats};
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    const leafcast_camera c = leafcast_standard_view(v, 2.2, PICTURE_WIDTH, PICTURE_HEIGHT);
    pictures_draw(v, &scene, &c, &p, &stats);
    assert_true(stats.covered_pixels > 0);
    leafcast_close(v);
    field_release(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_first_surfaces),
        cmocka_unit_test(test_transparency),
        cmocka_unit_test(test_shadows),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_reads_what_is_active),
        cmocka_unit_test(test_probe_ray),
        cmocka_unit_test(test_probe_point),
        cmocka_unit_test(test_facts),
        cmocka_unit_test(test_hostile_files),
        cmocka_unit_test(test_hostile_payload),
        cmocka_unit_test(test_grid_beside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
