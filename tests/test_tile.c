/* test_tile.c - tiles of rays give the bits of single rays: every ISA, any view, scene and field.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "render/kernels.h"
#include "tests/support/fixture.h"
#include "tests/support/tile_wide.h"

/* No multiple of a tile's side. */
enum { WIDTH = 75, HEIGHT = 53, PIXELS = WIDTH * HEIGHT };

typedef struct picture {
    float rgba[4][PIXELS], normal[3][PIXELS];
    double z[PIXELS];
    int32_t id[PIXELS];
    uint8_t provisional[PIXELS];
} picture;

/* A picture and what it took. */
static void draw(leafcast *volume, const leafcast_scene *scene, const leafcast_camera *view,
                 picture *p, leafcast_stats *stats) {
    memset(p, 0, sizeof *p);
    const leafcast_image image = {p->rgba[0], p->rgba[1],
                                  p->rgba[2], p->rgba[3],
                                  p->z,       {p->normal[0], p->normal[1], p->normal[2]},
                                  p->id,      p->provisional};
    assert_int_equal(leafcast_trace(volume, scene, view, &image, stats, NULL, NULL), LEAFCAST_OK);
}

/* The same file opened for single rays, then for each ISA with tiles, then for the alternatives
 * that experiment E4 compares. */
typedef struct volumes {
    leafcast *of[16];
    const char *name[16];
    int count;
} volumes;

static void open_one(volumes *v, const char *path, const char *isa, int threads) {
    const leafcast_options o = {.isa = isa, .threads = threads};
    v->name[v->count] = isa;
    v->of[v->count++] = fixture_open(path, &o);
}

static volumes open_all(const char *path, int threads) {
    volumes v = {.count = 0};
    for (int isa = 0; isa <= (int)cpu_best(); isa++)
        open_one(&v, path, cpu_isa_name((cpu_isa)isa), threads);
    return v;
}

static void open_wide(volumes *v, const char *path, int threads) {
    open_one(v, path, "scalar", threads);
    kernels_in_use(v->of[v->count - 1])->tile = tile_trace_wide;
    v->name[v->count - 1] = "wide";
}

static void open_alternatives(volumes *v, const char *path, int threads) {
    static const char *const names[] = {"packets-8x8", "packets-4x4-by-cell", "tiles-by-cell"};
    for (size_t i = 0; i < sizeof names / sizeof *names && cpu_best() > CPU_SCALAR; i++)
        open_one(v, path, names[i], threads);
    open_wide(v, path, threads);
}

static void close_all(volumes *v) {
    for (int isa = 0; isa < v->count; isa++)
        leafcast_close(v->of[isa]);
}

static void select_all(volumes *v, const leafcast_surface *surfaces, int count) {
    for (int isa = 0; isa < v->count; isa++)
        assert_int_equal(leafcast_select(v->of[isa], surfaces, count), LEAFCAST_OK);
}

static size_t differing(const void *a, const void *b, size_t size, size_t count) {
    size_t n = 0;
    for (size_t i = 0; i < count; i++)
        n += memcmp((const char *)a + i * size, (const char *)b + i * size, size) != 0;
    return n;
}

/* All planes of all ISAs are those of single rays. Twice: with treelets still absent, and with all
 * there. Returns the pixels with a surface. */
static int assert_alike(const volumes *v, const leafcast_scene *scene, const leafcast_camera *view,
                        const char *what) {
    static picture want, got;
    leafcast_stats single, tiled;
    int hits = 0;
    draw(v->of[CPU_SCALAR], scene, view, &want, &single);
    for (int i = 0; i < PIXELS; i++)
        hits += want.id[i] >= 0;
    for (int isa = 1; isa < v->count; isa++) {
        for (int again = 0; again < 2; again++) {
            draw(v->of[isa], scene, view, &got, &tiled);
            const size_t z = differing(want.z, got.z, sizeof *want.z, PIXELS);
            const size_t id = differing(want.id, got.id, sizeof *want.id, PIXELS);
            const size_t normal = differing(want.normal, got.normal, sizeof(float), 3 * PIXELS);
            const size_t rgba = differing(want.rgba, got.rgba, sizeof(float), 4 * PIXELS);
            if (z + id + normal + rgba)
                print_message("%s, %s: eye %.17g,%.17g,%.17g to %.17g,%.17g,%.17g up %g,%g,%g fov "
                              "%g: %zu depths, %zu ids, %zu normals, %zu colours differ\n",
                              what, v->name[isa], view->eye[0], view->eye[1], view->eye[2],
                              view->look_at[0], view->look_at[1], view->look_at[2], view->up[0],
                              view->up[1], view->up[2], view->fov, z, id, normal, rgba);
            assert_int_equal(z + id + normal + rgba, 0);
            assert_memory_equal(want.provisional, got.provisional, sizeof want.provisional);
            assert_int_equal(tiled.rays, single.rays);
            assert_int_equal(tiled.ill_conditioned, single.ill_conditioned);
        }
    }
    return hits;
}

