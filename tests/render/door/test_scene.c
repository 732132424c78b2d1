/* test_scene.c - scenes of several volumes on one device: what the references say, and the same
 * bits for any budget, in turns, in parts. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "tests/support/ref_judge.h"
#include "tests/support/scene_stage.h"
#include "tests/support/tet_judge.h"
#include "tests/support/watched.h"

enum { HITS = 64 };

enum { STEP = WATCHED ? 23 : 5 };

static ref_ray pixel_of(const leafcast_camera *c, int i) {
    ref_ray r;
    leafcast_pixel_ray(c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, r.o, r.d);
    return r;
}

/* ---- What is true ---- */

/* A surface of either volume. */
typedef struct met {
    double t;
    int id;
} met;

/* All that a ray meets, in order; false: a reference does not want to be asked. */
static bool truth(const scene_stage *s, const ref_ray *r, met all[2 * HITS], size_t *count) {
    ref_hit of_grid[HITS], of_mesh[HITS];
    const size_t g = ref_trace(&s->grid, r, scene_stage_isos, 2, NULL, of_grid, HITS);
    const size_t m = tet_ref_trace(s->mesh, r, &s->lab.iso, 1, NULL, of_mesh, HITS);
    size_t i = 0, k = 0;
    *count = 0;
    if (g >= HITS || m >= HITS || ref_grazing(&s->grid, r, scene_stage_isos, 2, NULL, HITS) ||
        tet_judge_grazing(s->mesh, r, &s->lab.iso, 1, NULL, HITS))
        return false;
    while (i < g || k < m) {
        const bool first = k == m || (i < g && of_grid[i].t <= of_mesh[k].t);
        all[(*count)++] = first ? (met){of_grid[i].t, of_grid[i].iso} : (met){of_mesh[k].t, 2};
        i += first;
        k += !first;
    }
    for (i = 1; i < *count; i++)
        if (all[i].t - all[i - 1].t < 1e-4)
            return false; /* which comes first is beyond what is asked */
    return true;
}

/* In flat colours. */
static void composite(const met all[], size_t count, double rgba[4]) {
    memset(rgba, 0, 4 * sizeof *rgba);
    for (size_t i = 0; i < count; i++) {
        const leafcast_surface *s =
            all[i].id < 2 ? &scene_stage_grid[all[i].id] : &scene_stage_mesh;
        const double weight = (1 - rgba[3]) * (double)s->opacity;
        for (int c = 0; c < 3; c++)
            rgba[c] += weight * (double)s->rgb[c];
        rgba[3] += weight;
    }
}

static void two_volumes_are_what_the_references_say(void **state) {
    const scene_stage *s = *state;
    static picture p;
    scene_pair v;
    int judged = 0, mixed = 0;
    scene_stage_open(&v, s, NULL, 0);
    v.scene.shading = LEAFCAST_SHADING_FLAT;
    for (int from = 0; from < 2; from++) {
        const leafcast_camera c = scene_stage_view(from ? 16.2 : 68); /* inside, outside */
        pictures_draw(v.volume[0], &v.scene, &c, &p, NULL);
        for (int i = from; i < PICTURE_PIXELS; i += STEP) {
            const ref_ray r = pixel_of(&c, i);
            met all[2 * HITS];
            size_t count;
            double rgba[4];
            if (!truth(s, &r, all, &count))
                continue;
            judged++;
            mixed += count > 1 && (all[0].id == 2) != (all[1].id == 2);
            assert_int_equal(p.id[i], count ? all[0].id : -1);
            if (count)
                assert_true(fabs(p.z[i] - all[0].t) < 1e-4);
            composite(all, count, rgba);
            for (int k = 0; k < 4; k++)
                assert_true(fabs((double)p.rgba[k][i] - rgba[k]) < 1e-3);
        }
    }
    assert_true(judged > PICTURE_PIXELS / STEP);
    assert_true(mixed > judged / 20);
    scene_stage_close(&v);
}

/* ---- The same bits ---- */

