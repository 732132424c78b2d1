/* test_medium_shade.c - shaded media: pictures of grids beside a brute-force reference that goes
 * through each cell in fine steps, of a mesh beside a closed form; the same bits however they are
 * drawn; and what they say of their error.
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

#include "formats/base/cpu.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"
#include "tests/support/ref_media.h"
#include "tests/support/watched.h"

typedef long double real;

enum { SIDE = 12, PIXELS = SIDE * SIDE, STEPS = 64, PIECES = 4096, POINTS = 4 };

typedef struct planes {
    double rgba[PIXELS][4], error[PIXELS];
    leafcast_stats stats;
} planes;

static leafcast_status draw(leafcast *v, const leafcast_scene *scene, const leafcast_camera *view,
                            planes *p) {
    leafcast_image image = {.size = sizeof image, .rgba = p->rgba[0], .error = p->error};
    p->stats.size = sizeof p->stats;
    return leafcast_trace(v, scene, view, &image, &p->stats, NULL, NULL);
}

/* ---- What is drawn ---- */

/* A volume of these values filled so that most of what is on a ray is seen. */
typedef struct filling {
    leafcast_transfer_point points[POINTS];
    leafcast_medium medium;
    double range[2];
} filling;

static void fill(filling *fill, const leafcast *v) {
    static const double rgb[POINTS][3] = {{1, 1, 1}, {0.9, 0.5, 0.2}, {0.2, 0.6, 1}, {1, 1, 0}};
    static const double extinction[POINTS] = {0.0, 0.6, 1.5, 3.0};
    const leafcast_info info = leafcast_describe(v);
    double across = INFINITY;
    for (int a = 0; a < 3; a++)
        across = fmin(across, info.bounds[1][a] - info.bounds[0][a]);
    assert_int_equal(leafcast_range(v, 0, 0, fill->range), LEAFCAST_OK);
    for (int i = 0; i < POINTS; i++) {
        leafcast_transfer_point *p = &fill->points[i];
        p->value = fill->range[0] + (fill->range[1] - fill->range[0]) * (0.2 + 0.2 * i);
        p->extinction = extinction[i] / across;
        memcpy(p->rgb, rgb[i], sizeof p->rgb);
    }
    fill->medium = (leafcast_medium){fill->points, POINTS};
}

/* 0: a light at the eye; 1: two others, one of them a point; odd: analytic normals. */
static leafcast_scene scene_of(const leafcast *v, const filling *fill, int kind) {
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_info info = leafcast_describe(v);
    scene.media = &fill->medium;
    scene.media_count = 1;
    scene.shade_media = true;
    scene.analytic_normals = kind % 2 == 1;
    scene.smooth_normals = false;
    if (kind < 2)
        return scene;
    scene.shade_fade = 1.0 / 8.0;
    scene.ambient = 0.25F;
    scene.light_count = 2;
    scene.lights[0] = (leafcast_light){false, {1.0, 2.0, -0.5}, {0.7F, 0.8F, 0.9F}, 0};
    scene.lights[1] = (leafcast_light){true, {0}, {0.4F, 0.1F, 0.2F}, 0};
    for (int a = 0; a < 3; a++)
        scene.lights[1].vector[a] = 2.0 * info.bounds[1][a] - info.bounds[0][a];
    return scene;
}

static leafcast_camera view_of(const leafcast *v, int kind) {
    field_random r = {(uint64_t)kind + 1};
    leafcast_camera view = pictures_view(v, kind, &r);
    view.width = view.height = SIDE;
    return view;
}

/* ---- The reference ---- */

/* A gradient of the volume at a point of node coordinates, in a cell. */
typedef struct ref_grid {
    ref_volume volume;
    bool analytic;
} ref_grid;

static real node_at(const ref_volume *v, int a, long i) {
    return v->axis[a] ? (real)v->axis[a][i] : (real)i;
}

static real sample_at(const ref_volume *v, const long i[3]) {
    return (real)v->samples[i[0] + v->dims[0] * (i[1] + v->dims[1] * i[2])];
}

