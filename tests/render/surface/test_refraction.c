/* test_refraction.c - glass: Snell's and Fresnel's laws in long double; a slab shifts what is
 * behind it by the known length; slabs, balls, bubbles, prisms and water, whose pixels are traced
 * again among true balls and planes, in long double; what bends nothing changes no bit; and the
 * same bits for any threads, kernels and treelets.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/surface/refraction.h"
#include "tests/support/fixture.h"
#include "tests/support/glass_truth.h"
#include "tests/support/heights_lab.h"
#include "tests/support/pictures.h"

typedef glass_real real;

/* ---- Laws ---- */

static void draw_unit(field_random *r, real v[3]) {
    do
        for (int a = 0; a < 3; a++)
            v[a] = field_random_in(r, -1, 1);
    while (glass_dot(v, v) > 1 || glass_dot(v, v) < 0.01L);
    glass_unit(v);
}

/* Light is bent as angles say, whatever the normal's length and side; all of it, reversed, goes
 * the way that it came. */
static void rays_bend_by_the_laws(void **state) {
    field_random r = {5};
    int total = 0;
    (void)state;
    for (int i = 0; i < 20000; i++) {
        real d[3], n[3], mirrored[3], refracted[3];
        const double ratio = field_random_in(&r, 0.25, 4.0), length = field_random_in(&r, -3, 3);
        double direction[3], back[3];
        float normal[3];
        draw_unit(&r, d);
        draw_unit(&r, n);
        for (int a = 0; a < 3; a++) {
            direction[a] = (double)d[a];
            normal[a] = (float)((double)n[a] * length);
            n[a] = normal[a];
        }
        glass_unit(n);
        for (int a = 0, turn = glass_dot(n, d) > 0; a < 3; a++)
            n[a] *= turn ? -1 : 1;
        const refraction got = refraction_of(direction, normal, ratio);
        const real share = glass_laws(d, n, ratio, mirrored, refracted);
        const real cosine = -glass_dot(d, n), square = 1 - ratio * ratio * (1 - cosine * cosine);
        const real grazing = fminl(cosine, sqrtl(fabsl(square))), most = 1e-13L / grazing;
        for (int a = 0; a < 3; a++)
            assert_true(fabsl(got.mirrored[a] - mirrored[a]) < 1e-14L);
        if (grazing < 1e-5L)
            continue;
        assert_true(fabsl(got.share - share) < most);
        total += got.share == 1;
        assert_true((got.share == 1) == (share == 1));
        if (share == 1)
            continue;
        for (int a = 0; a < 3; a++) {
            assert_true(fabsl(got.refracted[a] - refracted[a]) < most);
            back[a] = -got.refracted[a];
        }
        const refraction home = refraction_of(back, normal, 1 / ratio);
        assert_true(fabsl(home.share - share) < 10 * most);
        for (int a = 0; a < 3; a++)
            assert_true(fabs(home.refracted[a] + direction[a]) < 10 * (double)most);
    }
    assert_true(total > 4000);
}

/* Of 1.5 head on, 1 / 25 is mirrored, and the ray goes straight on. */
static void glass_head_on(void **state) {
    const double down[3] = {0, 0, -1};
    const float up[3] = {0, 0, 0.5f};
    (void)state;
    for (int out = 0; out < 2; out++) {
        const refraction got = refraction_of(down, up, out ? 1.5 : 1 / 1.5);
        assert_true(fabs(got.share - 0.04) < 1e-15);
        for (int a = 0; a < 3; a++) {
            assert_true(got.refracted[a] == down[a]);
            assert_true(got.mirrored[a] == -down[a]);
        }
    }
}

/* ---- The scene as it is drawn ---- */

typedef struct stage {
    leafcast_device *device;
    leafcast *volume[GLASS_SHAPES + 1];
    leafcast_shown shown[GLASS_SHAPES + 1];
    leafcast_surface surfaces[GLASS_SHAPES][2], wall;
    int volumes;
    leafcast_scene scene;
    leafcast_camera camera;
    glass_truth truth;
    real blur; /* radii of balls may be less by this */
} stage;

