/* test_heights.c - terrain: exact hits, streaming, what stands in for it, terrain among volumes.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/ray/open_volume.h"
#include "tests/support/fixture.h"
#include "tests/support/heights_lab.h"
#include "tests/support/heights_tile_wide.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

enum { RAYS = 600 };

static const leafcast_surface ground = {0.0, {0.8f, 0.7f, 0.6f}, 1.0f, 0, 0};

/* A terrain of some size. */
static void make_broad(heights_terrain *t, int shape, int n) {
    for (uint64_t of = 1;; of++) {
        heights_lab_make(t, shape, n, of);
        if (t->truth.nx > n / 2 && t->truth.ny > n / 2)
            return;
        heights_lab_release(t);
    }
}

static leafcast *open_terrain(const char *path, uint32_t treelets) {
    const leafcast_options o = {
        .size = sizeof o, .threads = 2, .experiments = EXPERIMENTS(.treelet_limit = treelets)};
    leafcast *v = fixture_open(path, treelets ? &o : NULL);
    assert_int_equal(leafcast_select(v, &ground, 1), LEAFCAST_OK);
    return v;
}

/* ---- Hits ---- */

static void judge_shape(int shape, uint64_t of) {
    static leafcast_ray rays[RAYS];
    static leafcast_ray_hit hits[RAYS];
    field_random r = {of};
    heights_terrain t;
    heights_tally tally = {0};
    const leafcast_scene scene = leafcast_scene_default();
    bool through;
    heights_lab_make(&t, shape, of % 2 ? 20 : 70, of);
    /* With a single treelet in memory rays suspend and resume all the time. */
    leafcast *v =
        open_terrain(heights_lab_leaf(&t, 4, (uint32_t)(of % 2), of % 3 > 0), of % 2 ? 0 : 1);
    for (int i = 0; i < RAYS; i++)
        rays[i] = heights_lab_ray(&t, i % HEIGHTS_RAYS, &r, &through);
    assert_int_equal(leafcast_trace_rays(v, &scene, rays, RAYS, hits), LEAFCAST_OK);
    for (int i = 0; i < RAYS; i++)
        (void)heights_lab_judge_first(&t, &rays[i], &hits[i], &tally);
    for (int i = 0; i < RAYS / 4; i++) {
        const leafcast_ray one = heights_lab_ray(&t, i % HEIGHTS_RAYS, &r, &through);
        (void)heights_lab_judge(&t, v, &one, through, &tally);
    }
    if (heights_lab_faults(&tally))
        fail_msg("%s, terrain %d: missed %d, false %d, wrong %d, sides %d, order %d, leaks %d",
                 heights_lab_name(shape), (int)of, (int)tally.missed, (int)tally.false_hits,
                 (int)tally.wrong_t, (int)tally.wrong_side, (int)tally.wrong_order,
                 (int)tally.leaks);
    assert_true(tally.hits > RAYS / 8 && tally.grazing < tally.rays);
    leafcast_close(v);
    heights_lab_release(&t);
}

static void test_hits(void **state) {
    (void)state;
    for (int shape = 0; shape < HEIGHTS_SHAPES; shape++)
        for (uint64_t of = 1; of <= 4; of++)
            judge_shape(shape, of);
}

/* ---- The file ---- */

/* A second reader finds every height, to the bit. */
static void test_file(void **state) {
    (void)state;
    for (int shape = 0; shape < HEIGHTS_SHAPES; shape++)
        for (int coded = 0; coded < 2; coded++) {
            heights_terrain t;
            naive_leaf leaf;
            heights_lab_make(&t, shape, 50, FIELD_SEED);
            if (!naive_leaf_load(&leaf, heights_lab_leaf(&t, 4, 0, coded)))
                fail_msg("%s: %s", heights_lab_name(shape), leaf.why);
            assert_int_equal(leaf.dims[0], t.truth.nx);
            assert_int_equal(leaf.dims[1], 2);
            assert_int_equal(leaf.dims[2], t.truth.ny);
            for (int j = 0; j < t.truth.ny; j++)
                for (int i = 0; i < t.truth.nx; i++)
                    for (int side = 0; side < 2; side++) {
                        const float a = t.heights[i + t.truth.nx * j];
                        const float b = leaf.level[0].samples[i + t.truth.nx * (side + 2 * j)];
                        assert_true(a == b || (isnan(a) && isnan(b)));
                    }
            naive_leaf_release(&leaf);
            heights_lab_release(&t);
        }
}

/* ---- Points ---- */

/* The value and its slopes at a place, and how far a computed value may be off. */
typedef struct height_there {
    long double value, slope[2], error;
    float nearest;
    bool inside, on_line; /* of nodes, or all but on one: of two cells one decides */
} height_there;