/* ---- Views ---- */

/* Cameras around, near and inside a volume, at random and in its planes, narrow and wide. */
static leafcast_camera view_of(const leafcast *volume, int kind, field_random *r) {
    const leafcast_info info = leafcast_describe(volume);
    leafcast_camera c = {.up = {0.1, 0.2, 1.0}, .fov = 45.0, .width = WIDTH, .height = HEIGHT};
    double reach = 0.0;
    for (int a = 0; a < 3; a++)
        reach = fmax(reach, info.bounds[1][a] - info.bounds[0][a]);
    for (int a = 0; a < 3; a++) {
        const double lo = info.bounds[0][a], hi = info.bounds[1][a];
        const double cell = (hi - lo) / (info.dims[a] - 1);
        c.look_at[a] = field_random_in(r, lo, hi);
        c.eye[a] = 0.5 * (lo + hi) + reach * field_random_in(r, -2.5, 2.5);
        if (kind == 1 || kind == 2 || kind == 7) /* inside */
            c.eye[a] = field_random_in(r, lo, hi);
        if (kind == 2) /* on a voxel */
            c.eye[a] = lo + cell * floor((c.eye[a] - lo) / cell);
        if (kind == 3 || kind == 4) /* along an axis: rays in planes between cells */
            c.look_at[a] = lo + cell * floor((c.look_at[a] - lo) / cell);
        if ((kind == 3 || kind == 4) && a > 0)
            c.eye[a] = c.look_at[a];
    }
    if (kind == 3 || kind == 4)
        c.up[0] = c.up[1] = 0.0;
    if (kind == 4)
        c.eye[0] = field_random_in(r, info.bounds[0][0], info.bounds[1][0]);
    if (kind == 5) /* from very far */
        for (int a = 0; a < 3; a++)
            c.eye[a] = c.look_at[a] + 1e4 * (c.eye[a] - c.look_at[a]);
    if (kind == 5 || kind == 6)
        c.fov = kind == 5 ? 0.004 : 0.7;
    if (kind == 7)
        c.fov = 165.0;
    return c;
}

/* Kinds of views; rounds of all kinds, fewer where every access is watched. */
#ifdef __SANITIZE_ADDRESS__
enum { VIEWS = 8, ROUNDS = 1, SCENES = 12 };
#else
enum { VIEWS = 8, ROUNDS = 2, SCENES = 36 };
#endif

static void test_every_field(void **state) {
    (void)state;
    field_random r = {77};
    int hits = 0;
    for (int i = 0; i < field_count(); i++) {
        field f;
        assert_true(field_make(&f, field_name(i), 21, FIELD_SEED));
        const char *path = fixture_leaf(&f, 4, 1, false);
        volumes v = open_all(path, 1);
        open_wide(&v, path, 1);
        const leafcast_surface s = leafcast_surface_default(f.iso);
        select_all(&v, &s, 1);
        const leafcast_scene scene = leafcast_scene_default();
        for (int kind = 0; kind < ROUNDS * VIEWS; kind++) {
            const leafcast_camera c = view_of(v.of[0], kind % VIEWS, &r);
            hits += assert_alike(&v, &scene, &c, f.name);
        }
        close_all(&v);
        field_release(&f);
    }
    print_message("%d surfaces\n", hits);
    assert_true(hits > 40000 * ROUNDS);
}

/* ---- Scenes ---- */

static leafcast_scene scene_of(int kind, const leafcast_info *info) {
    leafcast_scene s = leafcast_scene_default();
    s.intersector = (leafcast_intersector)(kind % 6);
    s.shading = (leafcast_shading)(kind % 3);
    s.background[0] = 0.3f;
    s.background[3] = kind % 2 ? 0.7f : 0.0f;
    s.analytic_normals = kind % 4 == 1;
    s.layers_max = kind % 5 == 2;
    if (kind % 3 == 1) {
        s.light_count = 2;
        s.lights[0] = (leafcast_light){false, {1, 0.5, 2}, {0.8f, 0.8f, 0.7f}};
        s.lights[1] = (leafcast_light){true, {200, -80, 90}, {0.3f, 0.3f, 0.4f}};
        s.shadows = kind % 2;
    }
    s.clip_box = kind % 4 == 2;
    for (int a = 0; a < 3; a++) {
        const double size = info->bounds[1][a] - info->bounds[0][a];
        s.clip_min[a] = info->bounds[0][a] + 0.2 * size;
        s.clip_max[a] = info->bounds[1][a] - 0.1 * size;
    }
    if (kind % 5 == 3) {
        const double centre = 0.5 * (info->bounds[0][0] + info->bounds[1][0]);
        const double plane[4] = {1.0, 0.0, 0.0, -centre};
        memcpy(s.clip_planes[0], plane, sizeof plane);
        s.clip_plane_count = 1;
    }
    s.lod = (leafcast_lod)(kind / 3 % 3);
    s.lod_level = 1;
    return s;
}