enum { BALL_NODES = 65, WATER = 16 };
#define BALL     1.0
#define INNER    0.5
#define SLAB     1.0
#define SLAB_END 500.0

static void show(stage *s, leafcast *v, const leafcast_surface *surfaces, int count) {
    s->volume[s->volumes] = v;
    s->shown[s->volumes++] = (leafcast_shown){.volume = v, .surfaces = surfaces, .count = count};
}

static leafcast *open_field(stage *s, const long dims[3], const double half[3],
                            double (*value)(const double p[3])) {
    field f = {.name = "glass", .type = "f32", .dims = {dims[0], dims[1], dims[2]}};
    const leafcast_options o = {.size = sizeof o, .device = s->device};
    leafcast *v;
    f.samples = malloc(sizeof(float) * (size_t)(dims[0] * dims[1] * dims[2]));
    assert_non_null(f.samples);
    for (int a = 0; a < 3; a++) {
        f.origin[a] = -half[a];
        f.spacing[a] = 2 * half[a] / (double)(dims[a] - 1);
    }
    for (long i = 0; i < dims[0] * dims[1] * dims[2]; i++) {
        const long at[3] = {i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]};
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = f.origin[a] + (double)at[a] * f.spacing[a];
        f.samples[i] = (float)value(p);
    }
    assert_int_equal(leafcast_open(fixture_leaf(&f, 4, 1, false), &o, &v), LEAFCAST_OK);
    free(f.samples);
    return v;
}

static double in_ball(const double p[3]) {
    return BALL * BALL - p[0] * p[0] - p[1] * p[1] - p[2] * p[2];
}

static double in_slab(const double p[3]) {
    return SLAB - fabs(p[2]);
}

static leafcast *open_ball(stage *s) {
    static const long dims[3] = {BALL_NODES, BALL_NODES, BALL_NODES};
    static const double half[3] = {1.1, 1.1, 1.1};
    s->blur = 5e-4L; /* three quarters of a cell's square, by twice the radius */
    return open_field(s, dims, half, in_ball);
}

static leafcast *open_slab(stage *s) {
    static const long dims[3] = {2, 2, 3};
    static const double half[3] = {SLAB_END, SLAB_END, 2};
    return open_field(s, dims, half, in_slab);
}

static leafcast *open_mesh(stage *s, const float (*vertices)[3], uint32_t points,
                           const uint32_t (*triangles)[3], uint32_t count,
                           const uint32_t *colours) {
    const leafcast_options o = {.size = sizeof o, .device = s->device};
    const leafcast_triangles of = {.size = sizeof of,
                                   .vertex_count = points,
                                   .triangle_count = count,
                                   .vertices = vertices,
                                   .triangles = triangles,
                                   .colours = colours};
    leafcast *v;
    assert_int_equal(leafcast_open_triangles(&of, &o, &v), LEAFCAST_OK);
    return v;
}

static void show_wall(stage *s, const float at[3][3]) {
    static const uint32_t corners[1][3] = {{0, 1, 2}}, colours[3] = {0xff0000, 0x00ff00, 0x0000ff};
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
            s->truth.wall[i][a] = at[i][a];
    s->wall = leafcast_surface_default(0);
    show(s, open_mesh(s, at, 3, corners, 1, colours), &s->wall, 1);
}

static leafcast_surface glass(double isovalue, double index) {
    leafcast_surface s = {.isovalue = isovalue,
                          .rgb = {0.3f, 0.5f, 0.7f},
                          .opacity = 0.125f,
                          .refraction = (float)index};
    return s;
}

static void add_shape(stage *s, const glass_shape *x) {
    assert_true(s->truth.count < GLASS_SHAPES);
    s->truth.shapes[s->truth.count++] = *x;
}

static const glass_shape SLAB_SHAPE = {
    .end = SLAB_END, .faces = 2, .face = {{0, 0, 1, SLAB}, {0, 0, -1, SLAB}}};

/* ---- What is shown ---- */

static void set_slab(stage *s) {
    glass_shape x = SLAB_SHAPE;
    x.look = s->surfaces[0][0] = glass(0, 1.5);
    add_shape(s, &x);
    show(s, open_slab(s), s->surfaces[0], 1);
}

