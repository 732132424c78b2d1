/* test_mesh_smooth.c - smooth normals of meshes: barycentric, exact for linear fields, closer to a
 * round field's the finer the mesh; the same bits from all kernels; a matter of shading alone. */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "render/mesh/tet_smooth.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"

#ifdef __SANITIZE_ADDRESS__
enum { CUBES = 4, FINEST = 16 };
#else
enum { CUBES = 7, FINEST = 32 };
#endif

static const double PI = 3.14159265358979323846;

static leafcast_scene smooth_scene(void) {
    leafcast_scene scene = leafcast_scene_default();
    scene.smooth_normals = true;
    return scene;
}

/* ---- the interpolation ---- */

static long double volume(const long double p[4][3]) {
    long double e[3][3], sum = 0;
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
            e[i][a] = p[i + 1][a] - p[0][a];
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        sum += e[0][a] * (e[1][b] * e[2][c] - e[1][c] * e[2][b]);
    }
    return sum;
}

/* By barycentric coordinates in the tet. */
static void interpolate(const tet *x, const float gradients[4][3], const long double at[3],
                        long double out[3]) {
    long double p[4][3];
    memset(out, 0, 3 * sizeof *out);
    for (int k = 0; k < 4; k++)
        for (int a = 0; a < 3; a++)
            p[k][a] = (long double)x->p[k][a];
    const long double all = volume((const long double(*)[3])p);
    for (int k = 0; k < 4; k++) {
        long double q[4][3];
        memcpy(q, p, sizeof q);
        memcpy(q[k], at, sizeof q[k]);
        const long double weight = volume((const long double(*)[3])q) / all;
        for (int a = 0; a < 3; a++)
            out[a] += weight * (long double)gradients[k][a];
    }
}

static float random_float(field_random *r) {
    return (float)(field_random_bits(r) % 2001) * 0.001F - 1.0F;
}

static void random_case(field_random *r, tet *x, float gradients[4][3], ray *look) {
    for (int k = 0; k < 4; k++) {
        x->f[k] = random_float(r);
        for (int a = 0; a < 3; a++) {
            x->p[k][a] = random_float(r);
            gradients[k][a] = random_float(r);
        }
    }
    *look = (ray){.t0 = 0, .t1 = INFINITY};
    for (int a = 0; a < 3; a++) {
        double aim = 0;
        for (int k = 0; k < 4; k++)
            aim += 0.25 * (double)x->p[k][a];
        look->o[a] = 4 * (double)random_float(r);
        look->d[a] = aim + 0.2 * (double)random_float(r) - look->o[a];
    }
}

static void test_interpolation(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    int triangles = 0, quads = 0;
    for (int n = 0; n < 40000; n++) {
        tet x;
        float gradients[4][3], normal[3];
        ray look;
        isopolygon g;
        hit h;
        tet_smooth s;
        const hit before = hit_before_all();
        random_case(&r, &x, gradients, &look);
        double gradient[3];
        if (!isopolygon_of(&x, 0, &g) || !flat_polygon_hit(&g, &look, 0, 0, &before, &h) ||
            !tet_gradient(&x, gradient))
            continue;
        long double at[3], want[3], length = 0, largest = 0, p[4][3];
        for (int a = 0; a < 3; a++)
            at[a] = (long double)look.o[a] + (long double)h.t * (long double)look.d[a];
        interpolate(&x, (const float(*)[3])gradients, at, want);
        for (int a = 0; a < 3; a++)
            length += want[a] * want[a];
        for (int k = 0; k < 4; k++)
            for (int a = 0; a < 3; a++)
                p[k][a] = (long double)x.p[k][a];
        /* Slivers and gradients that cancel magnify what a point is off. */
        largest = fabsl(volume((const long double(*)[3])p));
        if (largest < 1e-3L || length < 1e-2L)
            continue;
        tet_smooth_of(&x, 0, &g, (const float(*)[3])gradients, &s);
        assert_true(tet_smooth_normal(&s, look.o, look.d, h.t, normal));
        for (int a = 0; a < 3; a++)
            if (fabsl((long double)normal[a] + want[a] / sqrtl(length)) > 3e-7L)
                fail_msg("case %d: %.9g, not %.9Lg", n, (double)normal[a],
                         -want[a] / sqrtl(length));
        triangles += g.count == 3;
        quads += g.count == 4;
    }
    assert_true(triangles > 2000 && quads > 1000);
}

