/* test_adversarial.c - grids, isovalues and rays that tempt a ray tracer to err, each by its name,
 * against the reference: nothing missed, nothing false outside the grazing band. */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/fixture.h"
#include "tests/support/leaf_files.h"
#include "tests/support/ray_judge.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

enum { B = 16, CELLS_LOG2 = 4 };

/* ---- Volumes by formula ---- */

typedef double (*formula)(const long i[3], field_random *r);

static void make(field *f, const char *name, const char *type, const long dims[3], double iso,
                 formula at) {
    field_random r = {FIELD_SEED};
    *f = (field){.name = name, .type = type, .spacing = {1, 1, 1}, .iso = iso};
    memcpy(f->dims, dims, sizeof f->dims);
    f->samples = malloc((size_t)(dims[0] * dims[1] * dims[2]) * sizeof *f->samples);
    assert_non_null(f->samples);
    size_t n = 0;
    long i[3];
    for (i[2] = 0; i[2] < dims[2]; i[2]++)
        for (i[1] = 0; i[1] < dims[1]; i[1]++)
            for (i[0] = 0; i[0] < dims[0]; i[0]++)
                f->samples[n++] = (float)at(i, &r);
}

/* Axes whose coordinates, cell widths from 1/4 to 8, are exact in any arithmetic. */
static void stretch(field *f) {
    for (int a = 0; a < 3; a++) {
        f->axis[a] = malloc((size_t)f->dims[a] * sizeof *f->axis[a]);
        assert_non_null(f->axis[a]);
        double at = -3;
        for (long i = 0; i < f->dims[a]; i++) {
            f->axis[a][i] = at;
            at += ldexp(1, (int)((i * 5 + a) % 6) - 2);
        }
    }
}

static double noise(const long i[3], field_random *r) {
    (void)i;
    return (double)field_random_below(r, 256);
}

static double waves(const long i[3], field_random *r) {
    (void)r;
    return sin(0.4 * (double)i[0] + 0.1 * (double)i[1]) + sin(0.3 * (double)i[1]) +
           sin(0.35 * (double)i[2] + 1);
}

/* ---- Rays ---- */

static double node_coordinate(const ref_volume *v, int a, double node) {
    const long i = (long)floor(node);
    if (!v->axis[a])
        return node;
    if (i >= v->dims[a] - 1)
        return v->axis[a][v->dims[a] - 1];
    return v->axis[a][i] + (node - (double)i) * (v->axis[a][i + 1] - v->axis[a][i]);
}

/* The ray through a point given in nodes, from `back` times the direction (in coordinates) before
 * it. */
static ref_ray ray_through(const ref_volume *v, const double node[3], const double d[3],
                           double back) {
    ref_ray ray;
    for (int a = 0; a < 3; a++) {
        const double scale = v->to_world[a][a];
        ray.o[a] = scale * (node_coordinate(v, a, node[a]) - back * d[a]) + v->to_world[a][3];
        ray.d[a] = scale * d[a];
    }
    return ray;
}

/* Through whole and half nodes along axes, diagonals and others in small whole numbers. */
static ref_ray exact_ray(const ref_volume *v, field_random *r, double back) {
    double node[3], d[3] = {0, 0, 0};
    for (int a = 0; a < 3; a++)
        node[a] = 0.5 * (double)field_random_below(r, 2 * v->dims[a] - 1);
    while (d[0] == 0 && d[1] == 0 && d[2] == 0)
        for (int a = 0; a < 3; a++)
            d[a] = field_random_below(r, 3) ? (double)(field_random_below(r, 5) - 2) : 0;
    return ray_through(v, node, d, back);
}

static void random_direction(field_random *r, double d[3]) {
    do {
        for (int a = 0; a < 3; a++)
            d[a] = field_random_in(r, -1, 1);
    } while (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < 0.01);
}

/* ---- Judging ---- */

/* A field as an open treelet file. */
typedef struct trial {
    const field *f;
    ref_volume v;
    leafcast *volume;
    double iso;
    field_random random;
    ray_tally sum;
    char name[80];
} trial;