static void set_ball(stage *s) {
    s->surfaces[0][0] = glass(0, 1.5);
    add_shape(s, &(glass_shape){.radius = BALL, .look = s->surfaces[0][0]});
    show(s, open_ball(s), s->surfaces[0], 1);
}

static void set_mirror_ball(stage *s) {
    set_ball(s);
    s->surfaces[0][0].reflectivity = s->truth.shapes[0].look.reflectivity = 0.5f;
}

/* A bubble of air in a ball of glass: two surfaces of one object. */
static void set_bubble(stage *s) {
    set_ball(s);
    s->surfaces[0][1] = glass(BALL * BALL - INNER * INNER, 1 / 1.5);
    add_shape(s, &(glass_shape){.radius = INNER, .look = s->surfaces[0][1]});
    s->shown[s->volumes - 1].count = 2;
}

/* A ball of another glass in a slab: two objects. */
static void set_two(stage *s) {
    set_slab(s);
    s->surfaces[1][0] = glass(0.19, 1.8 / 1.5);
    add_shape(s, &(glass_shape){.radius = 0.9L, .look = s->surfaces[1][0]});
    show(s, open_ball(s), s->surfaces[1], 1);
}

/* A prism, along y, of triangles: light from below is reflected twice inside, and goes back. */
static void set_prism(stage *s) {
    static const float at[6][3] = {{-1, -3, -1}, {1, -3, -1}, {0, -3, 0},
                                   {-1, 3, -1},  {1, 3, -1},  {0, 3, 0}};
    static const uint32_t corners[8][3] = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1},
                                           {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
    const real half = sqrtl(0.5L);
    glass_shape x = {
        .faces = 5,
        .face = {
            {0, 0, -1, 1}, {half, 0, half, 0}, {-half, 0, half, 0}, {0, 1, 0, 3}, {0, -1, 0, 3}}};
    x.look = s->surfaces[0][0] = glass(0, 1.5);
    add_shape(s, &x);
    show(s, open_mesh(s, at, 6, corners, 8, NULL), s->surfaces[0], 1);
}

/* Water: a flat terrain at z = -1. */
static void set_water(stage *s) {
    const leafcast_options o = {.size = sizeof o, .device = s->device};
    float heights[WATER * WATER];
    const heights_terrain t = {
        .truth = {.nx = WATER, .ny = WATER, .heights = heights, .spacing = {1, 1}, .scale = 1},
        .heights = heights,
        .type = "f32"};
    leafcast *v;
    for (int i = 0; i < WATER * WATER; i++)
        heights[i] = -1;
    assert_int_equal(leafcast_open(heights_lab_leaf(&t, 4, 1, false), &o, &v), LEAFCAST_OK);
    glass_shape x = {.faces = 1, .face = {{0, 0, 1, -1}}};
    x.look = s->surfaces[0][0] = glass(0, 1.333);
    add_shape(s, &x);
    show(s, v, s->surfaces[0], 1);
}

typedef struct stage_case {
    const char *name;
    void (*set)(stage *s);
    float wall[3][3];
    double eye[3], at[3], fov;
    int bounces, layers_max;
} stage_case;

#define BELOW                           \
    {                                   \
        {-14, -9, -4}, {14, -10, -4}, { \
            1, 16, -5                   \
        }                               \
    }