/* Between two nodes along an axis. */
static real slope_of(const ref_volume *v, const long node[3], int a, long from, long to) {
    long low[3] = {node[0], node[1], node[2]}, high[3] = {node[0], node[1], node[2]};
    low[a] = from;
    high[a] = to;
    return (sample_at(v, high) - sample_at(v, low)) / (node_at(v, a, to) - node_at(v, a, from));
}

static real slope_at_corner(const ref_grid *g, const long cell[3], const long node[3], int a,
                            bool own) {
    const ref_volume *v = &g->volume;
    if (own)
        return slope_of(v, node, a, cell[a], cell[a] + 1);
    return slope_of(v, node, a, node[a] > 0 ? node[a] - 1 : 0,
                    node[a] + 1 < v->dims[a] ? node[a] + 1 : node[a]);
}

static void gradient_by(const ref_grid *g, const long cell[3], const real at[3], bool own,
                        real out[3]) {
    out[0] = out[1] = out[2] = 0;
    for (int corner = 0; corner < 8; corner++) {
        long node[3];
        real weight = 1;
        for (int a = 0; a < 3; a++) {
            node[a] = cell[a] + (corner >> a & 1);
            weight *= corner >> a & 1 ? at[a] : 1 - at[a];
        }
        for (int a = 0; a < 3; a++)
            out[a] += weight * slope_at_corner(g, cell, node, a, own);
    }
}

/* World space; to_world is diagonal. */
static void gradient_at(const ref_grid *g, uint64_t index, const real p[3], real out[3]) {
    const ref_volume *v = &g->volume;
    const uint64_t nx = (uint64_t)v->dims[0] - 1, ny = (uint64_t)v->dims[1] - 1;
    const long cell[3] = {(long)(index % nx), (long)(index / nx % ny), (long)(index / nx / ny)};
    real at[3];
    for (int a = 0; a < 3; a++) {
        const real lo = node_at(v, a, cell[a]), hi = node_at(v, a, cell[a] + 1);
        at[a] = (p[a] - lo) / (hi - lo);
    }
    gradient_by(g, cell, at, g->analytic, out);
    if (!isfinite((double)(out[0] + out[1] + out[2])))
        gradient_by(g, cell, at, true, out);
    for (int a = 0; a < 3; a++)
        out[a] /= v->to_world[a][a];
}

/* The formula of medium_shade.h. */
static void lighting_of(const leafcast_scene *scene, double steepness, const ref_ray *ray, real t,
                        const real gradient[3], real light[3]) {
    real length = 0, along = 0, x, share;
    for (int a = 0; a < 3; a++) {
        length += gradient[a] * gradient[a];
        along += gradient[a] * ray->d[a];
    }
    length = sqrtl(length);
    light[0] = light[1] = light[2] = 1;
    if (!(length > 0))
        return;
    x = fminl(1, steepness * length);
    share = x * x * (3 - 2 * x);
    for (int c = 0; c < 3; c++) {
        real sum = scene->light_count == 0 ? fabsl(along) / length : 0;
        for (int i = 0; i < scene->light_count; i++) {
            const leafcast_light *l = &scene->lights[i];
            real cosine = 0, distance = 0;
            for (int a = 0; a < 3; a++) {
                const real to =
                    l->point ? (real)l->vector[a] - (ray->o[a] + t * ray->d[a]) : l->vector[a];
                cosine += (along > 0 ? -1 : 1) * gradient[a] / length * to;
                distance += to * to;
            }
            sum += fmaxl(cosine / sqrtl(distance), 0) * (real)l->rgb[c];
        }
        light[c] = 1 + share * (scene->ambient + (1 - (real)scene->ambient) * sum - 1);
    }
}

