/* test_groups.c - groups: the picture of a scene whose groups lie in groups is that of the list of
 * all objects, to the bit, for any budget and threads; as are rays. Of a million objects a ray asks
 * few. What groups cannot have is refused, by name. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/leafcast_dynamic.h"
#include "tests/support/fixture.h"
#include "tests/support/scene_stage.h"

/* Turned, sheared, scaled unevenly, mirrored. */
static const double OUTER[4][12] = {{0.8, -0.5, 0.1, 6, 0.4, 0.7, -0.3, -5, 0.1, 0.3, 0.9, 2},
                                    {-0.6, 0, 0.2, 30, 0.1, 0.5, 0, 8, 0, -0.2, 0.7, 1},
                                    {0.3, 0.2, 0, -4, -0.2, 0.4, 0.1, 22, 0, 0, 1.4, -9},
                                    {0, -0.5, 0, 40, 0, 0, 0.5, 10, 0.5, 0, 0, 12}};
static const double MIDDLE[3][12] = {{1, 0, 0, 20, 0, 0.6, -0.8, 3, 0, 0.8, 0.6, -7},
                                     {-0.5, 0, 0, 5, 0, 0.5, 0.25, 0, 0, 0, 0.5, 11},
                                     {0.75, 0.25, 0, 0, 0, 1, 0, -20, 0, 0, 1, 0}};
static const double INNER[12] = {0.5, 0, 0, 9, 0, 0.5, 0, 1, 0.125, 0, 0.5, 4};

enum { LISTED = 2 + 4 * (1 + 3 * 2) + 3 };

/* Two objects of the scene itself; a group of the grid and, at three places in it, of the mesh and
 * the grid, at four places; and a group of the mesh at three places. */
typedef struct wood {
    scene_pair pair;
    leafcast_places *outer, *middle, *other;
    leafcast_shown own[2], first[1], second[2], third[1];
    leafcast_group inside, groups[2];
    leafcast_scene grouped, listed;
    leafcast_shown list[LISTED];
    double place[LISTED][12];
    int volume[LISTED]; /* of each object, as groups number them */
} wood;

static void follow(double place[12], const double next[12]) {
    double out[12];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++) {
            out[4 * r + c] = c == 3 ? next[4 * r + 3] : 0.0;
            for (int k = 0; k < 3; k++)
                out[4 * r + c] += next[4 * r + k] * place[4 * k + c];
        }
    memcpy(place, out, sizeof out);
}

/* List an object at its own place, then at these; NULL: none. */
static void list(wood *w, int *count, const leafcast_shown *of, int volume, const double *middle,
                 const double *outer) {
    double *place = w->place[*count];
    const double *const next[2] = {middle, outer};
    bool any = of->place != NULL;
    if (any)
        memcpy(place, of->place, 12 * sizeof *place);
    for (int i = 0; i < 2; i++) {
        if (next[i] && any)
            follow(place, next[i]);
        else if (next[i])
            memcpy(place, next[i], 12 * sizeof *place);
        any = any || next[i];
    }
    w->list[*count] = *of;
    w->list[*count].place = any ? place : NULL;
    w->volume[(*count)++] = volume;
}

static void list_all(wood *w) {
    int count = 0;
    for (int i = 0; i < 2; i++)
        list(w, &count, &w->own[i], i, NULL, NULL);
    for (int o = 0; o < 4; o++) {
        list(w, &count, &w->first[0], 2, NULL, OUTER[o]);
        for (int m = 0; m < 3; m++)
            for (int i = 0; i < 2; i++)
                list(w, &count, &w->second[i], 4 + i, MIDDLE[m], OUTER[o]);
    }
    for (int m = 0; m < 3; m++)
        list(w, &count, &w->third[0], 3, NULL, MIDDLE[m]);
    assert_int_equal(count, LISTED);
}

static leafcast_places *places_of(leafcast *v, const double *at, uint32_t count) {
    leafcast_places *made = NULL;
    assert_int_equal(leafcast_make_places(v, at, NULL, count, &made), LEAFCAST_OK);
    return made;
}

