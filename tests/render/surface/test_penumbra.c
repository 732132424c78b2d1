/* test_penumbra.c - a ball above a plane: the share of a light that arrives behind the ball against
 * that of the two discs in the sky, and the ball's share of the ambient light; the more samples,
 * the nearer. Two planes that mirror each other: their colours are a sum of powers.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/pictures.h"

static const double PI = 3.14159265358979323846;

/* The ball: of this radius, about this height; the plane z = 0 and what is on it: x, y to +-HALF.
 */
#define RADIUS 1.0
#define HEIGHT 2.5
#define HALF   4.0

enum { NODES = 65 };

typedef struct stage {
    leafcast_device *device;
    leafcast *plane, *ball;
    leafcast_shown shown[2];
    leafcast_surface surfaces[2];
    leafcast_scene scene;
    leafcast_camera camera;
} stage;

static leafcast *open_field(stage *s, const char *name, long nodes, double from, double to,
                            double bottom, double height, double (*value)(const double p[3])) {
    field f = {.name = name, .type = "f32", .dims = {nodes, nodes, nodes}};
    const leafcast_options o = {.size = sizeof o, .device = s->device};
    leafcast *v;
    f.samples = malloc(sizeof(float) * (size_t)(nodes * nodes * nodes));
    assert_non_null(f.samples);
    for (int a = 0; a < 3; a++) {
        f.origin[a] = a < 2 ? from : bottom;
        f.spacing[a] = (a < 2 ? to - from : height) / (double)(nodes - 1);
    }
    for (long i = 0; i < nodes * nodes * nodes; i++) {
        const long at[3] = {i % nodes, i / nodes % nodes, i / nodes / nodes};
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = f.origin[a] + (double)at[a] * f.spacing[a];
        f.samples[i] = (float)value(p);
    }
    assert_int_equal(leafcast_open(fixture_leaf(&f, 4, 1, false), &o, &v), LEAFCAST_OK);
    free(f.samples);
    return v;
}

static double height_of(const double p[3]) {
    return -p[2];
}

static double in_ball(const double p[3]) {
    const double z = p[2] - HEIGHT;
    return RADIUS * RADIUS - p[0] * p[0] - p[1] * p[1] - z * z;
}

/* Seen from above, from below the ball: parallel rays begin under it. */
static void set_stage(stage *s) {
    memset(s, 0, sizeof *s);
    assert_int_equal(leafcast_device_create(NULL, &s->device), LEAFCAST_OK);
    s->plane = open_field(s, "plane", 2, -3 * HALF, 3 * HALF, -1, 8, height_of);
    s->ball = open_field(s, "ball", NODES, -1.1, 1.1, HEIGHT - 1.1, 2.2, in_ball);
    for (int i = 0; i < 2; i++) {
        s->surfaces[i] = leafcast_surface_default(0);
        for (int c = 0; c < 3; c++)
            s->surfaces[i].rgb[c] = 1;
    }
    s->shown[0] = (leafcast_shown){.volume = s->plane, .surfaces = &s->surfaces[0], .count = 1};
    s->shown[1] = (leafcast_shown){.volume = s->ball, .surfaces = &s->surfaces[1], .count = 1};
    s->scene = leafcast_scene_default();
    s->scene.volumes = s->shown;
    s->scene.volume_count = 2;
    s->scene.shadows = true;
    s->scene.ambient = 0;
    s->camera = (leafcast_camera){.size = sizeof s->camera,
                                  .eye = {0, 0, 1},
                                  .up = {0, 1, 0},
                                  .ortho_height = 2 * HALF,
                                  .width = PICTURE_WIDTH,
                                  .height = PICTURE_HEIGHT};
}

static void clear_stage(stage *s) {
    leafcast_close(s->plane);
    leafcast_close(s->ball);
    leafcast_device_destroy(s->device);
}

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* ---- Lights ---- */

/* The share of the cone of a light about `to` that the ball does not hide from p: rings of it. */
static double open_share(const double p[3], const double to[3], double cone) {
    enum { RINGS = 200 };
    const double away[3] = {-p[0], -p[1], HEIGHT - p[2]}, far = length_of(away);
    const double ball = asin(RADIUS / far);
    const double between =
        acos(fmax(-1, fmin(1, (to[0] * away[0] + to[1] * away[1] + to[2] * away[2]) / far)));
    double hidden = 0;
    for (int i = 0; i < RINGS; i++) {
        /* Of equal solid angle. On a ring, the ball hides what is nearer to its middle. */
        const double ring = acos(1 - (i + 0.5) / RINGS * (1 - cos(cone)));
        const double turn =
            (cos(ball) - cos(ring) * cos(between)) / fmax(1e-12, sin(ring) * sin(between));
        hidden += turn <= -1 ? 1 : turn >= 1 ? 0 : acos(turn) / PI;
    }
    return 1 - hidden / RINGS;
}