static void trial_select(trial *t, double iso) {
    const leafcast_surface surface = leafcast_surface_default(iso);
    assert_int_equal(leafcast_select(t->volume, &surface, 1), LEAFCAST_OK);
    t->iso = iso;
}

static trial trial_begin(const field *f, uint32_t halo) {
    trial t = {.f = f, .v = field_volume(f), .random = {FIELD_SEED}};
    const leafcast_options one = {.size = sizeof(leafcast_options), .threads = 1};
    const char *path = fixture_leaf(f, CELLS_LOG2, halo, false);
    snprintf(t.name, sizeof t.name, "%s %ldx%ldx%ld h %u", f->name, f->dims[0], f->dims[1],
             f->dims[2], halo);
    t.volume = fixture_open(path, &one);
    (void)unlink(path);
    trial_select(&t, f->iso);
    return t;
}

static void judge(trial *t, ref_ray ray) {
    ray_judge(&t->sum, t->volume, t->name, &t->v, ray, &t->iso, 1);
}

static void judge_rays(trial *t, int count) {
    for (int i = 0; i < count; i++) {
        judge(t, field_random_ray(&t->v, &t->random, 20));
        judge(t, field_random_ray(&t->v, &t->random, -0.4));
        judge(t, exact_ray(&t->v, &t->random, 64));
        judge(t, exact_ray(&t->v, &t->random, 0));
    }
}

static void tally_add(ray_tally *to, const ray_tally *from) {
    to->rays += from->rays;
    to->hits += from->hits;
    to->grazing += from->grazing;
    to->faults += from->faults;
    to->worst = fmax(to->worst, from->worst);
}

static void trial_end(trial *t, ray_tally *all) {
    leafcast_close(t->volume);
    tally_add(all, &t->sum);
}

/* What was judged, in numbers: a test that judged nothing has shown nothing. */
static void conclude(const char *what, const ray_tally *all, int least_hits) {
    print_message("# %s: %d rays, %d surfaces, worst %.2g cells, %d grazing, %d faults\n", what,
                  all->rays, all->hits, all->worst, all->grazing, all->faults);
    assert_int_equal(all->faults, 0);
    assert_true(all->rays - all->grazing > all->rays / 2);
    assert_true(all->hits >= least_hits);
}

/* Rays of all kinds through the field as it is, and stretched; with and without a halo. */
static void check_field(field *f, int rays, ray_tally *all) {
    for (uint32_t kind = 0; kind < 4; kind++) {
        if (kind == 2)
            stretch(f);
        trial t = trial_begin(f, kind & 1);
        judge_rays(&t, rays);
        trial_end(&t, all);
    }
    field_release(f);
}

/* ---- Grids ---- */

static void test_grid_sizes(void **state) {
    (void)state;
    const long sizes[] = {2, B, B + 1, 2 * B, 2 * B + 1};
    ray_tally all = {0};
    for (int mix = 0; mix < 125; mix += WATCHED ? 3 : 1) {
        const long dims[3] = {sizes[mix % 5], sizes[mix / 5 % 5], sizes[mix / 25]};
        field f;
        make(&f, "noise", "u8", dims, 128, noise);
        /* The stretched ones turn by turn: every mix is too many. */
        if (mix % 4 == 0)
            stretch(&f);
        trial t = trial_begin(&f, mix & 1);
        judge_rays(&t, 20);
        trial_end(&t, &all);
        field_release(&f);
    }
    conclude("grid sizes", &all, WATCHED ? 3000 : 10000);
}

static void test_one_sample_is_refused(void **state) {
    (void)state;
    const uint8_t samples[64] = {0};
    for (int mask = 1; mask < 8; mask++) {
        leaf_case c =
            leaf_files_case(mask & 1 ? 1 : 4, mask & 2 ? 1 : 4, mask & 4 ? 1 : 4, SAMPLE_U8);
        mem m;
        mem_init(&m, 0);
        c.samples = samples;
        const status st = leaf_files_try(&m, &c, "one.leaf", NULL, NULL);
        assert_true(st == ST_CORRUPT || st == ST_UNSUPPORTED || st == ST_USAGE);
        assert_non_null(strstr(status_text(), "at least 2"));
        assert_int_equal(access(scratch_path("one.leaf"), F_OK), -1);
        assert_int_equal(mem_used(&m), 0);
    }
}