static void wood_open(wood *w, const scene_stage *s, const leafcast_options *o, uint32_t treelets) {
    static const double away[12] = {1, 0, 0, 3, 0, 1, 0, -30, 0, 0, 1, 2};
    memset(w, 0, sizeof *w);
    scene_stage_open(&w->pair, s, o, treelets);
    leafcast *v = w->pair.volume[0];
    const leafcast_shown *shown = w->pair.shown;
    w->outer = places_of(v, OUTER[0], 4);
    w->middle = places_of(v, MIDDLE[0], 3);
    w->other = places_of(v, MIDDLE[0], 3);
    w->own[0] = shown[0];
    w->own[1] = shown[1];
    w->own[1].place = away;
    w->first[0] = shown[0];
    w->second[0] = shown[1];
    w->second[1] = shown[0];
    w->second[1].place = INNER;
    w->third[0] = shown[1];
    w->third[0].place = INNER;
    w->inside = (leafcast_group){w->middle, w->second, 2, NULL, 0};
    w->groups[0] = (leafcast_group){w->outer, w->first, 1, &w->inside, 1};
    w->groups[1] = (leafcast_group){w->other, w->third, 1, NULL, 0};
    w->grouped = w->listed = scene_stage_lit(&w->pair);
    w->grouped.volumes = w->own;
    w->grouped.volume_count = 2;
    w->grouped.groups = w->groups;
    w->grouped.group_count = 2;
    list_all(w);
    w->listed.volumes = w->list;
    w->listed.volume_count = LISTED;
}

static void wood_close(wood *w) {
    leafcast_free_places(w->outer);
    leafcast_free_places(w->middle);
    leafcast_free_places(w->other);
    leafcast_free_places(NULL);
    scene_stage_close(&w->pair);
}

/* ---- The same bits ---- */

/* Ids number the surfaces of volumes: the same for all objects of one. */
static void rename_ids(const wood *w, picture *p) {
    int first[LISTED], of[6], id = 0;
    for (int i = 0; i < LISTED; i++) {
        first[i] = id;
        id += w->list[i].count;
    }
    const int counts[6] = {w->own[0].count,   w->own[1].count,    w->first[0].count,
                           w->third[0].count, w->second[0].count, w->second[1].count};
    for (int i = 0, at = 0; i < 6; at += counts[i++])
        of[i] = at;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        int object = LISTED - 1;
        while (p->id[i] >= 0 && first[object] > p->id[i])
            object--;
        if (p->id[i] >= 0)
            p->id[i] += of[w->volume[object]] - first[object];
    }
}

static leafcast_camera view_of_wood(void) {
    leafcast_camera view = scene_stage_view(90);
    return view;
}

/* how: 0: with all memory, on one thread; 1: one treelet at a time, on three. soft: with ambient
 * occlusion. listed: the list of all objects instead. */
static void draw(const scene_stage *s, int how, bool soft, bool listed, picture *p) {
    const leafcast_options o = {.size = sizeof o, .threads = how ? 3 : 1};
    const leafcast_camera view = view_of_wood();
    wood w;
    wood_open(&w, s, &o, how ? 1 : 0);
    leafcast_scene *scene = listed ? &w.listed : &w.grouped;
    scene->occlusion = soft ? 12.0 : 0.0;
    scene->occlusion_samples = 2;
    pictures_draw(w.pair.volume[0], scene, &view, p, NULL);
    if (listed)
        rename_ids(&w, p);
    wood_close(&w);
}

static void groups_are_the_list_of_their_objects(void **state) {
    static picture truth, other;
    for (int soft = 0; soft < 2; soft++) {
        draw(*state, 0, soft, true, &truth);
        draw(*state, soft ? 0 : 1, soft, false, &other);
        scene_stage_same(&truth, &other);
        int covered = 0, grouped = 0;
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            covered += other.id[i] >= 0;
            grouped += other.id[i] >= 3; /* behind the surfaces of the scene itself */
        }
        assert_true(covered > PICTURE_PIXELS / 3 && grouped > PICTURE_PIXELS / 6);
    }
}

static void mirrors_and_glass_see_groups(void **state) {
    static picture truth, other;
    const leafcast_camera view = view_of_wood();
    leafcast_surface mirror = scene_stage_mesh;
    wood w;
    wood_open(&w, *state, NULL, 0);
    mirror.reflectivity = 0.8f;
    mirror.refraction = 1.5f;
    w.own[1].surfaces = w.second[0].surfaces = w.third[0].surfaces = &mirror;
    list_all(&w);
    w.grouped.bounces = w.listed.bounces = 2;
    pictures_draw(w.pair.volume[0], &w.listed, &view, &truth, NULL);
    pictures_draw(w.pair.volume[0], &w.grouped, &view, &other, NULL);
    rename_ids(&w, &truth);
    scene_stage_same(&truth, &other);
    wood_close(&w);
}