static const stage_case CASES[] = {
    {"slab", set_slab, BELOW, {3, 2, 7}, {0, 0, 0}, 40, 5, 0},
    {"slab, aslant", set_slab, BELOW, {8, 2, 5}, {0, 0, 0}, 30, 3, 0},
    {"in the slab",
     set_slab,
     {{-9, -9, -0.5f}, {9, -8, -0.6f}, {0, 12, -0.4f}},
     {0.2, 0.1, 0.3},
     {3, 1, 2.5},
     40,
     4,
     0},
    {"ball", set_ball, BELOW, {2, 1, 4}, {0, 0, 0}, 28, 4, 0},
    {"ball that mirrors", set_mirror_ball, BELOW, {2, 1, 4}, {0, 0, 0}, 28, 3, 0},
    {"in the ball", set_ball, BELOW, {0.7, 0.1, 0.5}, {0.2, 0.1, -1}, 90, 4, 0},
    {"bubble", set_bubble, BELOW, {2, 1, 4}, {0, 0, 0}, 28, 5, 0},
    {"bubble, three layers", set_bubble, BELOW, {2, 1, 4}, {0, 0, 0}, 28, 5, 3},
    {"ball in the slab", set_two, BELOW, {1, 1, 5}, {0, 0, 0}, 35, 6, 0},
    {"prism", set_prism, BELOW, {0.3, 0.5, -3.5}, {0, 0, 0}, 40, 4, 0},
    {"water",
     set_water,
     {{-2, -2, -3}, {16, -1, -3}, {4, 14, -2}},
     {9, 6, 4},
     {6, 5, -1},
     40,
     2,
     0},
};
enum { CASES_COUNT = sizeof CASES / sizeof *CASES };

static void set_stage(stage *s, const stage_case *c, const leafcast_options *device) {
    memset(s, 0, sizeof *s);
    assert_int_equal(leafcast_device_create(device, &s->device), LEAFCAST_OK);
    c->set(s);
    show_wall(s, c->wall);
    s->scene = leafcast_scene_default();
    s->scene.volumes = s->shown;
    s->scene.volume_count = s->volumes;
    s->scene.shading = LEAFCAST_SHADING_FLAT;
    s->scene.bounces = s->truth.bounces = c->bounces;
    s->scene.layers_max = s->truth.layers_max = c->layers_max;
    s->truth.least = 1.0L / 4096;
    static const float background[4] = {0.25f, 0.5f, 1, 0.5f};
    memcpy(s->scene.background, background, sizeof background);
    memcpy(s->truth.background, background, sizeof background);
    s->camera = (leafcast_camera){.size = sizeof s->camera,
                                  .up = {0, 1, 0},
                                  .fov = c->fov,
                                  .width = PICTURE_WIDTH,
                                  .height = PICTURE_HEIGHT};
    memcpy(s->camera.eye, c->eye, sizeof c->eye);
    memcpy(s->camera.look_at, c->at, sizeof c->at);
}

static void clear_stage(stage *s) {
    for (int i = 0; i < s->volumes; i++)
        leafcast_close(s->volume[i]);
    leafcast_device_destroy(s->device);
}

/* ---- Pixels ---- */

/* How far a pixel's colours change where the ray is moved a little, and balls are a little
 * smaller, or rays that count for about the least do or do not. */
static real slack_of(const stage *s, const glass_ray *r, const real rgba[4]) {
    real slack = 0;
    for (int k = 0; k < 9; k++) {
        glass_ray moved = *r;
        glass_truth w = s->truth;
        real other[4];
        for (int i = 0; i < w.count && k == 6; i++)
            w.shapes[i].radius -= s->blur / w.shapes[i].radius;
        if (k > 6)
            w.least *= k == 7 ? 0.99L : 1.01L;
        const real by = (s->blur > 0 ? 5e-4L : 1e-7L) * (k % 2 ? 1 : -1);
        if (k < 6) {
            moved.d[k / 2] += by;
            glass_unit(moved.d);
        }
        glass_truth_pixel(&w, &moved, other);
        for (int i = 0; i < 4; i++)
            slack = fmaxl(slack, fabsl(other[i] - rgba[i]));
    }
    return slack;
}