/* The least budget that draws it. */
static uint64_t least_budget(const scene_stage *s, const leafcast_camera *c) {
    static float plane[PICTURE_PIXELS];
    static double depth[PICTURE_PIXELS];
    uint64_t budget = 1 << 20;
    for (;; budget += 64 << 10) {
        const leafcast_options o = {.size = sizeof o, .memory = budget, .threads = 3};
        scene_pair v;
        leafcast_image planes = {.size = sizeof planes, .r = plane, .z = depth};
        leafcast_device *d = NULL;
        leafcast *a = NULL, *b = NULL;
        assert_int_equal(leafcast_device_create(&o, &d), LEAFCAST_OK);
        const leafcast_options on = {.size = sizeof on, .device = d};
        bool fits = !leafcast_open(s->grid_path, &on, &a) && !leafcast_open(s->mesh_path, &on, &b);
        if (fits) {
            const leafcast_shown shown[2] = {
                {a, 0, 0, scene_stage_grid, 2, 0.0, NULL, NULL, NULL},
                {b, 0, 0, &scene_stage_mesh, 1, 0.0, NULL, NULL, NULL}};
            v.scene = leafcast_scene_default();
            v.scene.volumes = shown;
            v.scene.volume_count = 2;
            fits = leafcast_check_room(a, &v.scene, c, &planes, 0) == LEAFCAST_OK;
        }
        leafcast_close(a);
        leafcast_close(b);
        leafcast_device_destroy(d);
        if (fits)
            return budget;
    }
}

static void budgets_and_threads_do_not_show(void **state) {
    const scene_stage *s = *state;
    static picture truth_of, other;
    const leafcast_camera c = scene_stage_view(68);
    const uint64_t least = least_budget(s, &c) + PICTURE_PIXELS * 64;
    scene_pair v;
    scene_stage_open(&v, s, NULL, 0);
    leafcast_scene scene = scene_stage_lit(&v);
    pictures_draw(v.volume[1], &scene, &c, &truth_of, NULL);
    scene_stage_close(&v);
    for (int kind = 0; kind < 4; kind++) {
        const leafcast_options o = {
            .size = sizeof o, .threads = kind % 2 ? 3 : 1, .memory = kind < 2 ? 0 : least};
        leafcast_stats stats = {.size = sizeof stats};
        scene_stage_open(&v, s, &o, kind < 2 ? 1 : 0);
        scene = scene_stage_lit(&v);
        pictures_draw(v.volume[0], &scene, &c, &other, &stats);
        scene_stage_same(&truth_of, &other);
        if (o.memory)
            assert_true(stats.bytes_peak <= o.memory);
        assert_true(stats.treelets_loaded >= 2);
        scene_stage_close(&v);
    }
}

static void volumes_of_a_device_share_its_budget(void **state) {
    const scene_stage *s = *state;
    static picture alone, shared;
    const leafcast_camera c = scene_stage_view(68);
    const leafcast_options o = {.size = sizeof o, .memory = 5 << 20};
    scene_pair v;
    scene_stage_open(&v, s, &o, 0);
    for (int turn = 0; turn < 4; turn++) {
        leafcast *one = v.volume[turn % 2];
        leafcast_stats stats = {.size = sizeof stats};
        const leafcast_scene scene = leafcast_scene_default();
        assert_int_equal(
            leafcast_select(one, turn % 2 ? &scene_stage_mesh : scene_stage_grid, turn % 2 ? 1 : 2),
            LEAFCAST_OK);
        pictures_draw(one, &scene, &c, &shared, &stats);
        assert_true(stats.bytes_peak <= o.memory);
        leafcast *own;
        assert_int_equal(leafcast_open(turn % 2 ? s->mesh_path : s->grid_path, NULL, &own),
                         LEAFCAST_OK);
        assert_int_equal(
            leafcast_select(own, turn % 2 ? &scene_stage_mesh : scene_stage_grid, turn % 2 ? 1 : 2),
            LEAFCAST_OK);
        pictures_draw(own, &scene, &c, &alone, NULL);
        scene_stage_same(&alone, &shared);
        leafcast_close(own);
    }
    scene_stage_close(&v);
}

/* ---- Parts of pictures ---- */