/* A mirrored ray that starts on a triangle meets the same one where its volume is placed again. */
static void a_mirror_sees_its_own_volume_elsewhere(void **state) {
    static const float vertices[3][3] = {{-90, -80, 0}, {90, -80, 0}, {0, 90, 0}};
    static const uint32_t triangles[1][3] = {{0, 1, 2}};
    static const double above[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2};
    static picture p;
    (void)state;
    const leafcast_triangles of = {.size = sizeof of,
                                   .vertex_count = 3,
                                   .triangle_count = 1,
                                   .vertices = vertices,
                                   .triangles = triangles};
    const leafcast_surface mirror = {.rgb = {0, 0, 1}, .opacity = 1, .reflectivity = 0.9f},
                           red = {.rgb = {1, 0, 0}, .opacity = 1};
    leafcast *v;
    assert_int_equal(leafcast_open_triangles(&of, NULL, &v), LEAFCAST_OK);
    const leafcast_shown shown[2] = {{.volume = v, .surfaces = &mirror, .count = 1},
                                     {.volume = v, .surfaces = &red, .count = 1, .place = above}};
    leafcast_scene scene = leafcast_scene_default();
    scene.volumes = shown;
    scene.volume_count = 2;
    scene.bounces = 1;
    const leafcast_camera view = {.size = sizeof view,
                                  .eye = {0, -1, 1},
                                  .look_at = {0, 0, 0},
                                  .up = {0, 0, 1},
                                  .fov = 10,
                                  .width = PICTURE_WIDTH,
                                  .height = PICTURE_HEIGHT};
    pictures_draw(v, &scene, &view, &p, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i++)
        assert_true(p.id[i] >= 0 && p.rgba[0][i] > 0.5f && p.rgba[0][i] > 4 * p.rgba[2][i]);
    leafcast_close(v);
}

static void media_lie_between_groups(void **state) {
    static picture truth, other;
    static const leafcast_transfer_point fog[2] = {{-10, {1, 0.5f, 0.2f}, 0.02f},
                                                   {10, {0, 1, 1}, 0.02f}};
    static leafcast_medium media[LISTED];
    const leafcast_camera view = view_of_wood();
    wood w;
    wood_open(&w, *state, NULL, 0);
    memset(media, 0, sizeof media);
    media[0] = (leafcast_medium){fog, 2};
    w.grouped.media = w.listed.media = media;
    w.grouped.media_count = 2;
    w.listed.media_count = LISTED;
    pictures_draw(w.pair.volume[0], &w.listed, &view, &truth, NULL);
    pictures_draw(w.pair.volume[0], &w.grouped, &view, &other, NULL);
    rename_ids(&w, &truth);
    scene_stage_same(&truth, &other);
    wood_close(&w);
}

static void rays_tell_the_object(void **state) {
    enum { RAYS = WATCHED ? 2000 : 20000 };
    static leafcast_ray rays[RAYS];
    static leafcast_ray_hit truth[RAYS], hits[RAYS];
    static uint8_t dark[RAYS];
    uint32_t seed = 7;
    int met_any = 0, grouped = 0;
    wood w;
    wood_open(&w, *state, NULL, 0);
    for (int i = 0; i < RAYS; i++) {
        rays[i] = (leafcast_ray){.t1 = INFINITY};
        for (int a = 0; a < 6; a++) {
            seed = seed * 1664525u + 1013904223u;
            const double u = (seed >> 8) / 16777216.0;
            if (a < 3)
                rays[i].origin[a] = 120 * u - 45;
            else
                rays[i].direction[a - 3] = 2 * u - 1;
        }
    }
    assert_int_equal(leafcast_trace_rays(w.pair.volume[0], &w.listed, rays, RAYS, truth), 0);
    assert_int_equal(leafcast_trace_rays(w.pair.volume[0], &w.grouped, rays, RAYS, hits), 0);
    assert_int_equal(leafcast_occluded_rays(w.pair.volume[0], &w.grouped, rays, RAYS, dark), 0);
    for (int i = 0; i < RAYS; i++) {
        const bool any = truth[i].volume >= 0;
        assert_int_equal(any, dark[i]);
        assert_int_equal(any, hits[i].volume >= 0);
        if (!any)
            continue;
        assert_true(hits[i].t == truth[i].t && hits[i].error_bound == truth[i].error_bound);
        assert_int_equal(hits[i].object, truth[i].volume);
        assert_int_equal(truth[i].object, truth[i].volume);
        assert_int_equal(hits[i].volume, w.volume[truth[i].volume]);
        assert_int_equal(hits[i].cell, truth[i].cell);
        assert_memory_equal(hits[i].normal, truth[i].normal, sizeof hits[i].normal);
        met_any++;
        grouped += truth[i].volume > 1;
    }
    print_message("%d of %d rays meet something, %d of these in groups\n", met_any, RAYS, grouped);
    assert_true(met_any > RAYS / 10 && grouped > met_any / 4);
    wood_close(&w);
}