/* Nothing to go by: the normal stays. */
static void test_without(void **state) {
    (void)state;
    const tet x = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 1, 1, 1}};
    const double o[3] = {0, 0, 0}, d[3] = {1, 1, 1};
    const float kept[3] = {5, 6, 7};
    float gradients[4][3] = {{0}}, normal[3] = {5, 6, 7};
    isopolygon g;
    tet_smooth s;
    assert_true(isopolygon_of(&x, 0.5, &g));
    for (int i = 0; i < 3; i++) {
        if (i > 0)
            gradients[0][1] = gradients[1][1] = i == 1 ? NAN : INFINITY;
        tet_smooth_of(&x, 0.5, &g, (const float(*)[3])gradients, &s);
        assert_false(tet_smooth_normal(&s, o, d, 1.0 / 6, normal));
        assert_memory_equal(normal, kept, sizeof kept);
    }
    /* Huge and tiny ones have a direction. */
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 4; k++)
            for (int a = 0; a < 3; a++)
                gradients[k][a] = a == 1 ? (i ? 3e38F : 1e-44F) : 0;
        tet_smooth_of(&x, 0.5, &g, (const float(*)[3])gradients, &s);
        assert_true(tet_smooth_normal(&s, o, d, 1.0 / 6, normal));
        assert_true(normal[0] == 0 && normal[1] == -1 && normal[2] == 0);
    }
}

/* ---- fields whose normals are known ---- */

static double linear(const double p[3]) {
    return 2 * p[0] - 3 * p[1] + 0.5 * p[2];
}

static double round_field(const double p[3]) {
    return -sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

static leafcast *open_kuhn(int n, double (*f)(const double p[3]), double iso) {
    lab_mesh lab;
    const int cubes[3] = {n, n, n};
    const double origin[3] = {-1, -1, -1};
    lab_mesh_kuhn(&lab, cubes, origin, 2.0 / n, f);
    leafcast *v = fixture_open(lab_leaf_make(&lab, 500, true), NULL);
    const leafcast_surface s = leafcast_surface_default(iso);
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    lab_mesh_release(&lab);
    return v;
}

static void test_linear(void **state) {
    (void)state;
    static picture p;
    const double length = sqrt(4 + 9 + 0.25), want[3] = {-2 / length, 3 / length, -0.5 / length};
    leafcast *v = open_kuhn(8, linear, 0.3);
    const leafcast_scene scene = smooth_scene();
    leafcast_stats stats = {.size = sizeof stats};
    field_random r = {4};
    int hits = 0;
    for (int kind = 0; kind < PICTURE_VIEWS; kind++) {
        const leafcast_camera c = pictures_view(v, kind, &r);
        pictures_draw(v, &scene, &c, &p, &stats);
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            hits += p.id[i] == 0;
            for (int a = 0; a < 3; a++)
                if (p.id[i] == 0 && fabs((double)p.normal[a][i] - want[a]) > 0x1p-24)
                    fail_msg("view %d, pixel %d: %.9g, not %.9g", kind, i, (double)p.normal[a][i],
                             want[a]);
        }
    }
    leafcast_close(v);
    assert_true(hits > PICTURE_PIXELS);
}

/* The root mean square of the angles between a sphere's normals and the picture's, in degrees. */
static double error_of(leafcast *v, const leafcast_scene *scene, double *worst) {
    static picture p;
    leafcast_stats stats = {.size = sizeof stats};
    const leafcast_camera c = leafcast_standard_view(v, 1.6, PICTURE_WIDTH, PICTURE_HEIGHT);
    double sum = 0, hits = 0;
    *worst = 0;
    pictures_draw(v, scene, &c, &p, &stats);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double o[3], d[3], at[3], radius = 0, cosine = 0;
        if (p.id[i] != 0)
            continue;
        leafcast_pixel_ray(&c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        for (int a = 0; a < 3; a++) {
            at[a] = o[a] + p.z[i] * d[a];
            radius += at[a] * at[a];
        }
        for (int a = 0; a < 3; a++)
            cosine += at[a] / sqrt(radius) * (double)p.normal[a][i];
        const double angle = acos(fmin(cosine, 1)) * 180 / PI;
        *worst = fmax(*worst, angle);
        sum += angle * angle;
        hits++;
    }
    assert_true(hits > PICTURE_PIXELS / 20.0);
    return sqrt(sum / hits);
}

static void test_round(void **state) {
    (void)state;
    const leafcast_scene smooth = smooth_scene(), faceted = leafcast_scene_default();
    double before[2] = {0, 0};
    print_message("cubes   faceted: rms, worst   smooth: rms, worst (degrees)\n");
    for (int n = 4; n <= FINEST; n *= 2) {
        leafcast *v = open_kuhn(n, round_field, -0.61);
        double worst[2];
        const double error[2] = {error_of(v, &faceted, &worst[0]), error_of(v, &smooth, &worst[1])};
        print_message("%2d^3    %6.3f %6.3f          %6.3f %6.3f\n", n, error[0], worst[0],
                      error[1], worst[1]);
        assert_true(error[1] < 0.5 * error[0]);
        if (n > 4)
            assert_true(error[0] < before[0] / 1.6 && error[1] < before[1] / 2.2);
        memcpy(before, error, sizeof before);
        leafcast_close(v);
    }
}

