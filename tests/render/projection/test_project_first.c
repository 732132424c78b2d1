/* test_project_first.c - `first` where a plateau has just the value that is looked for, and nothing
 * exceeds it: every ray that meets the plateau finds it there, no other ray finds anything. Faces,
 * edges and vertices of grids, faces of meshes; kernels of every kind.
 */
/* marks: bits */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/medium_lab.h"

enum { SIDE = 64, PIXELS = SIDE * SIDE, NODES_MAX = 21 };

typedef struct firsts {
    double value[PIXELS], z[PIXELS];
} firsts;

static void find_firsts(leafcast *v, const leafcast_camera *camera, double wanted, firsts *out) {
    const leafcast_image image = {.size = sizeof image, .value = out->value, .z = out->z};
    leafcast_scene scene = leafcast_scene_default();
    scene.project = LEAFCAST_PROJECT_FIRST;
    scene.project_value = wanted;
    if (leafcast_trace(v, &scene, camera, &image, NULL, NULL, NULL) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

/* By the scalar kernels, and the same bits by all others. */
static void find_by_all(medium_body *b, const leafcast_camera *camera, double wanted, firsts *out) {
    static firsts other;
    for (int isa = 0; isa <= (int)cpu_best(); isa++) {
        const leafcast_options o = {.size = sizeof o, .isa = cpu_isa_name((cpu_isa)isa)};
        assert_int_equal(medium_body_reopen(b, &o), LEAFCAST_OK);
        find_firsts(b->volume, camera, wanted, isa == 0 ? out : &other);
        if (isa > 0)
            assert_memory_equal(out, &other, sizeof other);
    }
}

/* ---- Plateaus of grids ---- */

/* Samples of n^3: `top` where all axes that are fixed have that coordinate, less elsewhere. */
typedef struct plateau {
    long at[3]; /* -1: any */
    uint8_t top;
} plateau;

static void make_samples(const plateau *p, long n, uint8_t *out, field_random *r) {
    for (long z = 0; z < n; z++)
        for (long y = 0; y < n; y++)
            for (long x = 0; x < n; x++) {
                const long i[3] = {x, y, z};
                bool on = true;
                for (int a = 0; a < 3; a++)
                    on = on && (p->at[a] < 0 || p->at[a] == i[a]);
                *out++ = on ? p->top : (uint8_t)field_random_below(r, p->top);
            }
}

/* Where the ray meets the plane in which the plateau is; NaN: not inside the grid. *near: it is so
 * close to the grid's border, or the plane's, that rounding decides. */
static double meets_plane(const ref_ray *ray, const plateau *p, long n, bool *near) {
    int axis = 0;
    long double t, least = 1;
    while (p->at[axis] < 0)
        axis++;
    t = ((long double)p->at[axis] - ray->o[axis]) / ray->d[axis];
    for (int a = 0; a < 3; a++) {
        const long double x = ray->o[a] + t * ray->d[a];
        if (a != axis)
            least = fminl(least, fminl(x, (long double)(n - 1) - x));
    }
    *near = fabsl(least) < 1e-9L;
    return least > 0 && t > 0 ? (double)t : NAN;
}

static void check_face(int axis, long at, long n, uint8_t top, field_random *r) {
    static uint8_t samples[NODES_MAX * NODES_MAX * NODES_MAX];
    static firsts got;
    const long dims[3] = {n, n, n};
    plateau p = {{-1, -1, -1}, top};
    medium_body b;
    int met = 0;
    p.at[axis] = at;
    make_samples(&p, n, samples, r);
    medium_body_of_bytes(&b, "face", dims, samples);
    leafcast_camera camera = leafcast_standard_view(b.volume, 1.6, SIDE, SIDE);
    for (int a = 0; a < 3; a++)
        camera.eye[a] = 0.5 * (double)(n - 1) *
                        (1.0 + field_random_in(r, 1.0, 3.0) * (field_random_below(r, 2) ? 1 : -1));
    find_by_all(&b, &camera, top, &got);
    for (int i = 0; i < PIXELS; i++) {
        ref_ray ray;
        bool near;
        leafcast_pixel_ray(&camera, i % SIDE + 0.5, i / SIDE + 0.5, ray.o, ray.d);
        const double t = meets_plane(&ray, &p, n, &near);
        if (near)
            continue;
        met += !isnan(t);
        if (isnan(t) ? !isnan(got.value[i])
                     : !(got.value[i] == top && fabs(got.z[i] - t) < 1e-9 * (double)n))
            fail_msg("axis %d at %ld of %ld, pixel %d: %g at %.17g, not %d at %.17g", axis, at, n,
                     i, got.value[i], got.z[i], top, t);
    }
    assert_true(met > PIXELS / 100);
    medium_body_release(&b);
}

static void test_faces(void **state) {
    static const long sizes[] = {3, 8, NODES_MAX};
    field_random r = {7};
    (void)state;
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            for (int side = 0; side < 3; side++)
                check_face(axis, side * (sizes[i] - 1) / 2, sizes[i], side == 1 ? 97 : 255, &r);
}

/* Rays along z through the nodes: pixel (2 x, 2 y) is the node (x, y), others lie between. */
static leafcast_camera along_z(long n) {
    const double middle = 0.5 * (double)(n - 1), high = 0.5 * SIDE;
    return (leafcast_camera){.size = sizeof(leafcast_camera),
                             .eye = {0.25 * (SIDE - 1.0), 0.25 * (SIDE - 1.0), -4.0},
                             .look_at = {0.25 * (SIDE - 1.0), 0.25 * (SIDE - 1.0), middle},
                             .up = {0.0, -1.0, 0.0},
                             .width = SIDE,
                             .height = SIDE,
                             .ortho_height = high};
}

/* An edge along z, one across, a vertex: met by rays through nodes alone, or between two of them.
 */
static void test_edges_and_vertices(void **state) {
    static const plateau of[] = {{{3, 4, -1}, 255}, {{-1, 4, 5}, 201}, {{3, 4, 5}, 255},
                                 {{0, 4, 8}, 99},   {{8, 8, 0}, 255},  {{8, -1, 8}, 77}};
    static uint8_t samples[9 * 9 * 9];
    static firsts got;
    const long n = 9, dims[3] = {9, 9, 9};
    field_random r = {8};
    (void)state;
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        const plateau *p = &of[k];
        const leafcast_camera camera = along_z(n);
        medium_body b;
        int met = 0;
        make_samples(p, n, samples, &r);
        medium_body_of_bytes(&b, "edge", dims, samples);
        find_by_all(&b, &camera, p->top, &got);
        for (int i = 0; i < PIXELS; i++) {
            double o[3], d[3];
            leafcast_pixel_ray(&camera, i % SIDE + 0.5, i / SIDE + 0.5, o, d);
            assert_true(d[0] == 0.0 && d[1] == 0.0 && d[2] == 1.0);
            const bool on_x = p->at[0] < 0 ? o[0] >= 0.0 && o[0] <= 8.0 : o[0] == (double)p->at[0];
            const bool on_y = p->at[1] < 0 ? o[1] >= 0.0 && o[1] <= 8.0 : o[1] == (double)p->at[1];
            const double z = p->at[2] < 0 ? 4.0 : 4.0 + (double)p->at[2];
            met += on_x && on_y;
            if (on_x && on_y ? !(got.value[i] == p->top && got.z[i] == z) : !isnan(got.value[i]))
                fail_msg("plateau %zu, (%g, %g): %.17g at %g", k, o[0], o[1], got.value[i],
                         got.z[i]);
        }
        assert_true(met >= 1);
        medium_body_release(&b);
    }
}

/* ---- Other thresholds ---- */

/* What is less than all data is reached where they begin; data of floats lose no digit for it. */
static void test_below_all(void **state) {
    static const double below[] = {-1e300, -1e6, 0.0};
    static firsts got, meant;
    (void)state;
    for (int i = 0; i < medium_body_count(); i += 5) {
        medium_body b;
        medium_body_make(&b, i, NULL);
        const leafcast_camera camera = leafcast_standard_view(b.volume, 2.2, SIDE, SIDE);
        double range[2];
        assert_int_equal(leafcast_range(b.volume, 0, 0, range), LEAFCAST_OK);
        find_firsts(b.volume, &camera, range[0], &meant);
        for (int k = 0; k < 3; k++)
            if (below[k] <= range[0]) {
                find_firsts(b.volume, &camera, below[k], &got);
                assert_memory_equal(&got, &meant, sizeof got);
            }
        medium_body_release(&b);
    }
}

/* ---- Plateaus of meshes ---- */

static double ridge(const double p[3]) {
    return p[0] == 2.0 ? 255.0 : 255.0 - 63.0 * fabs(p[0] - 2.0) - p[1];
}

static void test_meshes(void **state) {
    static firsts got;
    static const int n[3] = {4, 4, 4};
    static const double origin[3] = {0.0, 0.0, 0.0};
    const plateau p = {{2, -1, -1}, 255};
    lab_mesh mesh;
    int met = 0;
    (void)state;
    lab_mesh_kuhn(&mesh, n, origin, 1.0, ridge);
    leafcast *v = fixture_open(lab_leaf_make(&mesh, 60, false), NULL);
    leafcast_camera camera = leafcast_standard_view(v, 2.2, SIDE, SIDE);
    find_firsts(v, &camera, 255.0, &got);
    for (int i = 0; i < PIXELS; i++) {
        ref_ray ray;
        bool near;
        leafcast_pixel_ray(&camera, i % SIDE + 0.5, i / SIDE + 0.5, ray.o, ray.d);
        const double t = meets_plane(&ray, &p, 5, &near);
        met += !isnan(t);
        if (!near && (isnan(t) ? !isnan(got.value[i])
                               : !(got.value[i] == 255.0 && fabs(got.z[i] - t) < 1e-6)))
            fail_msg("pixel %d: %g at %.17g, not at %.17g", i, got.value[i], got.z[i], t);
    }
    assert_true(met > PIXELS / 100);
    leafcast_close(v);
    lab_mesh_release(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_faces), cmocka_unit_test(test_edges_and_vertices),
        cmocka_unit_test(test_below_all), cmocka_unit_test(test_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