static height_there height_there_at(const heights_truth *h, const double point[3]) {
    height_there out = {.inside = true};
    long double at[2];
    int cell[2];
    for (int a = 0; a < 2; a++) {
        const long double most = (a ? h->ny : h->nx) - 1;
        const long double x =
            ((long double)point[a] - (long double)h->origin[a]) / (long double)h->spacing[a];
        const long double slack =
            0x1p-46L * (1 + (fabsl((long double)point[a]) + fabsl((long double)h->origin[a])) /
                                fabsl((long double)h->spacing[a]));
        out.inside &= x >= -slack && x <= most + slack;
        out.on_line |= fabsl(x - roundl(x)) < slack;
        out.error = fmaxl(out.error, slack);
        cell[a] = (int)fmaxl(0, fminl(floorl(x), most - 1));
        at[a] = x - cell[a];
    }
    if (!out.inside)
        return out;
    const float *p = h->heights + cell[0] + h->nx * cell[1];
    const long double a = (long double)p[0], b = (long double)p[1], c = (long double)p[h->nx],
                      d = (long double)p[h->nx + 1];
    const long double size = fmaxl(fmaxl(fabsl(a), fabsl(b)), fmaxl(fabsl(c), fabsl(d)));
    out.value = (1 - at[1]) * ((1 - at[0]) * a + at[0] * b) + at[1] * ((1 - at[0]) * c + at[0] * d);
    out.nearest = p[(at[0] >= 0.5L) + h->nx * (at[1] >= 0.5L)];
    out.slope[0] = ((1 - at[1]) * (b - a) + at[1] * (d - c)) / (long double)h->spacing[0];
    out.slope[1] = ((1 - at[0]) * (c - a) + at[0] * (d - b)) / (long double)h->spacing[1];
    out.error *= 8 * size;
    return out;
}

/* A place on the lattice, beyond it, on a node, on a line; at any height. */
static void any_point(const heights_truth *h, field_random *r, double point[3]) {
    const long sort = field_random_below(r, 4);
    for (int a = 0; a < 2; a++) {
        const double most = (a ? h->ny : h->nx) - 1.0;
        double x = field_random_in(r, -0.05, 1.05) * most;
        if (sort == 1 || (sort == 2 && a == 0))
            x = (double)field_random_below(r, (long)most + 1);
        point[a] = h->origin[a] + x * h->spacing[a];
    }
    point[2] = field_random_in(r, -2.0, 2.0) * h->spacing[0];
}

/* Of any height, points have the elevation at their place. */
static void test_points(void **state) {
    (void)state;
    enum { POINTS = 4000 };
    for (int shape = 0; shape < HEIGHTS_SHAPES; shape++) {
        heights_terrain t;
        field_random r = {FIELD_SEED + (uint64_t)shape};
        int inside = 0, outside = 0, valued = 0;
        heights_lab_make(&t, shape, 50, FIELD_SEED);
        leafcast *v = fixture_open(heights_lab_leaf(&t, 4, 1, true), NULL);
        for (int i = 0; i < POINTS; i++) {
            double point[3];
            leafcast_sample got, one;
            any_point(&t.truth, &r, point);
            const height_there want = height_there_at(&t.truth, point);
            assert_int_equal(leafcast_sample_points(v, (const double(*)[3])point, 1, &got),
                             LEAFCAST_OK);
            assert_int_equal(leafcast_probe_point(v, point, &one), LEAFCAST_OK);
            assert_memory_equal(&one.value, &got.value, sizeof one.value);
            if (got.inside != want.inside)
                assert_true(want.on_line);
            inside += got.inside;
            outside += !got.inside;
            if (!got.inside || want.on_line)
                continue;
            assert_int_equal(isnan(got.value), isnan((double)want.value));
            assert_true(got.nearest == (double)want.nearest || isnan(want.nearest));
            if (isnan(got.value))
                continue;
            valued++;
            if (fabsl((long double)got.value - want.value) > want.error)
                fail_msg("%s: %.17g, not %.17Lg", heights_lab_name(shape), got.value, want.value);
            for (int a = 0; a < 2; a++)
                assert_true(fabsl((long double)got.gradient[a] - want.slope[a]) <=
                            want.error / fabsl((long double)t.truth.spacing[a]));
            assert_true(got.gradient[2] == 0.0);
        }
        assert_true(inside > POINTS / 2 && outside > POINTS / 50 && valued > POINTS / 8);
        leafcast_close(v);
        heights_lab_release(&t);
    }
}

/* ---- Pictures ---- */

