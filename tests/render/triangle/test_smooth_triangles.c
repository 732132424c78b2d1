/* test_smooth_triangles.c - triangles shaded by normals at their vertices: against the analytic
 * normals of a sphere and of an ellipsoid at a place; every kernel, thread and budget has the same
 * bits; hits stay where they are; no normal faces away from the eye where its triangle does not; no
 * light where the triangle is turned away from it; normals that are none, and sums that are none.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "formats/leaf/triangle_normal.h"
#include "prep/leafcast_prep.h"
#include "render/triangle/triangle_kernel.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

/* ---- an icosphere ---- */

enum { LEVELS = 4, FACES = 20 << 2 * LEVELS, POINTS = 10 * (1 << 2 * LEVELS) + 2 };

static const double middle[3] = {0.3, -0.7, 2.0};

typedef struct ball {
    uint32_t points, faces;
    double at[POINTS][3]; /* from the middle, of unit length */
    uint32_t row[FACES][3];
} ball;

static uint32_t add_point(ball *b, const double p[3]) {
    double unit[3];
    assert_true(vec3_unit(p, unit));
    for (uint32_t i = 0; i < b->points; i++)
        if (fabs(b->at[i][0] - unit[0]) + fabs(b->at[i][1] - unit[1]) +
                fabs(b->at[i][2] - unit[2]) <
            1e-9)
            return i;
    assert_true(b->points < POINTS);
    memcpy(b->at[b->points], unit, sizeof unit);
    return b->points++;
}

static uint32_t between(ball *b, uint32_t i, uint32_t k) {
    double p[3];
    for (int a = 0; a < 3; a++)
        p[a] = b->at[i][a] + b->at[k][a];
    return add_point(b, p);
}