static void parts_make_the_whole(void **state) {
    const scene_stage *s = *state;
    static picture whole, parts;
    static uint8_t bytes[4 * PICTURE_PIXELS], part_bytes[4 * PICTURE_PIXELS];
    const leafcast_camera c = scene_stage_view(68);
    for (int samples = 1; samples <= 4; samples += 3) {
        for (int several = 0; several < 2; several++) {
            scene_pair v;
            scene_stage_open(&v, s, NULL, 0);
            leafcast_scene scene = v.scene;
            scene.samples = samples;
            scene.volume_count = several ? 2 : 1;
            leafcast_image image = {.size = sizeof image,
                                    .r = whole.rgba[0],
                                    .g = whole.rgba[1],
                                    .b = whole.rgba[2],
                                    .a = whole.rgba[3],
                                    .z = whole.z,
                                    .rgba8 = bytes};
            assert_int_equal(leafcast_trace(v.volume[0], &scene, &c, &image, NULL, NULL, NULL),
                             LEAFCAST_OK);
            memset(&parts, 0xee, sizeof parts);
            for (uint32_t k = 0; k < 4; k++) {
                const uint32_t x = k % 2 * 31, y = k / 2 * 17;
                const size_t at = (size_t)PICTURE_WIDTH * y + x;
                image = (leafcast_image){.size = sizeof image,
                                         .r = parts.rgba[0] + at,
                                         .g = parts.rgba[1] + at,
                                         .z = parts.z + at,
                                         .rgba8 = part_bytes + 4 * at,
                                         .x = x,
                                         .y = y,
                                         .width = k % 2 ? PICTURE_WIDTH - 31 : 31,
                                         .height = k / 2 ? PICTURE_HEIGHT - 17 : 17,
                                         .stride = PICTURE_WIDTH};
                assert_int_equal(leafcast_trace(v.volume[0], &scene, &c, &image, NULL, NULL, NULL),
                                 LEAFCAST_OK);
            }
            assert_memory_equal(whole.z, parts.z, sizeof whole.z);
            assert_memory_equal(whole.rgba[0], parts.rgba[0], sizeof whole.rgba[0]);
            assert_memory_equal(whole.rgba[1], parts.rgba[1], sizeof whole.rgba[1]);
            assert_memory_equal(bytes, part_bytes, sizeof bytes);
            scene_stage_close(&v);
        }
    }
}

/* Two frames of one device, slice by slice in turn. */
static void slice(const scene_stage *s, uint64_t memory) {
    static picture whole[2], sliced[2];
    const leafcast_camera c[2] = {scene_stage_view(68), scene_stage_view(-40)};
    scene_pair v;
    leafcast_frame *frame[2];
    bool done[2] = {false, false};
    int calls = 0;
    const leafcast_options o = {.size = sizeof o, .threads = 2, .memory = memory};
    scene_stage_open(&v, s, &o, memory ? 0 : 2);
    leafcast_scene scene[2] = {scene_stage_lit(&v), v.scene};
    leafcast_surface later = scene_stage_grid[1];
    leafcast_shown shown[1] = {{v.volume[0], 0, 0, &later, 1, 0.0, NULL, NULL, NULL}};
    scene[1].volumes = shown;
    scene[1].volume_count = 1;
    scene[1].samples = 4;
    for (int k = 0; k < 2; k++)
        pictures_draw(v.volume[0], &scene[k], &c[k], &whole[k], NULL);
    for (int k = 0; k < 2; k++) {
        picture *p = &sliced[k];
        const leafcast_image image = {.size = sizeof image,
                                      .r = p->rgba[0],
                                      .g = p->rgba[1],
                                      .b = p->rgba[2],
                                      .a = p->rgba[3],
                                      .z = p->z,
                                      .normal = {p->normal[0], p->normal[1], p->normal[2]},
                                      .id = p->id};
        assert_int_equal(leafcast_frame_begin(v.volume[0], &scene[k], &c[k], &image, &frame[k]),
                         LEAFCAST_OK);
    }
    later.isovalue = -5; /* what it was given is the frame's own */
    while (!done[0] || !done[1]) {
        for (int k = 0; k < 2; k++) {
            leafcast_stats stats = {.size = sizeof stats};
            assert_int_equal(leafcast_frame_advance(frame[k], 0, &done[k], &stats), LEAFCAST_OK);
            assert_true(memory == 0 || stats.bytes_peak <= memory);
        }
        calls++;
        assert_true(calls < 100000);
    }
    assert_true(WATCHED || calls > 3); /* of smaller pictures there may be fewer */
    for (int k = 0; k < 2; k++) {
        leafcast_frame_end(frame[k]);
        scene_stage_same(&whole[k], &sliced[k]);
    }
    scene_stage_close(&v);
}

static void slices_make_the_whole(void **state) {
    slice(*state, 0);
    slice(*state, 9 << 20);
}

