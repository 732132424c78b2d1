/* test_colour_by.c - surfaces coloured by another volume's values: each pixel beside the map of
 * what leafcast_sample_points() finds at eye + t d, for every kind that is coloured and every kind
 * that colours; lights, layers and mirrors; the same bits for any budget and threads; what is
 * refused.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "render/ray/affine.h"
#include "tests/support/between_lab.h"
#include "tests/support/colour_lab.h"
#include "tests/support/fixture.h"
#include "tests/support/scene_stage.h"
#include "tests/support/scratch.h"

/* ---- The truth ---- */

static void map_by_hand(const coloured *c, const leafcast_surface *s, double value, double rgb[3]) {
    const leafcast_transfer_point *p = c->points;
    for (int a = 0; a < 3; a++)
        rgb[a] = (double)s->rgb[a];
    if (isnan(value))
        return;
    const int k = value >= p[1].value;
    double w = (value - p[k].value) / (p[k + 1].value - p[k].value);
    w = w < 0.0 ? 0.0 : w > 1.0 ? 1.0 : w;
    for (int a = 0; a < 3; a++)
        rgb[a] = (1.0 - w) * p[k].rgb[a] + w * p[k + 1].rgb[a];
}

/* The value that colours a point of the scene's world. */
static double value_at(const coloured *c, const double at[3]) {
    leafcast_sample sample;
    double own[3];
    memcpy(own, at, sizeof own);
    if (c->colouring.place) {
        affine space;
        affine_init(&space, c->colouring.place);
        affine_point_to_grid(&space, at, own);
    }
    assert_int_equal(leafcast_sample_points(c->by, (const double(*)[3])own, 1, &sample),
                     LEAFCAST_OK);
    return sample.inside ? sample.value : (double)NAN;
}

typedef struct seen {
    int valued, plain;
} seen;

/* Compare each pixel's first surface with the truth: its colour, times what is at that pixel of
 * `white`, the picture of white surfaces (NULL: 1). */
static seen compare(const coloured *c, const picture *p, const picture *white, const char *what) {
    seen n = {0, 0};
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double o[3], d[3], at[3], rgb[3];
        if (p->id[i] < 0)
            continue;
        leafcast_pixel_ray(&c->camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        for (int a = 0; a < 3; a++)
            at[a] = o[a] + p->z[i] * d[a];
        const double value = value_at(c, at);
        map_by_hand(c, &c->surfaces[p->id[i]], value, rgb);
        n.valued += !isnan(value);
        n.plain += isnan(value);
        for (int k = 0; k < 3; k++) {
            const double expected = rgb[k] * (white ? (double)white->rgba[k][i] : 1.0);
            if (fabs((double)p->rgba[k][i] - expected) > 1e-6)
                fail_msg("%s: pixel %d, value %.17g: channel %d is %.9g, not %.9g", what, i, value,
                         k, (double)p->rgba[k][i], expected);
        }
    }
    return n;
}

/* ---- Tests ---- */

static void test_kinds(void **state) {
    static picture p;
    int plain = 0;
    (void)state;
    for (int of = 0; of < FILES; of++)
        for (int by = 0; by < COLOURING; by++) {
            char what[80];
            coloured c;
            if (of == HOLES)
                continue;
            snprintf(what, sizeof what, "%s by %s", colour_lab_names[of], colour_lab_names[by]);
            for (where how = PLACED; how <= TILED; how++) {
                colour_lab_open(&c, of, by, how, NULL, 0);
                pictures_draw(c.of, &c.scene, &c.camera, &p, NULL);
                const seen n = compare(&c, &p, NULL, what);
                print_message("%s: %d pixels by value, %d plain\n", what, n.valued, n.plain);
                assert_true(n.valued > PICTURE_PIXELS / 40);
                plain += n.plain;
                colour_lab_close(&c);
            }
        }
    assert_true(plain > PICTURE_PIXELS / 2);
}

/* Where both lie without places, points are the very ones of the ray. */
static void test_unplaced(void **state) {
    static picture p;
    (void)state;
    for (int which = 0; which < 2; which++) {
        coloured c;
        colour_lab_open(&c, which ? MESH : GRID, which ? GRID : MESH, AS_FILES_SAY, NULL, 0);
        pictures_draw(c.of, &c.scene, &c.camera, &p, NULL);
        const seen n = compare(&c, &p, NULL, which ? "mesh by grid" : "grid by mesh");
        assert_true(n.valued > PICTURE_PIXELS / 40);
        colour_lab_close(&c);
    }
}