/* The faces of an icosahedron turn to the left as seen from outside. */
static void make_ball(ball *b, int levels) {
    static uint32_t before[FACES][3];
    const double g = 0.5 * (1.0 + sqrt(5.0));
    const double corner[12][3] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                  {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                  {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    static const uint32_t face[20][3] = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    b->points = 0;
    b->faces = 20;
    for (int i = 0; i < 12; i++)
        (void)add_point(b, corner[i]);
    memcpy(b->row, face, sizeof face);
    for (int level = 0; level < levels; level++) {
        const uint32_t count = b->faces;
        memcpy(before, b->row, count * sizeof *before);
        b->faces = 0;
        for (uint32_t i = 0; i < count; i++) {
            const uint32_t *t = before[i];
            const uint32_t m[3] = {between(b, t[0], t[1]), between(b, t[1], t[2]),
                                   between(b, t[2], t[0])};
            const uint32_t four[4][3] = {
                {t[0], m[0], m[2]}, {t[1], m[1], m[0]}, {t[2], m[2], m[1]}, {m[0], m[1], m[2]}};
            memcpy(b->row[b->faces], four, sizeof four);
            b->faces += 4;
        }
    }
}

/* How the file has normals: not; exactly; towards the middle; with a vertex of each face that has
 * none, as all vertices of even numbers have. */
typedef enum how { BARE, EXACT, INWARD, HOLED } how;

static const char *write_ball(const ball *b, how normals, const char *name) {
    const char *path = scratch_path(name);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fprintf(f,
            "ply\nformat ascii 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
            "property float z\n%selement face %u\nproperty list uchar int vertex_indices\n"
            "end_header\n",
            b->points,
            normals == BARE ? "" : "property float nx\nproperty float ny\nproperty float nz\n",
            b->faces);
    for (uint32_t i = 0; i < b->points; i++) {
        const double by = normals == INWARD ? -3.0 : normals == HOLED ? 0.0 : 1.0;
        const double *n = b->at[i];
        for (int a = 0; a < 3; a++)
            fprintf(f, "%.9g ", (double)(float)(n[a] + middle[a]));
        if (normals != BARE)
            fprintf(f, " %.9g %.9g %.9g", by * n[0], by * n[1], by * n[2]);
        fprintf(f, "\n");
    }
    for (uint32_t i = 0; i < b->faces; i++)
        fprintf(f, "3 %u %u %u\n", b->row[i][0], b->row[i][1], b->row[i][2]);
    assert_int_equal(fclose(f), 0);
    return path;
}

static ball sphere;

static const char *convert(int levels, how normals, leafcast_surface_normals option, uint32_t size,
                           int zstd) {
    const leafcast_convert_options o = {.size = sizeof o,
                                        .replace = true,
                                        .normals = option,
                                        .treelet_tets = size,
                                        .zstd_level = zstd};
    make_ball(&sphere, levels);
    const char *path = scratch_path("ball.leaf");
    if (leafcast_convert_path(write_ball(&sphere, normals, "ball.ply"), path, &o) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    return path;
}

static void select_one(leafcast *v) {
    const leafcast_surface surface = leafcast_surface_default(0.0);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
}

static void draw(const char *path, const leafcast_scene *scene, picture *to) {
    leafcast *v = fixture_open(path, NULL);
    leafcast_stats stats = {.size = sizeof stats};
    select_one(v);
    const leafcast_camera c = leafcast_standard_view(v, 1.2, PICTURE_WIDTH, PICTURE_HEIGHT);
    pictures_draw(v, scene, &c, to, &stats);
    leafcast_close(v);
}

static leafcast_camera view_of(const char *path) {
    leafcast *v = fixture_open(path, NULL);
    const leafcast_camera c = leafcast_standard_view(v, 1.2, PICTURE_WIDTH, PICTURE_HEIGHT);
    leafcast_close(v);
    return c;
}

static void ray_of(const leafcast_camera *c, int i, double o[3], double d[3]) {
    leafcast_pixel_ray(c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
}

static double degrees_between(const double a[3], const double b[3]) {
    double cross[3];
    vec3_cross(a, b, cross);
    return atan2(vec3_length(cross), vec3_dot(a, b)) * 57.29577951308232;
}

static bool is_hit(const picture *p, int i) {
    return !isinf(p->z[i]);
}

static void normal_at(const picture *p, int i, double n[3]) {
    for (int a = 0; a < 3; a++)
        n[a] = (double)p->normal[a][i];
}

/* The mean angle to the sphere's own normals at the points that are hit; *worst: the largest. */
static double mean_error(const picture *p, const leafcast_camera *c, double *worst) {
    double sum = 0.0;
    int count = 0;
    *worst = 0.0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double o[3], d[3], n[3], out[3];
        if (!is_hit(p, i))
            continue;
        ray_of(c, i, o, d);
        for (int a = 0; a < 3; a++)
            out[a] = o[a] + p->z[i] * d[a] - middle[a];
        normal_at(p, i, n);
        assert_true(fabs(vec3_length(n) - 1.0) < 1e-6);
        const double off = degrees_between(n, out);
        sum += off;
        count++;
        *worst = fmax(*worst, off);
    }
    assert_true(count > PICTURE_PIXELS / 8);
    return sum / count;
}

/* ---- tests ---- */

static const leafcast_scene *plain(void) {
    static leafcast_scene scene;
    scene = leafcast_scene_default();
    return &scene;
}

/* Flat triangles are off by degrees, smooth ones hardly; hits are the same to the bit. */
static void test_sphere(void **state) {
    static picture flat, is;
    (void)state;
    double worst;
    draw(convert(3, BARE, LEAFCAST_NORMALS_FILE, 100, 0), plain(), &flat);
    const leafcast_camera c = view_of(scratch_path("ball.leaf"));
    const double faceted = mean_error(&flat, &c, &worst);
    assert_true(faceted > 1.5 && worst > 3.0);
    static const struct {
        how normals;
        leafcast_surface_normals option;
        double most;
    } ways[] = {{EXACT, LEAFCAST_NORMALS_FILE, 0.05},
                {INWARD, LEAFCAST_NORMALS_FILE, 0.05},
                {BARE, LEAFCAST_NORMALS_SMOOTH, 0.35},
                {INWARD, LEAFCAST_NORMALS_SMOOTH, 0.35}};
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        draw(convert(3, ways[k].normals, ways[k].option, 100, k % 2), plain(), &is);
        const double mean = mean_error(&is, &c, &worst);
        print_message("way %zu: %.4f degrees, %.4f at most; flat %.3f\n", k, mean, worst, faceted);
        assert_true(mean < ways[k].most && worst < 1.0);
        assert_memory_equal(is.z, flat.z, sizeof is.z);
        assert_memory_equal(is.id, flat.id, sizeof is.id);
    }
    draw(convert(3, EXACT, LEAFCAST_NORMALS_FLAT, 100, 0), plain(), &is);
    assert_memory_equal(is.normal, flat.normal, sizeof is.normal);
    assert_memory_equal(is.rgba, flat.rgba, sizeof is.rgba);
}

/* Tiles of each ISA, single rays and batches; treelets and budgets; lights, shadows, layers. */
static void test_same_bits(void **state) {
    (void)state;
    const char *path = convert(WATCHED ? 2 : 3, EXACT, LEAFCAST_NORMALS_FILE, 64, 1);
    picture_volumes v = pictures_open(path, 2);
    const leafcast_options little = {.size = sizeof little, .memory = 6 << 20, .threads = 3};
    field_random r = {FIELD_SEED};
    leafcast_surface clear = leafcast_surface_default(0.0);
    v.of[v.count] = fixture_open(path, &little);
    v.name[v.count++] = "little memory";
    clear.opacity = 0.4f;
    for (int kind = 0; kind < PICTURE_VIEWS; kind++) {
        const leafcast_camera c = pictures_view(v.of[0], kind, &r);
        const leafcast_info info = leafcast_describe(v.of[0]);
        leafcast_scene scene = pictures_scene(kind, &info);
        scene.lod = LEAFCAST_LOD_EXACT; /* surfaces have no other */
        pictures_select(&v, &clear, 1);
        (void)pictures_alike(&v, &scene, &c, "smooth");
    }
    pictures_close(&v);
}

/* A probe and rays tell the normals of the picture. */
static void test_probes(void **state) {
    static picture p;
    static leafcast_ray rays[PICTURE_PIXELS];
    static leafcast_ray_hit hits[PICTURE_PIXELS];
    (void)state;
    const char *path = convert(2, EXACT, LEAFCAST_NORMALS_FILE, 64, 0);
    leafcast *v = fixture_open(path, NULL);
    const leafcast_camera c = view_of(path);
    const leafcast_scene *scene = plain();
    leafcast_stats stats = {.size = sizeof stats};
    select_one(v);
    pictures_draw(v, scene, &c, &p, &stats);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        rays[i] = (leafcast_ray){.t1 = (double)INFINITY};
        ray_of(&c, i, rays[i].origin, rays[i].direction);
    }
    assert_int_equal(leafcast_trace_rays(v, scene, rays, PICTURE_PIXELS, hits), LEAFCAST_OK);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        leafcast_hit met[4];
        int count;
        if (!is_hit(&p, i))
            continue;
        assert_int_equal(
            leafcast_probe_ray(v, scene, rays[i].origin, rays[i].direction, met, 4, &count),
            LEAFCAST_OK);
        assert_true(count >= 1 && hits[i].t == p.z[i] && met[0].t == p.z[i]);
        for (int a = 0; a < 3; a++)
            assert_true(hits[i].normal[a] == p.normal[a][i] &&
                        met[0].normal[a] == (double)p.normal[a][i]);
    }
    leafcast_close(v);
}