/* ---- pictures ---- */

static void test_alike(void **state) {
    (void)state;
    field_random r = {6};
    int hits = 0;
    for (int i = 0; i < lab_mesh_count(); i++) {
        lab_mesh lab;
        assert_true(lab_mesh_make(&lab, lab_mesh_name(i), CUBES, 7));
        picture_volumes v = pictures_open(lab_leaf_make(&lab, 150, true), 2);
        const leafcast_surface s = leafcast_surface_default(lab.iso);
        leafcast_scene scene = smooth_scene();
        scene.shadows = i % 3 == 2;
        scene.light_count = i % 3 ? 1 : 0;
        scene.lights[0] = (leafcast_light){.vector = {1, 2, 3}, .rgb = {1, 1, 1}};
        pictures_select(&v, &s, 1);
        for (int kind = i % 3; kind < PICTURE_VIEWS; kind += 3) {
            const leafcast_camera c = pictures_view(v.of[0], kind, &r);
            hits += pictures_alike(&v, &scene, &c, lab.name);
        }
        pictures_close(&v);
        lab_mesh_release(&lab);
    }
    print_message("%d surfaces\n", hits);
    assert_true(hits > 20000);
}

/* Gradients are read when they are asked for, and change normals and colours alone; with one
 * treelet at a time, too. */
static void test_shading_alone(void **state) {
    (void)state;
    static picture faceted, smooth, again;
    lab_mesh lab;
    leafcast_stats before = {.size = sizeof(leafcast_stats)},
                   with = {.size = sizeof(leafcast_stats)},
                   after = {.size = sizeof(leafcast_stats)};
    assert_true(lab_mesh_make(&lab, "noise", CUBES, 7));
    const char *path = lab_leaf_make(&lab, 100, true);
    for (uint32_t limit = 0; limit < 2; limit++) {
        const leafcast_options o = {.size = sizeof(leafcast_options),
                                    .threads = 2,
                                    .experiments = EXPERIMENTS(.treelet_limit = limit)};
        leafcast *v = fixture_open(path, &o);
        const leafcast_surface s = leafcast_surface_default(lab.iso);
        const leafcast_scene scene = leafcast_scene_default(), other = smooth_scene();
        const leafcast_camera c = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
        assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
        pictures_draw(v, &scene, &c, &faceted, &before);
        pictures_draw(v, &other, &c, limit ? &again : &smooth, &with);
        if (limit)
            assert_memory_equal(&smooth, &again, sizeof smooth);
        assert_memory_equal(faceted.z, smooth.z, sizeof faceted.z);
        assert_memory_equal(faceted.id, smooth.id, sizeof faceted.id);
        assert_memory_not_equal(faceted.normal, smooth.normal, sizeof faceted.normal);
        assert_memory_not_equal(faceted.rgba, smooth.rgba, sizeof faceted.rgba);
        assert_true(with.bytes_active > before.bytes_active);
        if (!limit)
            assert_true(with.bytes_read > before.bytes_read);
        pictures_draw(v, &scene, &c, &again, &after);
        assert_memory_equal(&faceted, &again, sizeof faceted);
        assert_int_equal(after.bytes_active, before.bytes_active);
        leafcast_close(v);
    }
    lab_mesh_release(&lab);
}

static void test_refused(void **state) {
    (void)state;
    static picture p;
    lab_mesh lab;
    const leafcast_scene scene = smooth_scene();
    const leafcast_image image = {.size = sizeof(leafcast_image), .r = p.rgba[0]};
    assert_true(lab_mesh_make(&lab, "sphere", CUBES, 7));
    const char *mesh = lab_leaf_make(&lab, 100, false);
    field f;
    assert_true(field_make(&f, "sphere", 12, FIELD_SEED));
    const char *const paths[] = {mesh, fixture_leaf(&f, 4, 1, false)};
    const char *const said[] = {"convert --gradients", "smooth normals are for meshes"};
    for (int i = 0; i < 2; i++) {
        leafcast *v = fixture_open(paths[i], NULL);
        const leafcast_surface s = leafcast_surface_default(0.3);
        const leafcast_camera c = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
        assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
        assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_USAGE);
        assert_non_null(strstr(leafcast_error_text(), said[i]));
        leafcast_close(v);
    }
    field_release(&f);
    lab_mesh_release(&lab);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_interpolation), cmocka_unit_test(test_without),
        cmocka_unit_test(test_linear),        cmocka_unit_test(test_round),
        cmocka_unit_test(test_alike),         cmocka_unit_test(test_shading_alone),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