/* In STEPS steps a cell. */
static void integrate(const ref_grid *g, const leafcast_scene *scene, double steepness,
                      const ref_ray *ray, real rgb[3], real *through) {
    static ref_piece pieces[PIECES];
    const size_t count = ref_grid_pieces(&g->volume, ray, NULL, pieces, PIECES);
    real o[3], d[3];
    ref_to_grid(&g->volume, ray, o, d);
    rgb[0] = rgb[1] = rgb[2] = 0;
    *through = 1;
    for (size_t i = 0; i < count; i++) {
        const real h = (pieces[i].t1 - pieces[i].t0) / STEPS;
        for (int n = 0; n < STEPS; n++) {
            const real x = (n + 0.5L) * h, t = pieces[i].t0 + x;
            const real p[3] = {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
            real gradient[3], light[3], colour[3], k;
            ref_transfer(scene->media->points, scene->media->count, ref_piece_at(pieces[i].k, x),
                         colour, &k);
            gradient_at(g, pieces[i].cell, p, gradient);
            lighting_of(scene, steepness, ray, t, gradient, light);
            const real seen = *through * (1 - expl(-k * h));
            for (int c = 0; c < 3; c++)
                rgb[c] += seen * colour[c] * light[c];
            *through -= seen;
        }
    }
}

/* ---- Grids ---- */

typedef struct tally {
    int judged, changed; /* changed: by shading, by a lot */
    double worst, sum;
} tally;

static void judge(const ref_grid *g, leafcast *v, const leafcast_scene *scene, int kind, tally *t) {
    static planes shaded, plain;
    const leafcast_camera view = view_of(v, kind);
    leafcast_scene unshaded = *scene;
    double range[2];
    const double fade = scene->shade_fade > 0.0 ? scene->shade_fade : 1.0 / 32.0;
    unshaded.shade_media = false;
    assert_int_equal(leafcast_range(v, 0, 0, range), LEAFCAST_OK);
    const double steepness = leafcast_describe(v).cell_size / (fade * (range[1] - range[0]));
    assert_int_equal(draw(v, scene, &view, &shaded), LEAFCAST_OK);
    assert_int_equal(draw(v, &unshaded, &view, &plain), LEAFCAST_OK);
    for (int i = 0; i < PIXELS; i++) {
        ref_ray ray;
        real rgb[3], through;
        double far = 0.0, change = 0.0;
        leafcast_pixel_ray(&view, i % SIDE + 0.5, i / SIDE + 0.5, ray.o, ray.d);
        integrate(g, scene, steepness, &ray, rgb, &through);
        for (int c = 0; c < 3; c++) {
            far = fmax(far, fabs(shaded.rgba[i][c] - (double)rgb[c]));
            change = fmax(change, fabs(shaded.rgba[i][c] - plain.rgba[i][c]));
        }
        assert_true(fabs(shaded.rgba[i][3] - (double)(1 - through)) < 0.004);
        t->judged++;
        t->changed += change > 0.05;
        t->worst = fmax(t->worst, far);
        t->sum += far;
    }
}

/* A channel may be off by so much, and by that on average: a step of 8 bits, and an eighth. */
#define FAR_AT_MOST (1.0 / 255.0)
#define FAR_ON_MEAN (1.0 / 2040.0)

static void judge_field(const char *name) {
    field f;
    tally t = {0};
    assert_true(field_make(&f, name, 20, 3));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    ref_grid g = {.volume = field_volume(&f)};
    filling fill_of;
    fill(&fill_of, v);
    for (int kind = 0; kind < 4; kind++) {
        const leafcast_scene scene = scene_of(v, &fill_of, kind);
        g.analytic = scene.analytic_normals;
        judge(&g, v, &scene, kind, &t);
    }
    print_message("%s: %d pixels, %d changed, off by %.4f at most, %.5f on average\n", name,
                  t.judged, t.changed, t.worst, t.sum / t.judged);
    assert_true(t.worst <= FAR_AT_MOST);
    assert_true(t.sum / t.judged <= FAR_ON_MEAN);
    assert_true(t.changed > t.judged / 8);
    leafcast_close(v);
    field_release(&f);
}

static void test_grids_are_as_by_brute_force(void **state) {
    static const char *const names[] = {"sphere",   "sphere-u8",   "waves",      "noise-i16",
                                        "mirrored", "rectilinear", "flat-cells", "missing"};
    (void)state;
    skip_under_thread();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        judge_field(names[i]);
}

/* ---- A sphere whose value is the distance from its middle ---- */

enum { BALL = 48 };

static void test_sphere_is_as_by_formula(void **state) {
    static float samples[BALL * BALL * BALL];
    static planes p;
    const double middle = (BALL - 1) / 2.0;
    (void)state;
    skip_under_thread();
    field f = {.name = "ball",
               .type = "f32",
               .dims = {BALL, BALL, BALL},
               .samples = samples,
               .spacing = {1, 1, 1}};
    for (int z = 0; z < BALL; z++)
        for (int y = 0; y < BALL; y++)
            for (int x = 0; x < BALL; x++)
                samples[x + BALL * (y + BALL * z)] =
                    (float)sqrt((x - middle) * (x - middle) + (y - middle) * (y - middle) +
                                (z - middle) * (z - middle));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    /* White, and as good as a surface at a distance of 16. */
    const leafcast_transfer_point points[2] = {{16.0, {1, 1, 1}, 60.0}, {16.1, {1, 1, 1}, 0.0}};
    const leafcast_medium medium = {points, 2};
    leafcast_scene scene = leafcast_scene_default();
    scene.media = &medium;
    scene.media_count = 1;
    scene.shade_media = true;
    scene.shade_fade = 1.0 / 64.0;
    scene.ambient = 0.2F;
    scene.light_count = 1;
    scene.lights[0] = (leafcast_light){false, {0.0, 3.0, 4.0}, {1, 0.5F, 0.25F}, 0};
    const leafcast_camera view = {.size = sizeof view,
                                  .eye = {middle, middle, 200.0},
                                  .look_at = {middle, middle, middle},
                                  .up = {0, 1, 0},
                                  .width = SIDE,
                                  .height = SIDE,
                                  .ortho_height = 24.0};
    assert_int_equal(draw(v, &scene, &view, &p), LEAFCAST_OK);
    for (int i = 0; i < PIXELS; i++) {
        const double x = (i % SIDE + 0.5) * 24.0 / SIDE - 12.0,
                     y = 12.0 - (i / SIDE + 0.5) * 24.0 / SIDE, square = x * x + y * y;
        if (square > 14.0 * 14.0)
            continue;
        const double n_l = (0.6 * y + 0.8 * sqrt(256.0 - square)) / 16.0;
        for (int c = 0; c < 3; c++) {
            const double light = 0.2 + 0.8 * fmax(n_l, 0.0) * (double)scene.lights[0].rgb[c];
            assert_true(fabs(p.rgba[i][c] - light) < 0.02);
        }
    }
    leafcast_close(v);
}

/* ---- A mesh of a linear field: one lighting everywhere ---- */

static double linear(const double p[3]) {
    return 2.0 * p[0] - p[1] + 2.0 * p[2];
}

static void check_mesh(leafcast *v, const leafcast_scene *scene, const filling *fill_of) {
    static planes shaded, plain;
    static const real gradient[3] = {2, -1, 2};
    leafcast_scene unshaded = *scene;
    const double fade = scene->shade_fade > 0.0 ? scene->shade_fade : 1.0 / 32.0;
    const double steepness =
        leafcast_describe(v).cell_size / (fade * (fill_of->range[1] - fill_of->range[0]));
    int seen = 0;
    unshaded.shade_media = false;
    for (int kind = 0; kind < 3; kind++) {
        const leafcast_camera view = view_of(v, kind);
        assert_int_equal(draw(v, scene, &view, &shaded), LEAFCAST_OK);
        assert_int_equal(draw(v, &unshaded, &view, &plain), LEAFCAST_OK);
        for (int i = 0; i < PIXELS; i++) {
            ref_ray ray;
            real light[3];
            leafcast_pixel_ray(&view, i % SIDE + 0.5, i / SIDE + 0.5, ray.o, ray.d);
            lighting_of(scene, steepness, &ray, 0, gradient, light);
            seen += plain.rgba[i][0] > 0.05;
            assert_true(fabs(shaded.rgba[i][3] - plain.rgba[i][3]) < 1e-3);
            for (int c = 0; c < 3; c++)
                assert_true(fabs(shaded.rgba[i][c] - (double)light[c] * plain.rgba[i][c]) < 2e-3);
        }
    }
    assert_true(seen > PIXELS / 2);
}

static void test_linear_mesh_is_as_by_formula(void **state) {
    static const int cubes[3] = {5, 4, 3};
    static const double origin[3] = {-2, 1, 3};
    static const double fades[] = {0.0, 0.25, 1.0};
    (void)state;
    skip_under_thread();
    lab_mesh lab;
    lab_mesh_kuhn(&lab, cubes, origin, 1.0, linear);
    leafcast *v = fixture_open(lab_leaf_make(&lab, 40, true), NULL);
    filling fill_of;
    fill(&fill_of, v);
    for (int smooth = 0; smooth < 2; smooth++)
        for (int i = 0; i < 3; i++) {
            leafcast_scene scene = scene_of(v, &fill_of, 0);
            scene.smooth_normals = smooth;
            scene.shade_fade = fades[i];
            check_mesh(v, &scene, &fill_of);
            scene.light_count = 1;
            scene.lights[0] = (leafcast_light){false, {0.3, -1.0, 0.5}, {0.9F, 0.7F, 0.5F}, 0};
            check_mesh(v, &scene, &fill_of);
        }
    leafcast_close(v);
    lab_mesh_release(&lab);
}

/* ---- A mesh with gradients at its vertices ---- */

static double square(const double p[3]) {
    return p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
}

/* What is as good as an isosurface is lit by its smooth normals. */
static void test_smooth_mesh_is_as_its_surface(void **state) {
    static const int cubes[3] = {6, 6, 6};
    static const double origin[3] = {-3, -3, -3};
    static const double iso = 5.0, dense = 4000.0;
    static planes p;
    static float normals[3][PIXELS];
    (void)state;
    skip_under_thread();
    lab_mesh lab;
    lab_mesh_kuhn(&lab, cubes, origin, 1.0, square);
    leafcast *v = fixture_open(lab_leaf_make(&lab, 40, true), NULL);
    const leafcast_transfer_point points[2] = {{iso, {1, 1, 1}, dense}, {iso + 1e-3, {1, 1, 1}, 0}};
    const leafcast_medium medium = {points, 2};
    const leafcast_surface surface = leafcast_surface_default(iso);
    leafcast_scene scene = leafcast_scene_default();
    leafcast_camera view = leafcast_standard_view(v, 1.6, SIDE, SIDE);
    int seen = 0;
    scene.smooth_normals = true;
    leafcast_image image = {.size = sizeof image, .normal = {normals[0], normals[1], normals[2]}};
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL), LEAFCAST_OK);
    const leafcast_shown alone = {.volume = v};
    scene.volumes = &alone;
    scene.volume_count = scene.media_count = 1;
    scene.media = &medium;
    scene.shade_media = true;
    assert_int_equal(draw(v, &scene, &view, &p), LEAFCAST_OK);
    for (int i = 0; i < PIXELS; i++) {
        double o[3], d[3], n_v = 0.0, length = 0.0;
        leafcast_pixel_ray(&view, i % SIDE + 0.5, i / SIDE + 0.5, o, d);
        for (int a = 0; a < 3; a++) {
            n_v += (double)normals[a][i] * d[a];
            length += (double)normals[a][i] * (double)normals[a][i];
        }
        if (length < 0.5 || fabs(n_v) < 0.3)
            continue;
        seen++;
        const double light = (double)scene.ambient + (1.0 - (double)scene.ambient) * fabs(n_v);
        assert_true(fabs(p.rgba[i][1] - light) < 0.01);
    }
    assert_true(seen > PIXELS / 8);
    leafcast_close(v);
    lab_mesh_release(&lab);
}