/* The colour is an albedo: with lights, shadows, clips and occlusion a pixel is the white one's,
 * times the colour. */
static void test_lit(void **state) {
    static picture p, white;
    (void)state;
    for (int soft = 0; soft < 2; soft++) {
        coloured c;
        colour_lab_open(&c, GRID, MESH, PLACED, NULL, 0);
        c.scene.shading = LEAFCAST_SHADING_DIFFUSE;
        c.scene.shadows = true;
        c.scene.light_count = 2;
        c.scene.lights[0] = (leafcast_light){false, {1, 0.4, 2}, {0.8f, 0.7f, 0.6f}, 3 * soft};
        c.scene.lights[1] = (leafcast_light){true, {20, -5, 15}, {0.3f, 0.4f, 0.5f}, 0};
        c.scene.occlusion = 4.0 * soft;
        c.scene.occlusion_samples = 4;
        c.scene.light_samples = 4;
        c.scene.clip_plane_count = 1;
        memcpy(c.scene.clip_planes[0], (const double[4]){-1, 0, 0.2, 7}, sizeof(double[4]));
        leafcast_shown plain = c.shown;
        leafcast_surface bright = c.surfaces[0];
        leafcast_scene scene = c.scene;
        plain.colour_by = NULL;
        plain.colours = NULL;
        plain.surfaces = &bright;
        for (int k = 0; k < 3; k++)
            bright.rgb[k] = 1.0f;
        scene.volumes = &plain;
        pictures_draw(c.of, &scene, &c.camera, &white, NULL);
        pictures_draw(c.of, &c.scene, &c.camera, &p, NULL);
        assert_memory_equal(p.z, white.z, sizeof p.z);
        assert_memory_equal(p.normal, white.normal, sizeof p.normal);
        const seen n = compare(&c, &p, &white, soft ? "soft" : "lit");
        assert_true(n.valued > PICTURE_PIXELS / 40);
        colour_lab_close(&c);
    }
}