static void test_negative_spacing(void **state) {
    (void)state;
    const long dims[3] = {B + 1, 2 * B, 2 * B + 3};
    ray_tally all = {0};
    for (int signs = 1; signs < 8; signs++) {
        field f;
        make(&f, "negative spacing", "f32", dims, 0.3, waves);
        const double size[3] = {1, 2, 0.5};
        for (int a = 0; a < 3; a++) {
            f.spacing[a] = signs >> a & 1 ? -size[a] : size[a];
            f.origin[a] = 7 - 9 * a;
        }
        trial t = trial_begin(&f, signs & 1);
        judge_rays(&t, 50);
        trial_end(&t, &all);
        field_release(&f);
    }
    conclude("negative spacing", &all, 1000);
}

/* ---- Isovalues ---- */

/* A hump with a plateau on top, in a bowl with a plateau below. */
static double hump(const long i[3], field_random *r) {
    (void)r;
    double at = 0;
    for (int a = 0; a < 3; a++)
        at += fabs((double)i[a] - B);
    return fmax(-40, fmin(90, 140 - 5 * at));
}

static void check_isovalues(const char *type, uint32_t halo, ray_tally some[4]) {
    const long dims[3] = {2 * B + 1, 2 * B + 2, 2 * B + 1};
    field f;
    make(&f, "hump", type, dims, 0, hump);
    trial t = trial_begin(&f, halo);
    const leafcast_info info = leafcast_describe(t.volume);
    assert_true(info.value_min == -40 && info.value_max == 90);
    const double isos[4][2] = {
        {-40, -41}, {nextafter(90, 91), 1e300}, {90, nextafter(90, 0)}, {nextafter(-40, 0), -39.5}};
    for (int k = 0; k < 8; k++) {
        t.sum = (ray_tally){0};
        trial_select(&t, isos[k / 2][k % 2]);
        judge_rays(&t, 40);
        tally_add(&some[k / 2], &t.sum);
    }
    leafcast_close(t.volume);
    field_release(&f);
}

static void test_isovalue_at_and_outside_the_range(void **state) {
    (void)state;
    ray_tally some[4] = {{0}};
    for (uint32_t k = 0; k < 4; k++)
        check_isovalues(k < 2 ? "i16" : "f32", k & 1, some);
    conclude("at and below the minimum", &some[0], 0);
    conclude("above the maximum", &some[1], 0);
    conclude("at the maximum", &some[2], 100);
    conclude("above the minimum", &some[3], 100);
    assert_int_equal(some[0].hits, 0);
    assert_int_equal(some[1].hits, 0);
}

static uint64_t loads_of_picture(trial *t) {
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera camera = leafcast_standard_view(t->volume, 1.1, 32, 32);
    const leafcast_image none = {.size = sizeof(leafcast_image)};
    leafcast_stats stats = {.size = sizeof stats};
    assert_int_equal(leafcast_trace(t->volume, &scene, &camera, &none, &stats, NULL, NULL),
                     LEAFCAST_OK);
    return stats.treelets_loaded;
}

static void test_isovalue_that_nothing_contains_loads_nothing(void **state) {
    (void)state;
    const long dims[3] = {2 * B + 1, 2 * B + 1, 2 * B + 1};
    field f;
    make(&f, "hump", "f32", dims, -40, hump);
    trial t = trial_begin(&f, 1);
    const double isos[] = {-40, -1e30, 91, 1e300, -1e300};
    for (size_t i = 0; i < sizeof isos / sizeof *isos; i++) {
        trial_select(&t, isos[i]);
        assert_int_equal(loads_of_picture(&t), 0);
    }
    trial_select(&t, 90);
    assert_true(loads_of_picture(&t) > 0);
    leafcast_close(t.volume);
    field_release(&f);
}