static void pixels_are_the_truth(void **state) {
    static picture p;
    (void)state;
    for (int k = 0; k < CASES_COUNT; k++) {
        const stage_case *c = &CASES[k];
        leafcast_stats stats = {.size = sizeof stats};
        int judged = 0, straight = 0;
        real sum = 0, worst = 0;
        stage s;
        set_stage(&s, c, NULL);
        pictures_draw(s.volume[0], &s.scene, &s.camera, &p, &stats);
        glass_truth plain = s.truth;
        plain.bounces = 0;
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            glass_ray r;
            double o[3], d[3];
            real want[4], unbent[4], off = 0, bent = 0;
            leafcast_pixel_ray(&s.camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
            for (int a = 0; a < 3; a++) {
                r.o[a] = o[a];
                r.d[a] = d[a];
            }
            glass_unit(r.d);
            glass_truth_pixel(&s.truth, &r, want);
            glass_truth_pixel(&plain, &r, unbent);
            const real slack = slack_of(&s, &r, want);
            if (slack > 0.01L)
                continue;
            for (int j = 0; j < 4; j++) {
                off = fmaxl(off, fabsl((real)p.rgba[j][i] - want[j]));
                bent = fmaxl(bent, fabsl(unbent[j] - want[j]));
            }
            if (off > 1e-5L + 3 * slack)
                fail_msg("%s, pixel %d, %d: off by %Lg, slack %Lg", c->name, i % PICTURE_WIDTH,
                         i / PICTURE_WIDTH, off, slack);
            judged++;
            straight += bent < 0.01L;
            sum += off;
            worst = fmaxl(worst, off);
        }
        print_message("%s: %d of %d pixels judged, off by %.2Lg, at most %.2Lg; %d as without\n",
                      c->name, judged, PICTURE_PIXELS, sum / judged, worst, straight);
        assert_true(judged > PICTURE_PIXELS * 3 / 5 && straight < judged * 3 / 4);
        assert_true(stats.refracted_rays > 0 && stats.mirrored_rays > 0);
        assert_int_equal(stats.rays,
                         stats.primary_rays + stats.mirrored_rays + stats.refracted_rays);
        clear_stage(&s);
    }
}

/* Behind a slab of thickness T, all is shifted by T (tan i - tan r). */
static void a_slab_shifts_what_is_behind_it(void **state) {
    static picture p;
    const stage_case flat = {"slab",    set_slab,  {{-60, -50, -4}, {60, -50, -4}, {0, 80, -4}},
                             {6, 1, 8}, {0, 0, 0}, 25,
                             2,         0};
    leafcast_stats stats = {.size = sizeof stats};
    double least = INFINITY;
    stage s;
    (void)state;
    set_stage(&s, &flat, NULL);
    memset(s.scene.background, 0, sizeof s.scene.background);
    memset(s.surfaces[0][0].rgb, 0, sizeof s.surfaces[0][0].rgb);
    pictures_draw(s.volume[0], &s.scene, &s.camera, &p, &stats);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double o[3], d[3], square = 0, sum = 0;
        leafcast_pixel_ray(&s.camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        const double across = sqrt(d[0] * d[0] + d[1] * d[1]), tangent = across / -d[2];
        const double sine = across / 1.5,
                     shift = 2 * SLAB * (tangent - sine / sqrt(1 - sine * sine));
        for (int c = 0; c < 3; c++)
            sum += (double)p.rgba[c][i];
        for (int a = 0; a < 2; a++) {
            double at = 0;
            for (int c = 0; c < 3; c++)
                at += (double)p.rgba[c][i] / sum * (double)s.truth.wall[c][a];
            const double moved = at - (o[a] + (o[2] + 4) / -d[2] * d[a]);
            assert_true(fabs(moved + shift * d[a] / across) < 5e-5);
            square += moved * moved;
        }
        least = fmin(least, sqrt(square));
    }
    print_message("shifted by %g at least\n", least);
    assert_true(least > 0.2);
    assert_int_equal(stats.mirrored_rays, 2 * PICTURE_PIXELS);
    assert_int_equal(stats.refracted_rays, 2 * PICTURE_PIXELS);
    clear_stage(&s);
}

/* ---- What changes nothing ---- */