/* All layers of glass, composited by hand from what a probe meets. */
static void test_layers(void **state) {
    enum { HITS = 64 };
    static picture p;
    coloured c;
    int most = 0;
    (void)state;
    colour_lab_open(&c, GRID, MESH, PLACED, NULL, 0);
    c.shown.count = 2;
    c.surfaces[0].opacity = 0.4f;
    c.surfaces[1].opacity = 0.6f;
    pictures_draw(c.of, &c.scene, &c.camera, &p, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i += WATCHED ? 3 : 5) {
        leafcast_hit hits[HITS];
        double o[3], d[3], sum[4] = {0.0};
        int count;
        leafcast_pixel_ray(&c.camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        assert_int_equal(leafcast_probe_ray(c.of, &c.scene, o, d, hits, HITS, &count), LEAFCAST_OK);
        for (int k = 0; k < count; k++) {
            const leafcast_surface *s = &c.surfaces[hits[k].surface];
            const double share = (1.0 - sum[3]) * (double)s->opacity;
            double rgb[3];
            map_by_hand(&c, s, value_at(&c, hits[k].point), rgb);
            for (int a = 0; a < 3; a++)
                sum[a] += share * rgb[a];
            sum[3] += share;
        }
        most = count > most ? count : most;
        for (int a = 0; a < 4; a++)
            assert_true(fabs((double)p.rgba[a][i] - sum[a]) < 1e-3);
    }
    assert_true(most > 3);
    colour_lab_close(&c);
}

/* Ask for lights, shadows and glass; of soft looks also for mirrors. */
static void ask(coloured *c, bool soft) {
    c->shown.count = 2;
    c->surfaces[0].opacity = 0.7f;
    c->surfaces[0].reflectivity = 0.5f;
    c->scene.shading = LEAFCAST_SHADING_PHONG;
    c->scene.shadows = true;
    c->scene.light_count = 1;
    c->scene.lights[0] = (leafcast_light){false, {1, 0.4, 2}, {0.8f, 0.7f, 0.6f}, 4 * soft};
    c->scene.light_samples = 2;
    c->scene.bounces = 2 * soft;
}

/* Draw it anew, with a device of these options. Returns false if that has no room. */
static bool draw_anew(int of, int by, where how, const leafcast_options *o, uint32_t treelets,
                      picture *p, leafcast_stats *stats) {
    coloured c;
    colour_lab_open(&c, of, by, how, o, treelets);
    ask(&c, of == GRID && how == PLACED);
    const leafcast_image plane = {.size = sizeof plane,
                                  .r = p->rgba[0],
                                  .g = p->rgba[1],
                                  .b = p->rgba[2],
                                  .a = p->rgba[3],
                                  .z = p->z,
                                  .normal = {p->normal[0], p->normal[1], p->normal[2]},
                                  .id = p->id,
                                  .provisional = p->provisional};
    const bool room = leafcast_check_room(c.of, &c.scene, &c.camera, &plane, 0) == LEAFCAST_OK;
    if (room)
        pictures_draw(c.of, &c.scene, &c.camera, p, stats);
    colour_lab_close(&c);
    return room;
}

/* Under any budget, by any threads, by single rays and by tiles. */
static void test_same_bits(void **state) {
    static const int pairs[][3] = {{GRID, MESH, PLACED},      {MESH, CURVED, TILED},
                                   {GRID, HOLES, TILED},      {CURVED, GRID, TILED},
                                   {TRIANGLES, MIXED, TILED}, {HEIGHTS, GRID, TILED},
                                   {MIXED, MESH, TILED}};
    static picture all, p;
    (void)state;
    for (size_t i = 0; i < (WATCHED ? 1 : sizeof pairs / sizeof *pairs); i++) {
        const int of = pairs[i][0], by = pairs[i][1];
        const where how = (where)pairs[i][2];
        leafcast_stats stats = {.size = sizeof stats};
        leafcast_options o = {.size = sizeof o, .threads = 1, .isa = "scalar"};
        assert_true(draw_anew(of, by, how, &o, 0, &all, &stats));
        for (int threads = 1; threads <= 3; threads += 2)
            for (uint32_t treelets = 0; treelets < 3; treelets++) {
                o = (leafcast_options){.size = sizeof o, .threads = threads};
                assert_true(draw_anew(of, by, how, &o, treelets, &p, &stats));
                scene_stage_same(&all, &p);
            }
        o = (leafcast_options){.size = sizeof o, .threads = 2, .memory = 1 << 20};
        while (!draw_anew(of, by, how, &o, 0, &p, &stats))
            o.memory += o.memory / 16;
        assert_true(o.memory > 1 << 20);
        assert_true(stats.bytes_peak <= o.memory);
        scene_stage_same(&all, &p);
    }
}

/* What a mirror shows is coloured likewise: a plane that is nothing but its reflection, through the
 * coloured volume. */
static void test_mirrored(void **state) {
    static picture p;
    field f;
    coloured c;
    int mirrored = 0;
    (void)state;
    assert_true(field_make(&f, "linear", 20, FIELD_SEED));
    colour_lab_open(&c, GRID, MESH, PLACED, NULL, 0);
    const leafcast_options on = {.size = sizeof on, .device = c.device};
    leafcast *plane = fixture_open(fixture_leaf(&f, 4, 1, true), &on);
    leafcast_surface mirror = leafcast_surface_default(f.iso);
    double place[12];
    leafcast_shown shown[2] = {{.volume = plane, .surfaces = &mirror, .count = 1, .place = place},
                               c.shown};
    colour_lab_place(plane, -0.8, 2.0, place);
    mirror.reflectivity = 1.0f;
    c.scene.bounces = 1;
    c.scene.volumes = shown;
    c.scene.volume_count = 2;
    pictures_draw(c.of, &c.scene, &c.camera, &p, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double o[3], d[3], along = 0.0, to[3], at[3], rgb[3];
        leafcast_hit met;
        int count;
        if (p.id[i] != 0)
            continue;
        leafcast_pixel_ray(&c.camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        for (int a = 0; a < 3; a++)
            along += d[a] * (double)p.normal[a][i];
        for (int a = 0; a < 3; a++) {
            to[a] = d[a] - 2.0 * along * (double)p.normal[a][i];
            at[a] = o[a] + p.z[i] * d[a];
        }
        assert_int_equal(leafcast_probe_ray(c.of, &c.scene, at, to, &met, 1, &count), LEAFCAST_OK);
        if (count == 0)
            continue;
        map_by_hand(&c, c.surfaces, value_at(&c, met.point), rgb);
        mirrored++;
        for (int a = 0; a < 3; a++)
            assert_true(fabs((double)p.rgba[a][i] - rgb[a]) < 1e-3);
    }
    print_message("%d pixels of the mirror show it\n", mirrored);
    assert_true(mirrored > PICTURE_PIXELS / 200);
    leafcast_close(plane);
    colour_lab_close(&c);
    field_release(&f);
}

/* A volume may be shown, and colour, and be coloured. */
static void test_both_shown(void **state) {
    static picture p;
    coloured c;
    (void)state;
    colour_lab_open(&c, GRID, MESH, PLACED, NULL, 0);
    const leafcast_colouring back = {.volume = c.of, .place = c.place[0]};
    leafcast_shown shown[2] = {c.shown, c.shown};
    leafcast_surface other = leafcast_surface_default(scene_stage_mesh.isovalue);
    double range[2];
    shown[1].volume = c.by;
    shown[1].place = c.place[1];
    shown[1].surfaces = &other;
    shown[1].colour_by = &back;
    c.scene.volumes = shown;
    c.scene.volume_count = 2;
    assert_int_equal(leafcast_range(c.of, 0, 0, range), LEAFCAST_OK);
    pictures_draw(c.of, &c.scene, &c.camera, &p, NULL);
    int met[2] = {0, 0};
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        double o[3], d[3], at[3], rgb[3];
        coloured now = c;
        if (p.id[i] < 0)
            continue;
        leafcast_pixel_ray(&c.camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        for (int a = 0; a < 3; a++)
            at[a] = o[a] + p.z[i] * d[a];
        if (p.id[i] == 1) {
            now.by = c.of;
            now.colouring = back;
        }
        map_by_hand(&c, p.id[i] == 1 ? &other : c.surfaces, value_at(&now, at), rgb);
        met[p.id[i]]++;
        for (int k = 0; k < 3; k++)
            assert_true(fabs((double)p.rgba[k][i] - rgb[k]) <= 1e-6);
    }
    assert_true(met[0] > 20 && met[1] > 20);
    colour_lab_close(&c);
}

/* A medium about the surface changes nothing of its colour where it lets all light through. */
static void test_medium(void **state) {
    static picture p;
    const leafcast_transfer_point thin[2] = {{.value = 1e20, .rgb = {1, 1, 1}, .extinction = 0.0},
                                             {.value = 2e20, .rgb = {1, 1, 1}, .extinction = 1.0}};
    const leafcast_medium medium = {thin, 2};
    coloured c;
    (void)state;
    colour_lab_open(&c, GRID, CURVED, PLACED, NULL, 1);
    c.scene.media = &medium;
    c.scene.media_count = 1;
    pictures_draw(c.of, &c.scene, &c.camera, &p, NULL);
    const seen n = compare(&c, &p, NULL, "in a medium");
    assert_true(n.valued > PICTURE_PIXELS / 40);
    colour_lab_close(&c);
}

/* A step, and a time between two, of what colours. Beside another one of the same volume, it is
 * refused. */
static void test_steps(void **state) {
    static picture p;
    between_lab *lab = between_lab_make(&between_kinds[1]);
    (void)state;
    colour_lab_keep(SERIES, lab->series);
    for (int i = 0; i < 2; i++) {
        coloured c;
        colour_lab_open(&c, MESH, SERIES, PLACED, NULL, 0);
        c.colouring.step = 2;
        c.colouring.between = 0.3 * i;
        pictures_draw(c.of, &c.scene, &c.camera, &p, NULL);
        assert_int_equal(leafcast_select_between(c.by, 0, 2, 0.3 * i), LEAFCAST_OK);
        const seen n = compare(&c, &p, NULL, i ? "between" : "step");
        assert_true(n.valued > PICTURE_PIXELS / 40);
        const leafcast_shown shown[2] = {c.shown,
                                         {.volume = c.by, .surfaces = c.surfaces, .count = 1}};
        c.scene.volumes = shown;
        c.scene.volume_count = 2;
        colour_lab_refused(&c, "has one field and step");
        colour_lab_close(&c);
    }
    between_lab_free(lab);
}

/* Previews do not wait for values: of cells they are there or not, of a grid perhaps coarser. What
 * is not provisional is exact. With one treelet at a time not all can be. */
static void test_preview(void **state) {
    static picture exact, p;
    (void)state;
    static const int colouring[] = {HOLES, MESH, HEIGHTS};
    for (int i = 0; i < 3; i++) {
        const int by = colouring[i];
        coloured c;
        int provisional = 0, coarse = 0;
        colour_lab_open(&c, GRID, by, PLACED, NULL, 1);
        leafcast_scene scene = c.scene;
        scene.preview = true;
        /* Until something coarser has come. */
        for (int turn = 0; turn < 200 && coarse == 0 && by != MESH; turn++) {
            pictures_draw(c.of, &scene, &c.camera, &p, NULL);
            for (int k = 0; k < PICTURE_PIXELS; k++)
                coarse += p.provisional[k] && p.id[k] >= 0 && p.rgba[0][k] != c.surfaces[0].rgb[0];
        }
        assert_true(coarse > 0 || by == MESH);
        pictures_draw(c.of, &scene, &c.camera, &p, NULL);
        pictures_draw(c.of, &c.scene, &c.camera, &exact, NULL);
        for (int k = 0; k < PICTURE_PIXELS; k++) {
            provisional += p.provisional[k];
            assert_true(p.provisional[k] || pictures_same_pixel(&p, &exact, k));
        }
        assert_true(provisional > 20);
        colour_lab_close(&c);
    }
}

/* Terrain that its own file is draped over has the colours of its own elevations, at each level of
 * detail. */
static void test_draped_levels(void **state) {
    static picture draped, own;
    (void)state;
    for (uint32_t level = 0; level < 3; level++) {
        coloured c;
        int covered = 0;
        colour_lab_open(&c, HEIGHTS, HEIGHTS, AS_FILES_SAY, NULL, 0);
        c.camera = leafcast_standard_view(c.of, 1.2, PICTURE_WIDTH, PICTURE_HEIGHT);
        c.scene.lod = LEAFCAST_LOD_LEVEL;
        c.scene.lod_level = level;
        pictures_draw(c.of, &c.scene, &c.camera, &draped, NULL);
        c.shown.colour_by = NULL;
        pictures_draw(c.of, &c.scene, &c.camera, &own, NULL);
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            covered += own.id[i] >= 0;
            for (int k = 0; k < 3; k++)
                assert_true(fabsf(draped.rgba[k][i] - own.rgba[k][i]) <= 1e-5f);
        }
        assert_true(covered > PICTURE_PIXELS / 10);
        colour_lab_close(&c);
    }
}

static void test_refused(void **state) {
    (void)state;
    coloured c;
    colour_lab_open(&c, GRID, MESH, PLACED, NULL, 0);
    c.shown.colours = NULL;
    colour_lab_refused(&c, "there are no colours");
    c.shown.colours = &c.map;
    c.colouring.volume = NULL;
    colour_lab_refused(&c, "colour_by.volume is NULL");
    c.colouring.volume = c.of;
    c.colouring.step = 3;
    colour_lab_refused(&c, "step");
    c.colouring = (leafcast_colouring){.volume = c.by, .field = 7};
    colour_lab_refused(&c, "field");
    leafcast *elsewhere = fixture_open(colour_lab_paths[MESH], NULL);
    c.colouring = (leafcast_colouring){.volume = elsewhere};
    colour_lab_refused(&c, "on another device");
    leafcast_close(elsewhere);
    colour_lab_close(&c);
    colour_lab_open(&c, GRID, MESH, PLACED, NULL, 0);
    const leafcast_options on = {.size = sizeof on, .device = c.device};
    leafcast *given = fixture_open(colour_lab_paths[TRIANGLES], &on);
    c.colouring.volume = given;
    colour_lab_refused(&c, "has no values at points");
    leafcast_close(given);
    colour_lab_close(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),         cmocka_unit_test(test_unplaced),
        cmocka_unit_test(test_lit),           cmocka_unit_test(test_layers),
        cmocka_unit_test(test_same_bits),     cmocka_unit_test(test_mirrored),
        cmocka_unit_test(test_both_shown),    cmocka_unit_test(test_medium),
        cmocka_unit_test(test_steps),         cmocka_unit_test(test_preview),
        cmocka_unit_test(test_draped_levels), cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, colour_lab_set, scene_stage_clear);
}