typedef struct errors {
    double mean, signed_mean, most;
    int count; /* pixels of the penumbra */
} errors;

static errors penumbra(const stage *s) {
    static picture p;
    const leafcast_light *light = &s->scene.lights[0];
    errors e = {0};
    pictures_draw(s->plane, &s->scene, &s->camera, &p, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double at[3], d[3], to[3];
        leafcast_pixel_ray(&s->camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, at, d);
        assert_true(fabs(p.z[i] - at[2]) < 1e-6);
        at[2] = 0;
        for (int a = 0; a < 3; a++)
            to[a] = light->vector[a] - (light->point ? at[a] : 0);
        const double far = length_of(to);
        for (int a = 0; a < 3; a++)
            to[a] /= far;
        const double want =
            open_share(at, to, light->point ? asin(light->radius / far) : light->radius * PI / 180);
        const double off = (double)p.rgba[0][i] / to[2] - want;
        if (want <= 0.001 || want >= 0.999)
            assert_true(fabs(off) < 0.13); /* a sample of 16, where the ball is a little smaller */
        if (want < 0.02 || want > 0.98)
            continue;
        e.count++;
        e.mean += fabs(off);
        e.signed_mean += off;
        e.most = fmax(e.most, fabs(off));
    }
    e.mean /= e.count;
    e.signed_mean /= e.count;
    return e;
}

static void shadows_of_a_ball(void **state) {
    static const struct {
        int samples, rays; /* to the light; of a pixel */
        double mean, most;
    } rows[] = {{1, 1, 0.5, 1},      {4, 1, 0.16, 0.6},  {16, 1, 0.06, 0.25},
                {64, 1, 0.022, 0.1}, {4, 4, 0.06, 0.25}, {4, 16, 0.025, 0.11}};
    (void)state;
    for (int point = 0; point < 2; point++) {
        stage s;
        double before = 1;
        set_stage(&s);
        s.scene.light_count = 1;
        s.scene.lights[0] = point ? (leafcast_light){true, {1.5, 2, 12}, {1, 1, 1}, 2.5}
                                  : (leafcast_light){false, {0.3, 0.2, 1}, {1, 1, 1}, 12};
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            s.scene.light_samples = rows[i].samples;
            s.scene.samples = rows[i].rays;
            const errors e = penumbra(&s);
            print_message("%s, %d samples of %d rays: off by %.4f on average, %.4f at most, bias "
                          "%.4f, in %d pixels\n",
                          point ? "ball" : "sun", rows[i].samples, rows[i].rays, e.mean, e.most,
                          e.signed_mean, e.count);
            assert_true(e.count > PICTURE_PIXELS / 20);
            assert_true(e.mean < rows[i].mean && e.most <= rows[i].most);
            /* Of n samples' errors the mean is as their root; smaller pictures have fewer. */
            assert_true(fabs(e.signed_mean) <
                        (rows[i].samples == 1 ? 0.05 : 0.015) * sqrt(75.0 * 53.0 / PICTURE_PIXELS));
            assert_true(rows[i].rays > 1 || e.mean < 0.6 * before);
            before = e.mean;
        }
        clear_stage(&s);
    }
}

/* ---- Ambient light ---- */

/* Of the plane, the ball hides sin^2 of its half-angle times the cosine of its place from the
 * zenith: all of it is above the horizon here. */
static void ambient_light_under_a_ball(void **state) {
    static const int samples[] = {4, 16, 64};
    static const double most[] = {0.5, 0.16, 0.06}, mean[] = {0.12, 0.04, 0.015};
    static picture p;
    (void)state;
    stage s;
    set_stage(&s);
    s.scene.ambient = 1;
    s.scene.shading = LEAFCAST_SHADING_DIFFUSE;
    for (int reach = 0; reach < 2; reach++) {
        for (int k = 0; k < 3; k++) {
            double sum = 0, worst = 0;
            s.scene.occlusion = reach ? 20 : HEIGHT - RADIUS - 0.05; /* none reaches the ball */
            s.scene.occlusion_samples = samples[k];
            pictures_draw(s.plane, &s.scene, &s.camera, &p, NULL);
            for (int i = 0; i < PICTURE_PIXELS; i++) {
                double at[3], d[3];
                leafcast_pixel_ray(&s.camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, at,
                                   d);
                const double square = at[0] * at[0] + at[1] * at[1] + HEIGHT * HEIGHT;
                const double hides = RADIUS * RADIUS / square * HEIGHT / sqrt(square);
                const double off = fabs((double)p.rgba[0][i] - (reach ? 1 - hides : 1));
                sum += off;
                worst = fmax(worst, off);
            }
            print_message("%d samples to %g: off by %.4f on average, %.4f at most\n", samples[k],
                          s.scene.occlusion, sum / PICTURE_PIXELS, worst);
            if (!reach)
                assert_true(worst < 1e-6);
            assert_true(worst < most[k] && sum / PICTURE_PIXELS < mean[k]);
        }
    }
    clear_stage(&s);
}