static void test_every_scene(void **state) {
    (void)state;
    static const char *const names[] = {"waves", "noise-u8", "rectilinear", "mirrored", "missing"};
    field_random r = {5};
    int hits = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        field f;
        assert_true(field_make(&f, names[i], 40, FIELD_SEED));
        const char *path = fixture_leaf(&f, 4, i != 1, false);
        volumes v = open_all(path, 2);
        open_alternatives(&v, path, 2);
        const leafcast_info info = leafcast_describe(v.of[0]);
        for (int kind = 0; kind < SCENES; kind++) {
            leafcast_surface s[3];
            for (int k = 0; k < 3; k++) {
                s[k] = leafcast_surface_default(f.iso + 0.1 * k * fabs(f.iso));
                s[k].rgb[k] = 0.1f;
                s[k].opacity = kind % 4 == 3 ? 0.4f : 1.0f;
            }
            select_all(&v, s, 1 + kind % 3);
            const leafcast_scene scene = scene_of(kind, &info);
            const leafcast_camera c = view_of(v.of[0], kind % VIEWS, &r);
            hits += assert_alike(&v, &scene, &c, f.name);
        }
        close_all(&v);
        field_release(&f);
    }
    print_message("%d surfaces\n", hits);
    assert_true(hits > 1000 * SCENES);
}

/* ---- What it takes ---- */

/* With few treelets allowed at a time, tiles and single rays take turns; with a preview of what is
 * resident, too. */
static void test_few_treelets(void **state) {
    (void)state;
    static picture want, got;
    field f;
    leafcast_stats stats;
    assert_true(field_make(&f, "waves", 60, FIELD_SEED));
    const char *path = fixture_leaf(&f, 4, 1, false);
    const leafcast_surface s = leafcast_surface_default(f.iso);
    leafcast_scene scene = leafcast_scene_default();
    for (uint32_t limit = 1; limit < 40; limit += 13) {
        for (int isa = 0; isa <= (int)cpu_best(); isa++) {
            const leafcast_options o = {
                .isa = cpu_isa_name((cpu_isa)isa), .threads = 2, .treelet_limit = limit};
            leafcast *v = fixture_open(path, &o);
            assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
            const leafcast_camera c = leafcast_standard_view(v, 1.1, WIDTH, HEIGHT);
            draw(v, &scene, &c, isa == 0 && limit == 1 ? &want : &got, &stats);
            if (isa > 0 || limit > 1)
                assert_memory_equal(&want, &got, sizeof want);
            leafcast_close(v);
        }
    }
    field_release(&f);
}

/* The same treelets count as visible. A tile takes fewer steps than its rays one by one, and finds
 * the same surfaces. */
static void assert_counts(const char *name) {
    static picture p;
    field f;
    assert_true(field_make(&f, name, 60, FIELD_SEED));
    volumes v = open_all(fixture_leaf(&f, 4, 1, false), 2);
    const leafcast_surface s = leafcast_surface_default(f.iso);
    const leafcast_scene scene = leafcast_scene_default();
    select_all(&v, &s, 1);
    for (double distance = 0.6; distance < 3.0; distance += 0.8) {
        const leafcast_camera c = leafcast_standard_view(v.of[0], distance, WIDTH, HEIGHT);
        leafcast_stats single, tiled;
        draw(v.of[CPU_SCALAR], &scene, &c, &p, &single);
        for (int isa = 1; isa < v.count; isa++) {
            for (int again = 0; again < 2; again++)
                draw(v.of[isa], &scene, &c, &p, &tiled);
            assert_int_equal(tiled.bytes_visible, single.bytes_visible);
            assert_true(tiled.nodes < single.nodes);
            assert_true(tiled.roots >= single.roots / 2);
            assert_string_equal(tiled.isa, v.name[isa]);
        }
    }
    close_all(&v);
    field_release(&f);
}

/* Terraces and plateaus: surfaces where rays leave cells. */
static void test_counts(void **state) {
    (void)state;
    assert_counts("waves");
    assert_counts("terraces");
    assert_counts("plateau");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field), cmocka_unit_test(test_every_scene),
        cmocka_unit_test(test_few_treelets), cmocka_unit_test(test_counts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