static double height_at(const heights_truth *h, double x, double y) {
    const double u = (x - h->origin[0]) / h->spacing[0], v = (y - h->origin[1]) / h->spacing[1];
    const int i = (int)fmin(fmax(floor(u), 0.0), h->nx - 2.0);
    const int j = (int)fmin(fmax(floor(v), 0.0), h->ny - 2.0);
    const float *p = h->heights + i + h->nx * j;
    const double first = (double)p[0] + ((double)p[1] - (double)p[0]) * (u - i);
    const double last = (double)p[h->nx] + ((double)p[h->nx + 1] - (double)p[h->nx]) * (u - i);
    return (first + (last - first) * (v - j)) * h->scale;
}

/* Lit from the side, with shadows: whether each pixel of the terrain is lit, beside brute force. */
static void test_shadows(void **state) {
    (void)state;
    static picture p;
    static heights_meeting meetings[HEIGHTS_MEETINGS_MAX];
    const double to_light[3] = {0.8, 0.36, 0.48}, still[3] = {0.0, 0.0, 0.0};
    heights_terrain t;
    make_broad(&t, 0, 40);
    leafcast *v = open_terrain(heights_lab_leaf(&t, 4, 0, true), 0);
    leafcast_scene scene = leafcast_scene_default();
    scene.ambient = 0.0f;
    scene.shadows = true;
    scene.light_count = 1;
    scene.lights[0] = (leafcast_light){.rgb = {1, 1, 1}};
    memcpy(scene.lights[0].vector, to_light, sizeof to_light);
    const leafcast_camera c = leafcast_standard_view(v, 1.2, PICTURE_WIDTH, PICTURE_HEIGHT);
    pictures_draw(v, &scene, &c, &p, NULL);
    int seen = 0, dark = 0, wrong = 0, near = 0;
    for (uint32_t i = 0; i < PICTURE_PIXELS; i++) {
        double o[3], d[3], at[3], facing = 0.0, seen_by = 0.0;
        leafcast_pixel_ray(&c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        if (p.id[i] < 0)
            continue;
        for (int a = 0; a < 3; a++) {
            at[a] = o[a] + p.z[i] * d[a];
            facing += (double)p.normal[a][i] * to_light[a];
            seen_by += (double)p.normal[a][i] * d[a];
        }
        facing = seen_by > 0.0 ? -facing : facing; /* at the border one sees it from below */
        wrong += fabs(at[2] - height_at(&t.truth, at[0], at[1])) > 1e-6;
        const int count =
            heights_truth_meetings(&t.truth, at, to_light, still, 1e-6L, 1e9L, meetings);
        const bool lit = facing > 0.0 && count == 0;
        bool edge = fabs(facing) < 1e-2;
        for (int k = 0; k < 6 && facing > 0.0; k++) {
            double turned[3] = {to_light[0], to_light[1], to_light[2]};
            turned[k % 3] += k < 3 ? 1e-3 : -1e-3;
            edge = edge || (heights_truth_meetings(&t.truth, at, turned, still, 1e-6L, 1e9L,
                                                   meetings) > 0) != (count > 0);
        }
        near += edge;
        if (edge)
            continue;
        seen++;
        dark += !lit;
        wrong += (p.rgba[0][i] > 0.0f) != lit;
    }
    print_message("# %d pixels, %d dark, %d wrong, %d near an edge\n", seen, dark, wrong, near);
    assert_int_equal(wrong, 0);
    assert_true(seen > PICTURE_PIXELS / 5 && dark > seen / 30 && near < seen / 4);
    leafcast_close(v);
    heights_lab_release(&t);
}

/* The same bits whatever is resident, by all kernels, with and without transparency. */
static void test_pictures(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    for (int shape = 0; shape < HEIGHTS_SHAPES; shape++) {
        heights_terrain t;
        make_broad(&t, shape, 80);
        const char *path = heights_lab_leaf(&t, 4 + (uint32_t)shape % 3, 0, true);
        picture_volumes v = pictures_open(path, 2);
        pictures_open_one(&v, path, "scalar", 2);
        v.of[v.count - 1]->kernels.tile = heights_tile_wide;
        v.name[v.count - 1] = "wide";
        leafcast_surface shown = ground;
        int seen = 0;
        for (int view = 0; view < PICTURE_VIEWS; view++) {
            const leafcast_info info = leafcast_describe(v.of[0]);
            leafcast_scene scene = pictures_scene(view, &info);
            scene.analytic_normals = false;
            shown.opacity = view % 2 ? 0.4f : 1.0f;
            const leafcast_camera c = pictures_view(v.of[0], view, &r);
            pictures_select(&v, &shown, 1);
            seen += pictures_alike(&v, &scene, &c, heights_lab_name(shape));
        }
        assert_true(seen > PICTURE_PIXELS);
        pictures_close(&v);
        heights_lab_release(&t);
    }
}

/* Elevations so close together that codes of single precision end: seen from among them. */
static void test_least(void **state) {
    static const double ranges[] = {7e-36, 6e-37, 4e-38, 1e-44};
    (void)state;
    for (int k = 0; k < 4; k++) {
        heights_terrain t;
        make_broad(&t, 0, 41);
        t.truth.scale = 1.0;
        for (int a = 0; a < 2; a++) {
            t.truth.spacing[a] = 1.0;
            t.truth.origin[a] = 0.0;
        }
        for (int i = 0; i < t.truth.nx * t.truth.ny; i++)
            t.heights[i] = (float)(ranges[k] * (0.5 + 0.5 * sin(0.4 * i)));
        const char *path = heights_lab_leaf(&t, 4 + (uint32_t)k % 3, 0, true);
        picture_volumes v = pictures_open(path, 2);
        pictures_open_one(&v, path, "scalar", 2);
        v.of[v.count - 1]->kernels.tile = heights_tile_wide;
        v.name[v.count - 1] = "wide";
        leafcast_scene scene = leafcast_scene_default();
        leafcast_camera c = leafcast_standard_view(v.of[0], 1.4, PICTURE_WIDTH, PICTURE_HEIGHT);
        memcpy(c.eye, (const double[3]){20.3, 20.3, 1e-28}, sizeof c.eye);
        memcpy(c.look_at, (const double[3]){21.0, 21.1, -1.0}, sizeof c.look_at);
        memcpy(c.up, (const double[3]){0.0, 0.0, 1.0}, sizeof c.up);
        pictures_select(&v, &ground, 1);
        assert_int_equal(pictures_alike(&v, &scene, &c, "least"), PICTURE_PIXELS);
        pictures_close(&v);
        heights_lab_release(&t);
    }
}

/* In a scene with a grid: each pixel shows what is nearer. */
static void test_scene(void **state) {
    (void)state;
    static picture p, alone[2];
    heights_terrain t;
    field ball;
    make_broad(&t, 0, 30);
    assert_true(field_make(&ball, "sphere", 24, FIELD_SEED));
    for (int a = 0; a < 3; a++) { /* half sunk into the middle of the terrain */
        const double middle = a == 2 ? 0.0
                                     : t.truth.origin[a] + t.truth.spacing[a] *
                                                               ((a ? t.truth.ny : t.truth.nx) - 1) /
                                                               2.0;
        ball.spacing[a] = fabs(t.truth.spacing[0]) * t.truth.nx / 40.0;
        ball.origin[a] = middle - ball.spacing[a] * (double)(ball.dims[a] - 1) / 2.0;
    }
    leafcast_device *device = NULL;
    const leafcast_options d = {.size = sizeof d, .threads = 2};
    assert_int_equal(leafcast_device_create(&d, &device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = device};
    leafcast *v[2] = {fixture_open(heights_lab_leaf(&t, 4, 0, true), &o),
                      fixture_open(fixture_leaf(&ball, 4, 1, true), &o)};
    const leafcast_surface surfaces[2] = {ground, {ball.iso, {0.2f, 0.4f, 0.9f}, 1.0f, 0, 0}};
    leafcast_shown shown[2];
    for (int i = 0; i < 2; i++) {
        shown[i] = (leafcast_shown){.volume = v[i], .surfaces = &surfaces[i], .count = 1};
        assert_int_equal(leafcast_select(v[i], &surfaces[i], 1), LEAFCAST_OK);
    }
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera c = leafcast_standard_view(v[0], 1.4, PICTURE_WIDTH, PICTURE_HEIGHT);
    for (int i = 0; i < 2; i++)
        pictures_draw(v[i], &scene, &c, &alone[i], NULL);
    scene.volumes = shown;
    scene.volume_count = 2;
    pictures_draw(v[0], &scene, &c, &p, NULL);
    int of[2] = {0, 0};
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        const int near = alone[1].z[i] < alone[0].z[i];
        const bool any = alone[near].id[i] >= 0;
        assert_int_equal(p.id[i], any ? near : -1);
        assert_true(!any || p.z[i] == alone[near].z[i]);
        of[near] += any;
    }
    assert_true(of[0] > 50 && of[1] > 50);
    leafcast_close(v[0]);
    leafcast_close(v[1]);
    leafcast_device_destroy(device);
    field_release(&ball);
    heights_lab_release(&t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hits),     cmocka_unit_test(test_file),
        cmocka_unit_test(test_points),   cmocka_unit_test(test_shadows),
        cmocka_unit_test(test_pictures), cmocka_unit_test(test_least),
        cmocka_unit_test(test_scene),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