/* A refused selection leaves the one before it as it was. */
static void test_isovalue_nan_and_inf_are_refused(void **state) {
    (void)state;
    const long dims[3] = {B + 2, B + 2, B + 2};
    const double bad[] = {NAN, INFINITY, -INFINITY};
    field f;
    ray_tally all = {0};
    make(&f, "waves", "f32", dims, 0.3, waves);
    trial t = trial_begin(&f, 1);
    for (int i = 0; i < 3; i++) {
        leafcast_surface two[2] = {leafcast_surface_default(-0.5),
                                   leafcast_surface_default(bad[i])};
        (void)status_describe(ST_OK, "%s", "");
        assert_int_equal(leafcast_select(t.volume, two, 2), LEAFCAST_USAGE);
        assert_non_null(strstr(leafcast_error_text(), "isovalue"));
        assert_int_equal(leafcast_select(t.volume, two + 1, 1), LEAFCAST_USAGE);
        assert_int_equal(leafcast_select(t.volume, two, 0), LEAFCAST_USAGE);
        judge_rays(&t, 20);
    }
    trial_end(&t, &all);
    conclude("after refused isovalues", &all, 50);
    field_release(&f);
}

/* ---- Where the eye is ---- */

/* Blocks at, above and below the isovalue 100, across the borders of treelets. */
static double plateaus(const long i[3], field_random *r) {
    if (i[0] >= 12 && i[0] <= 20 && i[1] >= 12 && i[1] <= 20 && i[2] >= 12 && i[2] <= 20)
        return 100;
    return 70 + (double)field_random_below(r, 4) * 20;
}

static void judge_picture(trial *t, const double eye[3], const double look_at[3], double fov,
                          ref_tally *sum) {
    enum { SIDE = 12 };
    double z[SIDE * SIDE];
    leafcast_camera camera = {.size = sizeof(leafcast_camera),
                              .fov = fov,
                              .width = SIDE,
                              .height = SIDE,
                              .up = {0.1, 0.2, 1}};
    ref_camera same = {.fov = fov, .width = SIDE, .height = SIDE, .up = {0.1, 0.2, 1}};
    for (int a = 0; a < 3; a++) {
        camera.eye[a] = same.eye[a] = eye[a];
        camera.look_at[a] = same.look_at[a] = look_at[a];
    }
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof(leafcast_image), .z = z};
    assert_int_equal(leafcast_trace(t->volume, &scene, &camera, &image, NULL, NULL, NULL),
                     LEAFCAST_OK);
    ref_compare(sum, &t->v, &same, &t->iso, 1, NULL, z, 1, t->name, stderr);
}

/* All that is seen from a place given in nodes: by rays along axes, diagonals and at random, and in
 * pictures. */