/* ---- Mirrors ---- */

/* The eye between two planes that mirror each other sees (1 - w) (D1 + w D2 + w^2 D1 ..), and the
 * last plane's own colour. */
static void planes_mirror_each_other(void **state) {
    static picture p;
    stage s;
    (void)state;
    set_stage(&s);
    leafcast_surface two[2] = {s.surfaces[0], s.surfaces[0]};
    two[1].isovalue = -4; /* z = 4 */
    for (int c = 0; c < 3; c++) {
        two[0].rgb[c] = 0.25f * (float)(c + 1);
        two[1].rgb[c] = 1 - 0.3f * (float)c;
    }
    two[0].reflectivity = two[1].reflectivity = 0.75f;
    s.shown[0].surfaces = two;
    s.shown[0].count = 2;
    s.scene.volume_count = 1;
    s.scene.shading = LEAFCAST_SHADING_FLAT;
    s.camera.fov = 20;
    s.camera.ortho_height = 0;
    for (int bounces = 0; bounces <= LEAFCAST_BOUNCES_MAX; bounces++) {
        leafcast_stats stats = {.size = sizeof stats};
        s.scene.bounces = bounces;
        pictures_draw(s.plane, &s.scene, &s.camera, &p, &stats);
        for (int c = 0; c < 3; c++) {
            double want = (double)two[bounces % 2].rgb[c]; /* the last one's */
            for (int b = bounces - 1; b >= 0; b--)
                want = 0.25 * (double)two[b % 2].rgb[c] + 0.75 * want;
            for (int i = 0; i < PICTURE_PIXELS; i++)
                assert_true(fabs((double)p.rgba[c][i] - want) < 1e-6);
        }
        assert_int_equal(stats.mirrored_rays, (uint64_t)bounces * PICTURE_PIXELS);
    }
    clear_stage(&s);
}

/* A plane that mirrors all shows the ball's colour where the mirrored ray meets the ball, and the
 * background where it does not. */
static void a_plane_mirrors_a_ball(void **state) {
    static picture p;
    int balls = 0, skies = 0, near = 0;
    stage s;
    (void)state;
    set_stage(&s);
    s.surfaces[0].reflectivity = 1;
    s.surfaces[1].rgb[0] = 0.5f;
    s.scene.shading = LEAFCAST_SHADING_FLAT;
    s.scene.bounces = 1;
    s.scene.background[1] = 0.75f;
    s.scene.background[3] = 0.5f;
    s.camera.eye[0] = 4;
    s.camera.eye[2] = 3;
    s.camera.ortho_height = 6;
    pictures_draw(s.plane, &s.scene, &s.camera, &p, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double o[3], d[3], along = 0, square = 0;
        leafcast_pixel_ray(&s.camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        if (p.id[i] != 0)
            continue;
        for (int a = 0; a < 3; a++)
            o[a] += p.z[i] * d[a];
        d[2] = -d[2];
        o[2] -= HEIGHT;
        for (int a = 0; a < 3; a++)
            along += d[a] * o[a];
        for (int a = 0; a < 3; a++)
            square += (o[a] - along * d[a]) * (o[a] - along * d[a]);
        const bool ball = square < RADIUS * RADIUS && along < 0;
        if (fabs(sqrt(square) - RADIUS) < 0.01) {
            near++;
            continue;
        }
        balls += ball;
        skies += !ball;
        const double want[3] = {ball ? 0.5 : 0, ball ? 1 : 0.375, ball ? 1 : 0};
        for (int c = 0; c < 3; c++)
            assert_true(fabs((double)p.rgba[c][i] - want[c]) < 1e-6);
        assert_true((double)p.rgba[3][i] > 0.999);
    }
    print_message("%d pixels mirror the ball, %d the sky, %d its edge\n", balls, skies, near);
    assert_true(balls > PICTURE_PIXELS / 40 && skies > balls && near * 10 < balls);
    clear_stage(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shadows_of_a_ball),
        cmocka_unit_test(ambient_light_under_a_ball),
        cmocka_unit_test(planes_mirror_each_other),
        cmocka_unit_test(a_plane_mirrors_a_ball),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