/* At four places one of two groups lies: of the first the mesh, of the second the grid and, at
 * three places in it, the mesh. */
static void places_say_which_group_lies_there(void **state) {
    static picture truth, other;
    static const uint16_t which[4] = {1, 0, 1, 0};
    const leafcast_camera view = view_of_wood();
    leafcast_ray rays[512];
    leafcast_ray_hit want[512], hits[512];
    int count = 0, met_any = 0;
    wood w;
    wood_open(&w, *state, NULL, 0);
    leafcast *v = w.pair.volume[0];
    leafcast_places *chosen = NULL;
    assert_int_equal(leafcast_make_places(v, OUTER[0], which, 4, &chosen), LEAFCAST_OK);
    const leafcast_group inside = {w.middle, w.third, 1, NULL, 0};
    const leafcast_group either[2] = {{NULL, w.third, 1, NULL, 0}, {NULL, w.first, 1, &inside, 1}};
    const leafcast_group all = {chosen, NULL, 0, either, 2};
    w.grouped.groups = &all;
    w.grouped.group_count = 1;
    for (int i = 0; i < 2; i++)
        list(&w, &count, &w.own[i], i, NULL, NULL);
    for (int o = 0; o < 4; o++) {
        if (which[o])
            list(&w, &count, &w.first[0], 3, NULL, OUTER[o]);
        for (int m = 0; m < 3 && which[o]; m++)
            list(&w, &count, &w.third[0], 4, MIDDLE[m], OUTER[o]);
        if (!which[o])
            list(&w, &count, &w.third[0], 2, NULL, OUTER[o]);
    }
    w.listed.volume_count = count;
    pictures_draw(v, &w.listed, &view, &truth, NULL);
    pictures_draw(v, &w.grouped, &view, &other, NULL);
    memcpy(truth.id, other.id, sizeof truth.id); /* rays tell below */
    scene_stage_same(&truth, &other);
    for (int i = 0; i < 512; i++) {
        const int at = i * (PICTURE_PIXELS / 512);
        rays[i] = (leafcast_ray){.t1 = INFINITY};
        leafcast_pixel_ray(&view, at % PICTURE_WIDTH + 0.5, at / PICTURE_WIDTH + 0.5,
                           rays[i].origin, rays[i].direction);
    }
    assert_int_equal(leafcast_trace_rays(v, &w.listed, rays, 512, want), LEAFCAST_OK);
    assert_int_equal(leafcast_trace_rays(v, &w.grouped, rays, 512, hits), LEAFCAST_OK);
    for (int i = 0; i < 512; i++) {
        assert_int_equal(want[i].volume < 0, hits[i].volume < 0);
        if (want[i].volume < 0)
            continue;
        assert_int_equal(hits[i].object, want[i].volume);
        assert_int_equal(hits[i].volume, w.volume[want[i].volume]);
        met_any += want[i].volume > 1;
    }
    assert_true(met_any > 50);
    leafcast_free_places(chosen);
    wood_close(&w);
}

/* ---- A million ---- */