static void look_around(trial *t, const double node[3], ref_tally *pixels) {
    double eye[3];
    for (int k = 0; k < 27; k++) {
        const double d[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        if (k == 13)
            continue;
        judge(t, ray_through(&t->v, node, d, 0));
        judge(t, ray_through(&t->v, node, (const double[3]){2 * d[0], d[1], 3 * d[2]}, 0));
    }
    for (int k = 0; k < 20; k++) {
        double d[3];
        random_direction(&t->random, d);
        judge(t, ray_through(&t->v, node, d, 0));
    }
    for (int a = 0; a < 3; a++)
        eye[a] = t->v.to_world[a][a] * node_coordinate(&t->v, a, node[a]) + t->v.to_world[a][3];
    for (int k = 0; k < 8; k++) {
        const double to[3] = {eye[0] + (k & 1 ? 1 : -1), eye[1] + (k & 2 ? 1 : -1),
                              eye[2] + (k & 4 ? 1 : -1)};
        judge_picture(t, eye, to, 70, pixels);
    }
}

static void check_eyes(const char *what, const double (*eyes)[3], int count, int least) {
    const long dims[3] = {2 * B + 1, 2 * B + 1, 2 * B + 1};
    ray_tally all = {0};
    ref_tally pixels = {0};
    for (uint32_t kind = 0; kind < 6; kind++) {
        field f;
        make(&f, what, kind < 3 ? "u8" : "f32", dims, kind < 3 ? 100 : 0.3,
             kind < 3 ? plateaus : waves);
        if (kind % 3 == 2)
            stretch(&f);
        trial t = trial_begin(&f, kind & 1);
        for (int i = 0; i < count; i++)
            look_around(&t, eyes[i], &pixels);
        trial_end(&t, &all);
        field_release(&f);
    }
    conclude(what, &all, least);
    print_message("# %s: %d pixels, %d surfaces, %d missed, %d false, %d too far, %d grazing\n",
                  what, (int)pixels.rays, (int)pixels.hits, (int)pixels.missed,
                  (int)pixels.false_hits, (int)pixels.too_far, (int)pixels.grazing);
    assert_int_equal(ref_tally_faults(&pixels), 0);
    assert_true(pixels.hits > pixels.rays / 4);
}

static void test_eye_on_a_voxel(void **state) {
    (void)state;
    const double eyes[][3] = {{5, 7, 9}, {16, 16, 16}, {16, 3, 32}, {0, 0, 0}, {32, 32, 32}};
    check_eyes("eye on a voxel", eyes, 5, 500);
}

static void test_eye_on_a_face(void **state) {
    (void)state;
    const double eyes[][3] = {{5, 7.5, 9.25}, {4.5, 16, 8.125}, {20.5, 30.25, 32}, {0, 7.5, 3.5}};
    check_eyes("eye on a face", eyes, 4, 500);
}

static void test_eye_on_an_edge(void **state) {
    (void)state;
    const double eyes[][3] = {{5, 7, 9.25}, {16, 8.5, 16}, {32, 32, 17.5}, {0.5, 0, 32}};
    check_eyes("eye on an edge", eyes, 4, 500);
}

static void test_eye_inside_a_plateau(void **state) {
    (void)state;
    const double eyes[][3] = {{14.3, 15.1, 13.7}, {16, 16, 16}, {12, 14.5, 18}, {20, 20, 20}};
    check_eyes("eye inside a plateau", eyes, 4, 500);
}

static void test_eye_inside_the_volume(void **state) {
    (void)state;
    const double eyes[][3] = {{3.3, 29.1, 11.7}, {25.9, 16.01, 2.2}, {31.99, 31.99, 0.01}};
    check_eyes("eye inside the volume", eyes, 3, 500);
}

static void test_eye_a_million_cells_away(void **state) {
    (void)state;
    const long dims[3] = {2 * B + 1, 2 * B + 1, 2 * B + 1};
    const double centre[3] = {16, 16, 16};
    field f;
    ray_tally all = {0};
    ref_tally pixels = {0};
    make(&f, "far away", "f32", dims, 0.3, waves);
    trial t = trial_begin(&f, 1);
    for (int i = 0; i < 200; i++) {
        double d[3], node[3];
        random_direction(&t.random, d);
        for (int a = 0; a < 3; a++)
            node[a] = field_random_in(&t.random, 0, 32);
        judge(&t, ray_through(&t.v, node, d, 1e6));
        judge(&t, exact_ray(&t.v, &t.random, 1 << 20));
    }
    for (int k = 0; k < 8; k++) {
        const double eye[3] = {k & 1 ? 1e6 : -1e6, k & 2 ? 5e5 : -5e5, k & 4 ? 7e5 : -7e5};
        judge_picture(&t, eye, centre, 0.0015, &pixels);
    }
    trial_end(&t, &all);
    conclude("far away", &all, 500);
    assert_int_equal(ref_tally_faults(&pixels), 0);
    assert_true(pixels.hits > pixels.rays / 4);
    field_release(&f);
}

/* ---- Rays in planes ---- */

static void judge_planes(trial *t) {
    const double planes[] = {0, 1, B - 1, B, B + 1, 2 * B - 1, 2 * B};
    for (int axis = 0; axis < 3; axis++)
        for (size_t i = 0; i < sizeof planes / sizeof *planes; i++)
            for (int k = 0; k < (WATCHED ? 4 : 12); k++) {
                double node[3], d[3];
                random_direction(&t->random, d);
                for (int a = 0; a < 3; a++)
                    node[a] = field_random_in(&t->random, 0, 2 * B);
                node[axis] = planes[i];
                d[axis] = 0;
                judge(t, ray_through(&t->v, node, d, k % 2 ? 50 : 0));
                /* In two planes at once: along an edge. */
                const int other = (axis + 1) % 3;
                node[other] = planes[field_random_below(&t->random, 7)];
                d[other] = 0;
                d[(axis + 2) % 3] = k % 4 < 2 ? 1 : -1;
                judge(t, ray_through(&t->v, node, d, k % 2 ? 50 : 0));
            }
}

static void test_rays_in_grid_planes(void **state) {
    (void)state;
    const long dims[3] = {2 * B + 1, 2 * B + 1, 2 * B + 1};
    const formula formulas[] = {noise, plateaus, waves};
    ray_tally all = {0};
    for (int k = 0; k < 12; k++) {
        field f;
        make(&f, "in grid planes", k % 3 < 2 ? "u8" : "f32", dims, k % 3 < 2 ? 100 : 0.3,
             formulas[k % 3]);
        if (k >= 6)
            stretch(&f);
        trial t = trial_begin(&f, k & 1);
        judge_planes(&t);
        trial_end(&t, &all);
        field_release(&f);
    }
    conclude("rays in grid planes", &all, 5000);
}

/* ---- Treelets that meet at an edge ---- */

/* Eight treelets around node (16, 16, 16), one of them alone with a surface. */
static int lone;          /* which: an octant */
static bool lone_is_high; /* its inside above the isovalue 100, or below */
static bool with_missing; /* the opposite one without data */

static bool within(const long i[3], int octant) {
    for (int a = 0; a < 3; a++)
        if (octant >> a & 1 ? i[a] <= B : i[a] >= B)
            return false;
    return true;
}

/* Its surface reaches the borders: they are at the isovalue, or next to it. */
static double lone_treelet(const long i[3], field_random *r) {
    if (with_missing && within(i, 7 - lone))
        return (double)NAN;
    if (within(i, lone))
        return lone_is_high ? 150 + (double)field_random_below(r, 50)
                            : 50 + (double)field_random_below(r, 50);
    return lone_is_high ? 99 : 100 + (double)field_random_below(r, 2) * 30;
}

static void judge_edges(trial *t) {
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 60; k++) {
            double node[3] = {B, B, B}, d[3];
            node[axis] = k % 3 == 0 ? B : 0.5 * (double)field_random_below(&t->random, 4 * B + 1);
            random_direction(&t->random, d);
            if (k % 4 > 0)
                for (int a = 0; a < 3; a++)
                    d[a] = (double)field_random_below(&t->random, 3) - 1;
            if (d[0] == 0 && d[1] == 0 && d[2] == 0)
                d[axis] = 1;
            judge(t, ray_through(&t->v, node, d, k % 2 ? 40 : 0));
        }
}