/* Of a coarse ball: a normal is on its triangle's side, and is seen where that is. Without that,
 * some would not be. */
static void test_silhouettes(void **state) {
    static picture flat, is;
    (void)state;
    int bent = 0;
    for (int levels = 0; levels < 3; levels++) {
        draw(convert(levels, BARE, LEAFCAST_NORMALS_FILE, 16, 0), plain(), &flat);
        draw(convert(levels, EXACT, LEAFCAST_NORMALS_FILE, 16, 0), plain(), &is);
        const leafcast_camera c = view_of(scratch_path("ball.leaf"));
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            double o[3], d[3], n[3], of[3], out[3];
            if (!is_hit(&is, i))
                continue;
            ray_of(&c, i, o, d);
            normal_at(&is, i, n);
            normal_at(&flat, i, of);
            for (int a = 0; a < 3; a++)
                out[a] = o[a] + is.z[i] * d[a] - middle[a];
            bent += vec3_dot(out, d) > 0.0;
            assert_true(vec3_dot(of, d) < 0.0);
            assert_true(vec3_dot(of, n) > 0.0);
            if (!(vec3_dot(n, d) < -0.0009))
                fail_msg("pixel %d: the cosine to the eye is %g", i, -vec3_dot(n, d));
        }
    }
    assert_true(bent > 5);
}