static void what_bends_nothing_changes_no_bit(void **state) {
    static picture want, got;
    static const struct {
        float refraction, opacity;
        int bounces;
    } rows[] = {{1, 0.125f, 4}, {0, 0.125f, 4}, {1.5f, 0.125f, 0}, {1.5f, 1, 4}};
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        leafcast_stats stats = {.size = sizeof stats};
        stage s;
        set_stage(&s, &CASES[3], NULL);
        s.surfaces[0][0].refraction = 0;
        s.surfaces[0][0].opacity = rows[i].opacity;
        s.scene.bounces = 0;
        pictures_draw(s.volume[0], &s.scene, &s.camera, &want, NULL);
        s.surfaces[0][0].refraction = rows[i].refraction;
        s.scene.bounces = rows[i].bounces;
        pictures_draw(s.volume[0], &s.scene, &s.camera, &got, &stats);
        assert_memory_equal(&want, &got, sizeof want);
        assert_int_equal(stats.rays, PICTURE_PIXELS);
        clear_stage(&s);
    }
}

/* Planes but colours are those of the first surface, as ever. */
static void only_colours_change(void **state) {
    static picture want, got;
    stage s;
    (void)state;
    set_stage(&s, &CASES[6], NULL);
    pictures_draw(s.volume[0], &s.scene, &s.camera, &got, NULL);
    s.scene.bounces = 0;
    pictures_draw(s.volume[0], &s.scene, &s.camera, &want, NULL);
    assert_memory_equal(want.z, got.z, sizeof want.z);
    assert_memory_equal(want.id, got.id, sizeof want.id);
    assert_memory_equal(want.normal, got.normal, sizeof want.normal);
    assert_true(memcmp(want.rgba, got.rgba, sizeof want.rgba) != 0);
    clear_stage(&s);
}

/* ---- The same bits ---- */

static void other_ways_have_the_same_bits(void **state) {
    static picture want, got;
    static const char *const isas[] = {"scalar", NULL};
    (void)state;
    for (int k = 4; k < CASES_COUNT; k++) {
        for (int way = 0; way < 8; way++) {
            const leafcast_options o = {.size = sizeof o,
                                        .threads = 1 + way % 3,
                                        .isa = isas[way % 2],
                                        .memory = way >= 4 ? (uint64_t)19 << 20 : 0};
            stage s;
            set_stage(&s, &CASES[k], &o);
            pictures_draw(s.volume[0], &s.scene, &s.camera, way ? &got : &want, NULL);
            if (way)
                assert_memory_equal(&want, &got, sizeof want);
            clear_stage(&s);
        }
    }
}

/* ---- Errors ---- */

static leafcast_status draw(stage *s) {
    static float red[PICTURE_PIXELS];
    const leafcast_image image = {.size = sizeof image, .r = red};
    return leafcast_trace(s->volume[0], &s->scene, &s->camera, &image, NULL, NULL, NULL);
}

static void what_is_refused(void **state) {
    static const float bad[] = {-1, 0.24f, 4.01f, NAN, INFINITY};
    static const leafcast_transfer_point points[] = {{0, {1, 1, 1}, 1}};
    const leafcast_medium media[2] = {{points, 1}, {NULL, 0}};
    stage s;
    (void)state;
    set_stage(&s, &CASES[3], NULL);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        s.surfaces[0][0].refraction = bad[i];
        assert_int_equal(draw(&s), LEAFCAST_USAGE);
        assert_non_null(strstr(leafcast_error_text(), "refraction"));
    }
    s.surfaces[0][0].refraction = 0.25f;
    assert_int_equal(draw(&s), LEAFCAST_OK);
    s.surfaces[0][0].refraction = 4;
    assert_int_equal(draw(&s), LEAFCAST_OK);
    s.scene.media = media;
    s.scene.media_count = 2;
    assert_int_equal(draw(&s), LEAFCAST_USAGE);
    assert_non_null(strstr(leafcast_error_text(), "refraction: not with media"));
    s.scene.bounces = 0;
    assert_int_equal(draw(&s), LEAFCAST_OK);
    clear_stage(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_bend_by_the_laws),
        cmocka_unit_test(glass_head_on),
        cmocka_unit_test(pixels_are_the_truth),
        cmocka_unit_test(a_slab_shifts_what_is_behind_it),
        cmocka_unit_test(what_bends_nothing_changes_no_bit),
        cmocka_unit_test(only_colours_change),
        cmocka_unit_test(other_ways_have_the_same_bits),
        cmocka_unit_test(what_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