static void test_treelets_meeting_at_an_edge_with_one_active(void **state) {
    (void)state;
    const long dims[3] = {2 * B + 1, 2 * B + 1, 2 * B + 1};
    ray_tally all = {0};
    for (int k = 0; k < 32; k++) {
        field f;
        lone = k & 7;
        lone_is_high = k >> 3 & 1;
        with_missing = k >> 4 & 1;
        make(&f, "one active treelet", "f32", dims, 100, lone_treelet);
        if (k % 5 == 0)
            stretch(&f);
        trial t = trial_begin(&f, k & 1);
        judge_edges(&t);
        judge_rays(&t, 10);
        /* Next to missing data there is no surface, so elsewhere it is the only one. */
        assert_int_equal(loads_of_picture(&t), 1);
        trial_end(&t, &all);
        field_release(&f);
    }
    conclude("one active treelet", &all, 1000);
}

/* ---- Missing data ---- */

static double missing_at_borders(const long i[3], field_random *r) {
    bool border = false;
    for (int a = 0; a < 3; a++)
        border = border || (i[a] >= B - 1 && i[a] <= B + 1) || i[a] == 0 || i[a] == 2 * B;
    if (field_random_below(r, border ? 12 : 400) == 0)
        return field_random_below(r, 3) ? (double)NAN : (double)INFINITY;
    return noise(i, r);
}

static double missing_treelet(const long i[3], field_random *r) {
    return i[0] <= B && i[1] >= B && i[2] <= B ? (double)NAN : waves(i, r);
}