/* Where a triangle is turned away from the light, it gets none, whatever its vertices say. */
static void test_no_leaks(void **state) {
    static picture flat, is, dark;
    (void)state;
    leafcast_scene scene = leafcast_scene_default();
    scene.light_count = 1;
    scene.shadows = true;
    scene.lights[0] = (leafcast_light){.vector = {-0.9, 0.8, 0.4}, .rgb = {1, 1, 1}};
    draw(convert(1, BARE, LEAFCAST_NORMALS_FILE, 16, 0), &scene, &flat);
    draw(convert(1, EXACT, LEAFCAST_NORMALS_FILE, 16, 0), &scene, &is);
    scene.lights[0].rgb[0] = scene.lights[0].rgb[1] = scene.lights[0].rgb[2] = 0.0f;
    draw(scratch_path("ball.leaf"), &scene, &dark);
    int turned = 0, would = 0, lit = 0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double of[3], n[3];
        if (!is_hit(&is, i))
            continue;
        normal_at(&flat, i, of);
        normal_at(&is, i, n);
        lit += is.rgba[0][i] > dark.rgba[0][i];
        if (vec3_dot(of, scene.lights[0].vector) > 0.0)
            continue;
        turned++;
        would += vec3_dot(n, scene.lights[0].vector) > 0.0;
        for (int k = 0; k < 3; k++)
            assert_true(is.rgba[k][i] == dark.rgba[k][i]);
    }
    assert_true(turned > 20 && would > 5 && lit > 20);
}

/* At a place that stretches and mirrors: the normals of the ellipsoid. */
static void test_placed(void **state) {
    static picture is;
    static const double place[12] = {-2, 0, 0, 1, 0.3, 1, 0, 0, 0, 0, 0.5, -1};
    (void)state;
    leafcast *v = fixture_open(convert(4, EXACT, LEAFCAST_NORMALS_FILE, 500, 0), NULL);
    const leafcast_surface surface = leafcast_surface_default(0.0);
    const leafcast_shown shown = {.volume = v, .surfaces = &surface, .count = 1, .place = place};
    leafcast_scene scene = leafcast_scene_default();
    leafcast_stats stats = {.size = sizeof stats};
    double centre[3];
    scene.volumes = &shown;
    scene.volume_count = 1;
    for (int a = 0; a < 3; a++)
        centre[a] = vec3_dot(place + 4 * a, middle) + place[4 * a + 3];
    leafcast_camera c = leafcast_standard_view(v, 1.6, PICTURE_WIDTH, PICTURE_HEIGHT);
    for (int a = 0; a < 3; a++) {
        c.eye[a] += centre[a] - middle[a];
        c.look_at[a] = centre[a];
    }
    pictures_draw(v, &scene, &c, &is, &stats);
    int count = 0;
    double worst = 0.0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double o[3], d[3], n[3], own[3], out[3];
        if (!is_hit(&is, i))
            continue;
        ray_of(&c, i, o, d);
        normal_at(&is, i, n);
        for (int a = 0; a < 3; a++)
            o[a] += is.z[i] * d[a] - centre[a];
        /* Back to the sphere: x first, then y, which has a share of it. */
        own[0] = o[0] / place[0];
        own[1] = o[1] - place[4] * own[0];
        own[2] = o[2] / place[10];
        /* By the inverse transpose: solve the transposed rows. */
        out[1] = own[1];
        out[2] = own[2] / place[10];
        out[0] = (own[0] - place[4] * out[1]) / place[0];
        if (vec3_dot(out, d) > -0.05 * vec3_length(out))
            continue; /* at silhouettes facets are not the ellipsoid */
        worst = fmax(worst, degrees_between(n, out));
        count++;
    }
    print_message("at a place: %.3f degrees at most, %d pixels\n", worst, count);
    assert_true(count > 100 && worst < 0.5);
    leafcast_close(v);
}