/* ---- Two media at one place ---- */

enum { BOX = 9 };

/* f = step * coordinate a */
static const char *ramp_along(int a, float step) {
    static char paths[3][512];
    float samples[BOX * BOX * BOX];
    field f = {.name = "ramp",
               .type = "f32",
               .dims = {BOX, BOX, BOX},
               .samples = samples,
               .spacing = {1, 1, 1}};
    for (int i = 0; i < BOX * BOX * BOX; i++) {
        const int at[3] = {i % BOX, i / BOX % BOX, i / BOX / BOX};
        samples[i] = step * (float)at[a];
    }
    strcpy(paths[a], fixture_leaf(&f, 4, 1, false));
    return paths[a];
}

/* Each is lit by its own gradient, and weighs as much as it swallows. */
static void test_two_media_are_lit_apart(void **state) {
    static const leafcast_transfer_point points[2] = {{0, {1, 0.5F, 0.2F}, 0.1},
                                                      {0, {0.1F, 0.7F, 0.9F}, 0.25}};
    static const real gradients[2][3] = {{2, 0, 0}, {0, 0, -3}};
    static const leafcast_medium media[2] = {{&points[0], 1}, {&points[1], 1}};
    static planes p;
    (void)state;
    leafcast_device *device;
    assert_int_equal(leafcast_device_create(NULL, &device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = device};
    leafcast *of[2] = {fixture_open(ramp_along(0, 2.0F), &o),
                       fixture_open(ramp_along(2, -3.0F), &o)};
    const leafcast_shown shown[2] = {{.volume = of[0]}, {.volume = of[1]}};
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera view = leafcast_standard_view(of[0], 2.0, SIDE, SIDE);
    int seen = 0;
    scene.volumes = shown;
    scene.volume_count = scene.media_count = 2;
    scene.media = media;
    scene.shade_media = true;
    scene.light_count = 1;
    scene.lights[0] = (leafcast_light){false, {2.0, 1.0, 0.5}, {1, 0.8F, 0.6F}, 0};
    assert_int_equal(draw(of[0], &scene, &view, &p), LEAFCAST_OK);
    for (int i = 0; i < PIXELS; i++) {
        ref_ray ray;
        real light[2][3];
        leafcast_pixel_ray(&view, i % SIDE + 0.5, i / SIDE + 0.5, ray.o, ray.d);
        for (int m = 0; m < 2; m++) /* both change by an eighth of their range in a cell */
            lighting_of(&scene, 10.0, &ray, 0, gradients[m], light[m]);
        seen += p.rgba[i][3] > 0.1;
        for (int c = 0; c < 3; c++) {
            double sum = 0.0;
            for (int m = 0; m < 2; m++)
                sum += points[m].extinction / 0.35 * (double)points[m].rgb[c] * (double)light[m][c];
            assert_true(fabs(p.rgba[i][c] - p.rgba[i][3] * sum) < 0.004);
        }
    }
    assert_true(seen > PIXELS / 8);
    leafcast_close(of[0]);
    leafcast_close(of[1]);
    leafcast_device_destroy(device);
}

/* ---- The same bits ---- */

typedef struct drawn {
    const char *path[2]; /* the second one: NULL, or filled, too */
    int kind;
    uint32_t treelets; /* at a time; 0: as many as memory allows */
} drawn;

/* Whether there was memory for it. */
static bool draw_with(const drawn *what, const leafcast_options *options, planes *p) {
    leafcast_device *device;
    leafcast *of[2] = {NULL, NULL};
    filling fill_of[2];
    leafcast_medium media[2];
    leafcast_shown shown[2] = {{0}};
    const int count = what->path[1] ? 2 : 1;
    assert_int_equal(leafcast_device_create(options, &device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o,
                                .device = device,
                                .experiments = EXPERIMENTS(.treelet_limit = what->treelets)};
    leafcast_status st = LEAFCAST_OK;
    for (int i = 0; i < count && st == LEAFCAST_OK; i++) {
        st = leafcast_open(what->path[i], &o, &of[i]);
        if (st != LEAFCAST_OK)
            break;
        fill(&fill_of[i], of[i]);
        media[i] = fill_of[i].medium;
        shown[i] = (leafcast_shown){.volume = of[i]};
    }
    if (st == LEAFCAST_OK) {
        leafcast_scene scene = scene_of(of[0], &fill_of[0], what->kind);
        const leafcast_camera view = view_of(of[0], what->kind);
        scene.volumes = shown;
        scene.volume_count = scene.media_count = count;
        scene.media = media;
        st = draw(of[0], &scene, &view, p);
    }
    for (int i = 0; i < 2; i++)
        leafcast_close(of[i]);
    leafcast_device_destroy(device);
    assert_true(st == LEAFCAST_OK || st == LEAFCAST_NOMEM);
    return st == LEAFCAST_OK;
}

static void check_same(const planes *want, const planes *got, const char *how) {
    for (int i = 0; i < PIXELS; i++)
        if (memcmp(want->rgba[i], got->rgba[i], sizeof got->rgba[i]) != 0)
            fail_msg("%s, pixel %d: %a, not %a", how, i, got->rgba[i][0], want->rgba[i][0]);
    assert_int_equal(got->stats.uncertified_pixels, PIXELS);
}

static void check_bits(const drawn *what) {
    static planes want, got;
    leafcast_options o = {.size = sizeof o, .isa = "scalar", .threads = 1};
    int budgets = 0;
    assert_true(draw_with(what, &o, &want));
    for (int isa = 0; isa <= (int)cpu_best(); isa++) {
        o.isa = cpu_isa_name((cpu_isa)isa);
        o.threads = 1 + isa % 3;
        assert_true(draw_with(what, &o, &got));
        check_same(&want, &got, o.isa);
    }
    for (uint32_t limit = 1; limit <= 4; limit++) {
        drawn few = *what;
        few.treelets = limit;
        assert_true(draw_with(&few, &o, &got));
        check_same(&want, &got, "few treelets");
    }
    o.threads = 1; /* each takes its share, which is large where a sanitizer looks */
    for (o.memory = 24 << 20; draw_with(what, &o, &got);
         o.memory -= o.memory / (WATCHED ? 8 : 16), budgets++)
        check_same(&want, &got, "little memory");
    assert_true(budgets > 4);
}

static void test_same_bits(void **state) {
    static char paths[2][512];
    (void)state;
    field f;
    lab_mesh lab;
    assert_true(field_make(&f, "waves", 40, 3));
    strcpy(paths[0], fixture_leaf(&f, 4, 1, false));
    assert_true(lab_mesh_make(&lab, "noise", 9, 7));
    strcpy(paths[1], lab_leaf_make(&lab, 60, true));
    for (int kind = 0; kind < 4; kind++)
        check_bits(&(drawn){{paths[0], NULL}, kind, 0});
    check_bits(&(drawn){{paths[1], NULL}, 2, 0});
    check_bits(&(drawn){{paths[0], paths[1]}, 2, 0});
    lab_mesh_release(&lab);
    field_release(&f);
}

/* ---- What is said and refused ---- */

static void test_is_not_certified(void **state) {
    static planes p;
    (void)state;
    field f;
    assert_true(field_make(&f, "sphere", 20, 3));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    filling fill_of;
    fill(&fill_of, v);
    const leafcast_camera view = view_of(v, 0);
    leafcast_scene scene = scene_of(v, &fill_of, 0);
    assert_int_equal(draw(v, &scene, &view, &p), LEAFCAST_OK);
    assert_int_equal(p.stats.uncertified_pixels, PIXELS);
    for (int i = 0; i < PIXELS; i++)
        assert_true(isinf(p.error[i]));
    const double wrong[] = {-0.1, 1.1, (double)NAN};
    for (int i = 0; i < 3; i++) {
        scene.shade_fade = wrong[i];
        assert_int_equal(draw(v, &scene, &view, &p), LEAFCAST_USAGE);
    }
    scene.shade_fade = 0.0;
    leafcast_scene_experiments steps = {
        .size = sizeof steps, .summing = LEAFCAST_STEPS, .step = 0.5};
    scene.experiments = &steps;
    assert_int_equal(draw(v, &scene, &view, &p), LEAFCAST_USAGE);
    steps = (leafcast_scene_experiments){.size = sizeof steps, .homogeneous = 1.0};
    assert_int_equal(draw(v, &scene, &view, &p), LEAFCAST_USAGE);
    leafcast_close(v);
    field_release(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_grids_are_as_by_brute_force),
                                       cmocka_unit_test(test_sphere_is_as_by_formula),
                                       cmocka_unit_test(test_linear_mesh_is_as_by_formula),
                                       cmocka_unit_test(test_smooth_mesh_is_as_its_surface),
                                       cmocka_unit_test(test_two_media_are_lit_apart),
                                       cmocka_unit_test(test_same_bits),
                                       cmocka_unit_test(test_is_not_certified)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