static void of_a_million_a_ray_asks_few(void **state) {
    enum { SIDE = 16, COUNT = SIDE * SIDE * SIDE, MANY = 256 };
    static double places[COUNT][12], grounds[MANY][12];
    static picture p;
    leafcast_stats stats = {.size = sizeof stats};
    field f;
    (void)state;
    assert_true(field_make(&f, "sphere", 12, FIELD_SEED));
    leafcast *v = fixture_open(fixture_leaf(&f, 5, 1, false), NULL);
    const leafcast_info info = leafcast_describe(v);
    const leafcast_surface surface = {f.iso, {1, 1, 1}, 1, 0, 0};
    const double unit = info.bounds[1][0] - info.bounds[0][0];
    const double step = exp2(ceil(log2(2 * unit)));
    memset(places, 0, sizeof places);
    memset(grounds, 0, sizeof grounds);
    for (int i = 0; i < COUNT; i++)
        for (int a = 0; a < 3; a++) {
            places[i][5 * a] = 1;
            places[i][4 * a + 3] = (i >> 4 * a) % SIDE * step;
        }
    for (int i = 0; i < MANY; i++)
        for (int a = 0; a < 3; a++) {
            grounds[i][5 * a] = 1;
            grounds[i][4 * a + 3] = a < 2 ? (i >> 4 * a) % SIDE * SIDE * step : 0.0;
        }
    leafcast_places *inner = places_of(v, places[0], COUNT),
                    *outer = places_of(v, grounds[0], MANY);
    const leafcast_shown shown = {.volume = v, .surfaces = &surface, .count = 1};
    const leafcast_group cube = {inner, &shown, 1, NULL, 0}, all = {outer, NULL, 0, &cube, 1};
    leafcast_scene scene = leafcast_scene_default();
    scene.groups = &all;
    scene.group_count = 1;
    leafcast_camera view = scene_stage_view(1);
    const double far = SIDE * SIDE * step;
    memcpy(view.eye, (double[3]){-0.2 * far, -0.3 * far, 0.3 * far}, sizeof view.eye);
    memcpy(view.look_at, (double[3]){0.5 * far, 0.5 * far, 0}, sizeof view.look_at);
    pictures_draw(v, &scene, &view, &p, NULL);
    pictures_draw(v, &scene, &view, &p, &stats); /* no ray waits */
    int met_any = 0;
    for (int i = 0; i < PICTURE_PIXELS; i += 37) {
        double o[3], d[3], at[3];
        if (isinf(p.z[i]))
            continue;
        leafcast_pixel_ray(&view, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        /* The same point, in the sphere that is there. */
        leafcast_ray ray = {.t0 = -INFINITY, .t1 = INFINITY};
        leafcast_ray_hit hit;
        leafcast_scene alone = leafcast_scene_default();
        alone.volumes = &shown;
        alone.volume_count = 1;
        ray.t0 = 0.0;
        for (int a = 0; a < 3; a++) {
            at[a] = o[a] + p.z[i] * d[a];
            ray.origin[a] = o[a] - step * floor(at[a] / step);
            ray.direction[a] = d[a];
        }
        assert_int_equal(leafcast_trace_rays(v, &alone, &ray, 1, &hit), LEAFCAST_OK);
        assert_true(fabs(hit.t - p.z[i]) < 1e-9 * p.z[i]);
        met_any++;
    }
    assert_true(met_any > PICTURE_PIXELS / 37 / 8);
    print_message("%d objects: %.2f questions a ray\n", COUNT * MANY,
                  (double)stats.objects / (double)stats.primary_rays);
    assert_true(stats.objects > 0 && stats.objects < 24 * stats.primary_rays);
    leafcast_free_places(inner);
    leafcast_free_places(outer);
    leafcast_close(v);
    field_release(&f);
}

/* ---- What is refused ---- */

static void check_refused(wood *w, const leafcast_scene *scene, const char *why) {
    leafcast_ray ray = {.direction = {1, 0, 0}, .t1 = 1.0};
    leafcast_ray_hit hit;
    assert_int_equal(leafcast_trace_rays(w->pair.volume[0], scene, &ray, 1, &hit), LEAFCAST_USAGE);
    if (!strstr(leafcast_error_text(), why))
        fail_msg("\"%s\" does not say \"%s\"", leafcast_error_text(), why);
}

static void what_groups_cannot_have_is_told(void **state) {
    wood w;
    wood_open(&w, *state, NULL, 0);
    leafcast_scene s = w.grouped;
    s.project = LEAFCAST_PROJECT_MEAN;
    check_refused(&w, &s, "not with projections");
    s = w.grouped;
    s.caps = true;
    check_refused(&w, &s, "not with caps");
    s = w.grouped;
    s.lod = LEAFCAST_LOD_PIXEL;
    check_refused(&w, &s, "levels by pixels");
    s = w.grouped;
    w.groups[1].places = w.outer;
    check_refused(&w, &s, "same leafcast_places");
    w.groups[1].places = NULL;
    check_refused(&w, &s, "leafcast_group.places");
    w.groups[1].places = w.other;
    w.third[0].count = 0;
    check_refused(&w, &s, "has no surfaces");
    w.third[0].count = 1;
    w.groups[1].volume_count = 0;
    check_refused(&w, &s, "neither volumes nor groups");
    w.groups[1].volume_count = 1;
    static const uint16_t which[4] = {0, 0, 1, 0};
    leafcast_places *chosen = NULL;
    assert_int_equal(leafcast_make_places(w.pair.volume[0], OUTER[0], which, 4, &chosen),
                     LEAFCAST_OK);
    w.groups[0].places = chosen;
    check_refused(&w, &s, "its places name group 1 of 1");
    w.groups[0].places = w.outer;
    leafcast_group either[2] = {w.inside, w.inside};
    w.groups[0] = (leafcast_group){chosen, NULL, 0, either, 2};
    check_refused(&w, &s, "has none of its own");
    w.groups[0] = (leafcast_group){w.outer, w.first, 1, &w.inside, 1};
    leafcast_free_places(chosen);
    static const double huge[12] = {1e22, 0, 0, 0, 0, 1e22, 0, 0, 0, 0, 1e22, 0};
    static const double far[12] = {1, 0, 0, 1e300, 0, 1, 0, 0, 0, 0, 1, 0};
    const leafcast_shown third = w.third[0];
    leafcast_places *more = NULL;
    w.third[0].place = huge;
    assert_int_equal(leafcast_make_places(w.pair.volume[0], huge, NULL, 1, &more), LEAFCAST_OK);
    w.groups[1].places = more;
    check_refused(&w, &s, "may scale by more");
    leafcast_free_places(more);
    w.third[0] = third;
    w.groups[1].places = w.other;
    more = (leafcast_places *)&more;
    assert_int_equal(leafcast_make_places(w.pair.volume[0], far, NULL, 1, &more), LEAFCAST_USAGE);
    assert_null(more);
    static const double flat[24] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1};
    assert_int_equal(leafcast_make_places(w.pair.volume[0], flat, NULL, 2, &more), LEAFCAST_USAGE);
    assert_non_null(strstr(leafcast_error_text(), "place 2 of 2"));
    assert_int_equal(leafcast_make_places(w.pair.volume[0], flat, NULL, 0, &more), LEAFCAST_USAGE);
    /* Deeper than is possible. */
    leafcast_group chain[LEAFCAST_GROUPS_DEEP + 1];
    leafcast_places *at[LEAFCAST_GROUPS_DEEP + 1];
    for (int i = LEAFCAST_GROUPS_DEEP; i >= 0; i--) {
        at[i] = places_of(w.pair.volume[0], MIDDLE[2], 1);
        chain[i] = (leafcast_group){
            at[i], i < LEAFCAST_GROUPS_DEEP ? NULL : w.third, i == LEAFCAST_GROUPS_DEEP,
            i < LEAFCAST_GROUPS_DEEP ? &chain[i + 1] : NULL, i < LEAFCAST_GROUPS_DEEP};
    }
    s.groups = chain;
    s.group_count = 1;
    check_refused(&w, &s, "8 deep");
    s.groups = chain + 1;
    leafcast_ray ray = {.direction = {1, 0, 0}, .t1 = 1.0};
    leafcast_ray_hit hit;
    assert_int_equal(leafcast_trace_rays(w.pair.volume[0], &s, &ray, 1, &hit), LEAFCAST_OK);
    /* More than can be numbered. */
    static double many[2048][12];
    for (int i = 0; i < 2048; i++)
        memcpy(many[i], MIDDLE[2], sizeof many[i]);
    leafcast_places *wide[3];
    leafcast_group cube[3];
    for (int i = 2; i >= 0; i--) {
        wide[i] = places_of(w.pair.volume[0], many[0], 2048);
        cube[i] = (leafcast_group){wide[i], i < 2 ? NULL : w.third, i == 2,
                                   i < 2 ? &cube[i + 1] : NULL, i < 2};
    }
    s.groups = cube;
    check_refused(&w, &s, "more than 4294967294 objects");
    for (int i = 0; i < 3; i++)
        leafcast_free_places(wide[i]);
    for (int i = 0; i <= LEAFCAST_GROUPS_DEEP; i++)
        leafcast_free_places(at[i]);
    wood_close(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(groups_are_the_list_of_their_objects),
                                       cmocka_unit_test(mirrors_and_glass_see_groups),
                                       cmocka_unit_test(a_mirror_sees_its_own_volume_elsewhere),
                                       cmocka_unit_test(media_lie_between_groups),
                                       cmocka_unit_test(rays_tell_the_object),
                                       cmocka_unit_test(places_say_which_group_lies_there),
                                       cmocka_unit_test(of_a_million_a_ray_asks_few),
                                       cmocka_unit_test(what_groups_cannot_have_is_told)};
    return cmocka_run_group_tests(tests, scene_stage_set, scene_stage_clear);
}