/* Vertices without a normal: as if there were none at all. */
static void test_none(void **state) {
    static picture flat, is;
    (void)state;
    draw(convert(2, BARE, LEAFCAST_NORMALS_FILE, 64, 0), plain(), &flat);
    draw(convert(2, HOLED, LEAFCAST_NORMALS_FILE, 64, 1), plain(), &is);
    assert_memory_equal(is.normal, flat.normal, sizeof is.normal);
    assert_memory_equal(is.rgba, flat.rgba, sizeof is.rgba);
    assert_memory_equal(is.z, flat.z, sizeof is.z);
}

static triangle triangle_of(const double normal[3][3]) {
    triangle x = {.p = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, .smooth = true};
    for (int k = 0; k < 3; k++)
        x.normal[k] = triangle_normal_encode(normal[k]);
    return x;
}

/* By hand: corners, edges, the middle; sums that cancel; a ray that is long; from behind. */
static void test_kernel(void **state) {
    static const double of[3][3] = {{1, 0, 1}, {0, 1, 1}, {-1, -1, 1}}, out[3] = {0, 0, 1},
                        across[3][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}};
    (void)state;
    const triangle x = triangle_of(of), odd = triangle_of(across);
    const triangle_smooth s = triangle_smooth_of(&x), cancels = triangle_smooth_of(&odd);
    assert_true(s.any && cancels.any);
    for (int i = 0; i <= 8; i++)
        for (int k = 0; i + k <= 8; k++)
            for (int behind = 0; behind < 2; behind++) {
                const double u = 0.5 * i, v = 0.5 * k, z = behind ? -8.0 : 8.0;
                const ray r = {.o = {u, v, z}, .d = {0, 0, -z / 4}};
                double want[3] = {0, 0, 0}, got[3];
                float n[3] = {0, 0, 1};
                const double share[3] = {1 - (u + v) / 4, u / 4, v / 4};
                for (int c = 0; c < 3; c++)
                    for (int a = 0; a < 3; a++)
                        want[a] += share[c] * of[c][a] / vec3_length(of[c]);
                triangle_smooth_normal(&s, &r, 4.0, n);
                for (int a = 0; a < 3; a++)
                    got[a] = (double)n[a];
                assert_true(degrees_between(got, want) < 0.01);
                assert_true(vec3_dot(got, out) > 0.0);
            }
    const ray middle_ray = {.o = {2, 0, 1}, .d = {0, 0, -1}};
    float n[3] = {0, 0, 1};
    triangle_smooth_normal(&cancels, &middle_ray, 1.0, n);
    assert_true(n[0] == 0.0f && n[1] == 0.0f && n[2] == 1.0f);
    /* Turned to the triangle's side, then until the eye just sees it. */
    const ray low = {.o = {9, 0.5, 1}, .d = {-8, 0, -1}};
    float bent[3] = {0, 0, 1};
    static const double away[3][3] = {{1, 0, -0.5}, {1, 0, -0.5}, {1, 0, -0.5}};
    const triangle turned = triangle_of(away);
    const triangle_smooth t = triangle_smooth_of(&turned);
    triangle_smooth_normal(&t, &low, 1.0, bent);
    const double unit[3] = {(double)bent[0], (double)bent[1], (double)bent[2]};
    const double cosine = -vec3_dot(unit, low.d) / vec3_length(low.d);
    assert_true(cosine > 0.99 * 0x1p-10 && cosine < 0.01 && unit[2] > 0.0);
    /* One vertex without a normal; and a triangle without an area. */
    triangle lacks = x;
    lacks.normal[2] = TRIANGLE_NO_NORMAL;
    assert_false(triangle_smooth_of(&lacks).any);
    triangle line = x;
    line.p[2][0] = 8.0f;
    line.p[2][1] = 0.0f;
    assert_false(triangle_smooth_of(&line).any);
}

/* Two steps of a ball, the second half as high, whose normals point from the middle: so they do
 * between the steps, but for what the mean of two unit vectors is off. */