static void a_cancelled_frame_stops(void **state) {
    static picture p;
    const leafcast_camera c = scene_stage_view(68);
    const leafcast_image image = {.size = sizeof image, .z = p.z};
    scene_pair v;
    leafcast_frame *frame;
    bool done;
    scene_stage_open(&v, *state, NULL, 1);
    assert_int_equal(leafcast_frame_begin(v.volume[0], &v.scene, &c, &image, &frame), LEAFCAST_OK);
    assert_int_equal(leafcast_frame_advance(frame, 0, &done, NULL), LEAFCAST_OK);
    assert_false(done);
    leafcast_frame_cancel(frame);
    assert_int_equal(leafcast_frame_advance(frame, INFINITY, &done, NULL), LEAFCAST_STOPPED);
    assert_false(done);
    leafcast_frame_end(frame);
    pictures_draw(v.volume[0], &v.scene, &c, &p, NULL);
    scene_stage_close(&v);
}

/* ---- Parallel rays ---- */

static void orthographic_is_what_the_reference_says(void **state) {
    const scene_stage *s = *state;
    static picture p;
    leafcast_camera c = scene_stage_view(68);
    scene_pair v;
    int judged = 0, met_any = 0;
    c.fov = 0;
    c.ortho_height = 44;
    scene_stage_open(&v, s, NULL, 2);
    pictures_draw(v.volume[0], &v.scene, &c, &p, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i += STEP) {
        const ref_ray r = pixel_of(&c, i), next = pixel_of(&c, i + 1 < PICTURE_PIXELS ? i + 1 : i);
        met all[2 * HITS];
        size_t count;
        assert_memory_equal(r.d, next.d, sizeof r.d);
        if (!truth(s, &r, all, &count))
            continue;
        judged++;
        met_any += count > 0;
        assert_int_equal(p.id[i], count ? all[0].id : -1);
        if (count)
            assert_true(fabs(p.z[i] - all[0].t) < 1e-4);
    }
    assert_true(met_any > judged / 4 && met_any < judged);
    scene_stage_close(&v);
}

/* ---- Batches ---- */

/* By the kernels of an ISA, NULL: the best; which of the two volumes, 2: both. Treelets are all
 * there. Returns the nodes that it took. */
static uint64_t draw_by(const scene_stage *s, const char *isa, int which, const leafcast_camera *c,
                        picture *p) {
    const leafcast_options o = {.size = sizeof o, .threads = 2, .isa = isa};
    leafcast_stats stats;
    scene_pair v;
    scene_stage_open(&v, s, &o, 0);
    leafcast_scene scene = scene_stage_lit(&v);
    scene.volumes = which < 2 ? &v.shown[which] : v.shown;
    scene.volume_count = which < 2 ? 1 : 2;
    pictures_draw(v.volume[which % 2], &scene, c, p, NULL);
    stats.size = sizeof stats;
    pictures_draw(v.volume[which % 2], &scene, c, p, &stats);
    scene_stage_close(&v);
    return stats.nodes;
}

/* Parallel rays, and those through two volumes, visit nodes together. */
static void no_ray_goes_alone(void **state) {
    const scene_stage *s = *state;
    static picture alone, together;
    for (int which = 0; which < 3; which++) {
        leafcast_camera c = scene_stage_view(68);
        c.ortho_height = which < 2 ? 44 : 0;
        const uint64_t most = draw_by(s, "scalar", which, &c, &alone);
        const uint64_t nodes = draw_by(s, NULL, which, &c, &together);
        scene_stage_same(&alone, &together);
        assert_true(most > 0);
        if (cpu_best() != CPU_SCALAR && 3 * nodes > most)
            fail_msg("volume %d: %llu nodes, one by one %llu", which, (unsigned long long)nodes,
                     (unsigned long long)most);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_volumes_are_what_the_references_say),
        cmocka_unit_test(budgets_and_threads_do_not_show),
        cmocka_unit_test(volumes_of_a_device_share_its_budget),
        cmocka_unit_test(parts_make_the_whole),
        cmocka_unit_test(slices_make_the_whole),
        cmocka_unit_test(a_cancelled_frame_stops),
        cmocka_unit_test(orthographic_is_what_the_reference_says),
        cmocka_unit_test(no_ray_goes_alone),
    };
    return cmocka_run_group_tests(tests, scene_stage_set, scene_stage_clear);
}
