#include "tests/support/pictures.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "tests/support/fixture.h"

/* A picture and what it took. */
static leafcast_status try_draw(leafcast *volume, const leafcast_scene *scene,
                                const leafcast_camera *view, picture *p, leafcast_stats *stats) {
    memset(p, 0, sizeof *p);
    const leafcast_image image = {.size = sizeof image,
                                  .r = p->rgba[0],
                                  .g = p->rgba[1],
                                  .b = p->rgba[2],
                                  .a = p->rgba[3],
                                  .z = p->z,
                                  .normal = {p->normal[0], p->normal[1], p->normal[2]},
                                  .id = p->id,
                                  .provisional = p->provisional};
    return leafcast_trace(volume, scene, view, &image, stats, NULL, NULL);
}

void pictures_draw(leafcast *volume, const leafcast_scene *scene, const leafcast_camera *view,
                   picture *p, leafcast_stats *stats) {
    const leafcast_status st = try_draw(volume, scene, view, p, stats);
    if (st != LEAFCAST_OK)
        print_message("# %s\n", leafcast_error_text());
    assert_int_equal(st, LEAFCAST_OK);
}

size_t pictures_least_memory(leafcast *volume, const leafcast_scene *scene,
                             const leafcast_camera *view) {
    static picture p;
    unsigned long long enough = 0;
    assert_int_equal(try_draw(volume, scene, view, &p, NULL), LEAFCAST_NOMEM);
    const char *text = strstr(leafcast_error_text(), "picture: ");
    assert_non_null(text);
    assert_int_equal(sscanf(text, "picture: %llu bytes would do", &enough), 1);
    return (size_t)enough;
}

void pictures_open_one(picture_volumes *v, const char *path, const char *isa, int threads) {
    const leafcast_options o = {.size = sizeof(leafcast_options), .isa = isa, .threads = threads};
    v->name[v->count] = isa;
    v->of[v->count++] = fixture_open(path, &o);
}

bool pictures_same_pixel(const picture *a, const picture *b, int i) {
    bool same = memcmp(&a->z[i], &b->z[i], sizeof a->z[i]) == 0 && a->id[i] == b->id[i];
    for (int c = 0; c < 4; c++)
        same &= memcmp(&a->rgba[c][i], &b->rgba[c][i], sizeof a->rgba[c][i]) == 0;
    for (int c = 0; c < 3; c++)
        same &= memcmp(&a->normal[c][i], &b->normal[c][i], sizeof a->normal[c][i]) == 0;
    return same;
}

picture_volumes pictures_open(const char *path, int threads) {
    picture_volumes v = {.count = 0};
    for (int isa = 0; isa <= (int)cpu_best(); isa++)
        pictures_open_one(&v, path, cpu_isa_name((cpu_isa)isa), threads);
    return v;
}

void pictures_close(picture_volumes *v) {
    for (int isa = 0; isa < v->count; isa++)
        leafcast_close(v->of[isa]);
}

void pictures_select(picture_volumes *v, const leafcast_surface *surfaces, int count) {
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
int pictures_alike(const picture_volumes *v, const leafcast_scene *scene,
                   const leafcast_camera *view, const char *what) {
    static picture want, got;
    leafcast_stats single = {.size = sizeof(leafcast_stats)},
                   tiled = {.size = sizeof(leafcast_stats)};
    int hits = 0;
    pictures_draw(v->of[CPU_SCALAR], scene, view, &want, &single);
    for (int i = 0; i < PICTURE_PIXELS; i++)
        hits += want.id[i] >= 0;
    for (int isa = 1; isa < v->count; isa++) {
        for (int again = 0; again < 2; again++) {
            pictures_draw(v->of[isa], scene, view, &got, &tiled);
            const size_t z = differing(want.z, got.z, sizeof *want.z, PICTURE_PIXELS);
            const size_t id = differing(want.id, got.id, sizeof *want.id, PICTURE_PIXELS);
            const size_t normal =
                differing(want.normal, got.normal, sizeof(float), 3 * PICTURE_PIXELS);
            const size_t rgba = differing(want.rgba, got.rgba, sizeof(float), 4 * PICTURE_PIXELS);
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
leafcast_camera pictures_view(const leafcast *volume, int kind, field_random *r) {
    const leafcast_info info = leafcast_describe(volume);
    leafcast_camera c = {.size = sizeof(leafcast_camera),
                         .up = {0.1, 0.2, 1.0},
                         .fov = 45.0,
                         .width = PICTURE_WIDTH,
                         .height = PICTURE_HEIGHT};
    double reach = 0.0;
    for (int a = 0; a < 3; a++)
        reach = fmax(reach, info.bounds[1][a] - info.bounds[0][a]);
    for (int a = 0; a < 3; a++) {
        const double lo = info.bounds[0][a], hi = info.bounds[1][a];
        const double cell = info.dims[a] > 0 ? (hi - lo) / (info.dims[a] - 1) : info.cell_size;
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

leafcast_scene pictures_scene(int kind, const leafcast_info *info) {
    leafcast_scene s = leafcast_scene_default();
    s.shading = (leafcast_shading)(kind % 3);
    s.background[0] = 0.3f;
    s.background[3] = kind % 2 ? 0.7f : 0.0f;
    s.analytic_normals = kind % 4 == 1;
    s.layers_max = kind % 5 == 2;
    if (kind % 3 == 1) {
        s.light_count = 2;
        s.lights[0] = (leafcast_light){false, {1, 0.5, 2}, {0.8f, 0.8f, 0.7f}, 0};
        s.lights[1] = (leafcast_light){true, {200, -80, 90}, {0.3f, 0.3f, 0.4f}, 0};
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

/* ---- Layers ---- */

int pictures_of_layers(picture_volumes *v, double iso, double step, const char *what) {
    enum { SURFACES = 12 };
    static const int layers[] = {0, 2, 8, 9, 17};
    const leafcast_info info = leafcast_describe(v->of[0]);
    leafcast_surface s[SURFACES];
    field_random r = {23};
    int hits = 0;
    for (int k = 0; k < SURFACES; k++) {
        s[k] = leafcast_surface_default(iso + step * (k - SURFACES / 2));
        s[k].rgb[k % 3] = 0.2f;
        s[k].opacity = k == SURFACES - 1 ? 1.0f : 0.02f + 0.01f * (float)k;
    }
    pictures_select(v, s, SURFACES);
    for (size_t i = 0; i < sizeof layers / sizeof *layers; i++) {
        leafcast_scene scene = pictures_scene(i % 2 ? 13 : 4, &info); /* lights; with shadows */
        const leafcast_camera c = pictures_view(v->of[0], (int)i % 3, &r);
        scene.shading = LEAFCAST_SHADING_PHONG;
        scene.layers_max = layers[i];
        scene.lod = LEAFCAST_LOD_EXACT;
        hits += pictures_alike(v, &scene, &c, what);
    }
    return hits;
}