static void test_between(void **state) {
    static picture is;
    (void)state;
    const char *paths[2];
    make_ball(&sphere, 3);
    paths[0] = write_ball(&sphere, EXACT, "first.ply");
    for (uint32_t i = 0; i < sphere.points; i++)
        sphere.at[i][2] *= 0.5;
    paths[1] = write_ball(&sphere, EXACT, "second.ply");
    const leafcast_convert_options o = {.size = sizeof o, .replace = true, .treelet_tets = 100};
    assert_int_equal(leafcast_convert_steps(paths, 2, NULL, scratch_path("two.leaf"), &o),
                     LEAFCAST_OK);
    for (int half = 0; half < 3; half++) {
        leafcast *v = fixture_open(scratch_path("two.leaf"), NULL);
        leafcast_stats stats = {.size = sizeof stats};
        double sum = 0.0;
        int count = 0;
        select_one(v);
        if (half == 1)
            assert_int_equal(leafcast_select_between(v, 0, 0, 0.5), LEAFCAST_OK);
        else
            assert_int_equal(leafcast_select_set(v, 0, half / 2), LEAFCAST_OK);
        const leafcast_camera c = leafcast_standard_view(v, 1.2, PICTURE_WIDTH, PICTURE_HEIGHT);
        pictures_draw(v, plain(), &c, &is, &stats);
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            double from[3], d[3], n[3], out[3];
            if (!is_hit(&is, i))
                continue;
            ray_of(&c, i, from, d);
            for (int a = 0; a < 3; a++)
                out[a] = from[a] + is.z[i] * d[a] - middle[a];
            normal_at(&is, i, n);
            sum += degrees_between(n, out);
            count++;
        }
        print_message("%d halves: %.3f degrees\n", half, sum / count);
        assert_true(count > 100 && sum / count < (half == 0 ? 0.01 : 1.0));
        leafcast_close(v);
    }
}

/* In memory, while they move: normals are made anew, as of a file of these positions; never those
 * of before. */
static void test_moving(void **state) {
    static picture moved, fixed, before;
    static float xyz[POINTS][3];
    (void)state;
    leafcast_stats stats = {.size = sizeof stats};
    leafcast *v;
    make_ball(&sphere, 3);
    const leafcast_triangles of = {.size = sizeof of,
                                   .vertex_count = sphere.points,
                                   .triangle_count = sphere.faces,
                                   .vertices = (const float(*)[3])xyz,
                                   .triangles = (const uint32_t(*)[3])sphere.row,
                                   .smooth = true};
    for (int step = 0; step < 3; step++) {
        for (uint32_t i = 0; i < sphere.points; i++) {
            sphere.at[i][2] *= step ? 0.6 : 1.0;
            for (int a = 0; a < 3; a++)
                xyz[i][a] = (float)(sphere.at[i][a] + middle[a]);
        }
        if (step == 0) {
            assert_int_equal(leafcast_open_triangles(&of, NULL, &v), LEAFCAST_OK);
            select_one(v);
        } else {
            assert_int_equal(leafcast_update_vertices(v, (const float(*)[3])xyz, sphere.points),
                             LEAFCAST_OK);
        }
        const leafcast_convert_options o = {
            .size = sizeof o, .replace = true, .normals = LEAFCAST_NORMALS_SMOOTH};
        assert_int_equal(leafcast_convert_path(write_ball(&sphere, BARE, "ball.ply"),
                                               scratch_path("ball.leaf"), &o),
                         LEAFCAST_OK);
        draw(scratch_path("ball.leaf"), plain(), &fixed);
        const leafcast_camera c = view_of(scratch_path("ball.leaf"));
        pictures_draw(v, plain(), &c, &moved, &stats);
        assert_memory_equal(moved.z, fixed.z, sizeof moved.z);
        int other = 0;
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            double n[3], want[3], old[3];
            if (!is_hit(&fixed, i))
                continue;
            normal_at(&moved, i, n);
            normal_at(&fixed, i, want);
            normal_at(&before, i, old);
            /* Sums of another order may round to the code beside. */
            assert_true(degrees_between(n, want) < 0.01);
            other += degrees_between(n, old) > 1.0;
        }
        assert_true(step == 0 || other > 100);
        before = moved;
    }
    leafcast_close(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),   cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_probes),   cmocka_unit_test(test_silhouettes),
        cmocka_unit_test(test_no_leaks), cmocka_unit_test(test_placed),
        cmocka_unit_test(test_none),     cmocka_unit_test(test_kernel),
        cmocka_unit_test(test_between),  cmocka_unit_test(test_moving),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