static double missing_voxel(const long i[3], field_random *r) {
    return i[0] == B && i[1] == B && i[2] == B ? (double)NAN : noise(i, r);
}

static double missing_all(const long i[3], field_random *r) {
    (void)i, (void)r;
    return (double)NAN;
}

static void test_nan_voxels(void **state) {
    (void)state;
    const long dims[3] = {2 * B + 1, 2 * B + 1, 2 * B + 1};
    ray_tally all = {0};
    field f;
    make(&f, "NaN at treelet borders", "f32", dims, 100, missing_at_borders);
    check_field(&f, 100, &all);
    make(&f, "a NaN at a treelet's corner", "f32", dims, 100, missing_voxel);
    trial t = trial_begin(&f, 1);
    judge_edges(&t);
    trial_end(&t, &all);
    field_release(&f);
    conclude("NaN voxels", &all, 5000);
}

static void test_nan_treelet(void **state) {
    (void)state;
    const long dims[3] = {2 * B + 1, 2 * B + 1, 2 * B + 1};
    ray_tally all = {0};
    field f;
    make(&f, "a treelet of NaN", "f32", dims, 0.3, missing_treelet);
    check_field(&f, 100, &all);
    conclude("NaN treelet", &all, 1000);
}

static void test_nan_volume(void **state) {
    (void)state;
    const long sizes[2][3] = {{2 * B + 1, B, 3}, {2, 2, 2}};
    ray_tally all = {0};
    for (int k = 0; k < 2; k++) {
        field f;
        make(&f, "NaN alone", "f32", sizes[k], 0, missing_all);
        trial t = trial_begin(&f, 1);
        assert_int_equal(loads_of_picture(&t), 0);
        leafcast_sample sample;
        assert_int_equal(leafcast_probe_point(t.volume, (const double[3]){1, 1, 1}, &sample),
                         LEAFCAST_OK);
        assert_true(sample.inside && isnan(sample.value));
        trial_end(&t, &all);
        field_release(&f);
        make(&f, "NaN alone", "f32", sizes[k], 0, missing_all);
        check_field(&f, 20, &all);
    }
    conclude("NaN volume", &all, 0);
    assert_int_equal(all.hits, 0);
}

static double seven(const long i[3], field_random *r) {
    (void)i, (void)r;
    return 7;
}

static void test_constant_volume(void **state) {
    (void)state;
    const long dims[3] = {2 * B + 1, B + 1, B};
    const double isos[] = {7, 6.5, 7.5, nextafter(7, 0), nextafter(7, 8)};
    ray_tally all = {0};
    for (uint32_t k = 0; k < 4; k++) {
        field f;
        make(&f, "constant", k < 2 ? "u8" : "f32", dims, 7, seven);
        trial t = trial_begin(&f, k & 1);
        for (int i = 0; i < 5; i++) {
            trial_select(&t, isos[i]);
            judge_rays(&t, 10);
            assert_int_equal(loads_of_picture(&t), 0);
        }
        trial_end(&t, &all);
        field_release(&f);
    }
    conclude("constant volume", &all, 0);
    assert_int_equal(all.hits, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid_sizes),
        cmocka_unit_test(test_one_sample_is_refused),
        cmocka_unit_test(test_negative_spacing),
        cmocka_unit_test(test_isovalue_at_and_outside_the_range),
        cmocka_unit_test(test_isovalue_that_nothing_contains_loads_nothing),
        cmocka_unit_test(test_isovalue_nan_and_inf_are_refused),
        cmocka_unit_test(test_eye_on_a_voxel),
        cmocka_unit_test(test_eye_on_a_face),
        cmocka_unit_test(test_eye_on_an_edge),
        cmocka_unit_test(test_eye_inside_a_plateau),
        cmocka_unit_test(test_eye_inside_the_volume),
        cmocka_unit_test(test_eye_a_million_cells_away),
        cmocka_unit_test(test_rays_in_grid_planes),
        cmocka_unit_test(test_treelets_meeting_at_an_edge_with_one_active),
        cmocka_unit_test(test_nan_voxels),
        cmocka_unit_test(test_nan_treelet),
        cmocka_unit_test(test_nan_volume),
        cmocka_unit_test(test_constant_volume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
