/* test_scene.c - scenes of several volumes on one device: what the references say, and the same
 * bits for any budget, in turns, in parts, by the host's threads; rays of the caller's own. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/leaf_files.h"
#include "tests/support/pictures.h"
#include "tests/support/ref_judge.h"
#include "tests/support/tet_judge.h"
#include "tests/support/watched.h"

enum { NODES = 36, CUBES = 6, HITS = 64 };

enum { STEP = WATCHED ? 23 : 5 };

/* A grid and a mesh in the same place, and what is true of them. */
typedef struct stage {
    char grid_path[512], mesh_path[512];
    float *samples;
    ref_volume grid;
    lab_mesh lab;
    tet_ref_mesh raw;
    tet_ref *mesh;
} stage;

static const leafcast_surface GRID_SURFACES[] = {{0.5, {0.9f, 0.2f, 0.1f}, 0.4f},
                                                 {1.1, {0.1f, 0.8f, 0.3f}, 0.6f}};
static leafcast_surface mesh_surface = {0, {0.2f, 0.3f, 0.9f}, 0.5f};
static const double GRID_ISOS[] = {0.5, 1.1};

static int set_stage(void **state) {
    static stage s;
    const long dims[3] = {NODES, NODES, NODES};
    leaf_case c = leaf_files_case(NODES, NODES, NODES, SAMPLE_F32);
    s.samples = leaf_files_random(&c, 11, 0);
    c.samples = s.samples;
    strcpy(s.grid_path, leaf_files_make(&c, "grid.leaf"));
    s.grid = ref_volume_regular(dims, s.samples, NULL, NULL);
    assert_true(lab_mesh_make(&s.lab, "noise", CUBES, 7));
    for (size_t i = 0; i < s.lab.point_count; i++)
        for (int a = 0; a < 3; a++) {
            const double share =
                ((double)s.lab.points[i][a] - s.lab.lo[a]) / (s.lab.hi[a] - s.lab.lo[a]);
            s.lab.points[i][a] = (float)(4.0 + 27.0 * share);
        }
    strcpy(s.mesh_path, lab_leaf_make(&s.lab, 200, false));
    s.raw = lab_mesh_reference(&s.lab);
    s.mesh = tet_ref_create(&s.raw);
    assert_non_null(s.mesh);
    mesh_surface.isovalue = s.lab.iso;
    *state = &s;
    return 0;
}

static int clear_stage(void **state) {
    stage *s = *state;
    tet_ref_destroy(s->mesh);
    lab_mesh_release(&s->lab);
    free(s->samples);
    return 0;
}

/* Both files on one device, and a scene of them. */
typedef struct pair {
    leafcast_device *device;
    leafcast *volume[2];
    leafcast_shown shown[2];
    leafcast_scene scene;
} pair;

static void open_pair(pair *p, const stage *s, const leafcast_options *device, uint32_t treelets) {
    assert_int_equal(leafcast_device_create(device, &p->device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o,
                                .device = p->device,
                                .experiments = EXPERIMENTS(.treelet_limit = treelets)};
    assert_int_equal(leafcast_open(s->grid_path, &o, &p->volume[0]), LEAFCAST_OK);
    assert_int_equal(leafcast_open(s->mesh_path, &o, &p->volume[1]), LEAFCAST_OK);
    p->shown[0] = (leafcast_shown){p->volume[0], 0, 0, GRID_SURFACES, 2};
    p->shown[1] = (leafcast_shown){p->volume[1], 0, 0, &mesh_surface, 1};
    p->scene = leafcast_scene_default();
    p->scene.volumes = p->shown;
    p->scene.volume_count = 2;
}

static void close_pair(pair *p) {
    leafcast_close(p->volume[0]);
    leafcast_device_destroy(p->device); /* ends with the last volume */
    leafcast_close(p->volume[1]);
}

static leafcast_camera view_of(double from) {
    return (leafcast_camera){.size = sizeof(leafcast_camera),
                             .eye = {from, 0.6 * from + 3.1, 0.8 * from},
                             .look_at = {17.3, 17.1, 17.7},
                             .up = {0, 0, 1},
                             .fov = 40,
                             .width = PICTURE_WIDTH,
                             .height = PICTURE_HEIGHT};
}

static ref_ray pixel_of(const leafcast_camera *c, int i) {
    ref_ray r;
    leafcast_pixel_ray(c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, r.o, r.d);
    return r;
}

static void same_picture(const picture *a, const picture *b) {
    assert_memory_equal(a->z, b->z, sizeof a->z);
    assert_memory_equal(a->id, b->id, sizeof a->id);
    assert_memory_equal(a->normal, b->normal, sizeof a->normal);
    assert_memory_equal(a->rgba, b->rgba, sizeof a->rgba);
}

/* ---- What is true ---- */

/* A surface of either volume. */
typedef struct met {
    double t;
    int id;
} met;

/* All that a ray meets, in order; false: a reference does not want to be asked. */
static bool truth(const stage *s, const ref_ray *r, met all[2 * HITS], size_t *count) {
    ref_hit of_grid[HITS], of_mesh[HITS];
    const size_t g = ref_trace(&s->grid, r, GRID_ISOS, 2, NULL, of_grid, HITS);
    const size_t m = tet_ref_trace(s->mesh, r, &s->lab.iso, 1, NULL, of_mesh, HITS);
    size_t i = 0, k = 0;
    *count = 0;
    if (g >= HITS || m >= HITS || ref_grazing(&s->grid, r, GRID_ISOS, 2, NULL, HITS) ||
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
        const leafcast_surface *s = all[i].id < 2 ? &GRID_SURFACES[all[i].id] : &mesh_surface;
        const double weight = (1 - rgba[3]) * (double)s->opacity;
        for (int c = 0; c < 3; c++)
            rgba[c] += weight * (double)s->rgb[c];
        rgba[3] += weight;
    }
}

static void two_volumes_are_what_the_references_say(void **state) {
    const stage *s = *state;
    static picture p;
    pair v;
    int judged = 0, mixed = 0;
    open_pair(&v, s, NULL, 0);
    v.scene.shading = LEAFCAST_SHADING_FLAT;
    for (int from = 0; from < 2; from++) {
        const leafcast_camera c = view_of(from ? 16.2 : 68); /* inside, outside */
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
    close_pair(&v);
}

/* ---- The same bits ---- */

static leafcast_scene lit(const pair *v) {
    leafcast_scene scene = v->scene;
    scene.light_count = 2;
    scene.lights[0] = (leafcast_light){false, {1, 0.4, 2}, {0.8f, 0.7f, 0.6f}};
    scene.lights[1] = (leafcast_light){true, {60, -20, 50}, {0.3f, 0.4f, 0.5f}};
    scene.shadows = true;
    return scene;
}

/* The least budget that draws it. */
static uint64_t least_budget(const stage *s, const leafcast_camera *c) {
    static float plane[PICTURE_PIXELS];
    static double depth[PICTURE_PIXELS];
    uint64_t budget = 1 << 20;
    for (;; budget += 64 << 10) {
        const leafcast_options o = {.size = sizeof o, .memory = budget, .threads = 3};
        pair v;
        leafcast_image planes = {.size = sizeof planes, .r = plane, .z = depth};
        leafcast_device *d = NULL;
        leafcast *a = NULL, *b = NULL;
        assert_int_equal(leafcast_device_create(&o, &d), LEAFCAST_OK);
        const leafcast_options on = {.size = sizeof on, .device = d};
        bool fits = !leafcast_open(s->grid_path, &on, &a) && !leafcast_open(s->mesh_path, &on, &b);
        if (fits) {
            const leafcast_shown shown[2] = {{a, 0, 0, GRID_SURFACES, 2},
                                             {b, 0, 0, &mesh_surface, 1}};
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
    const stage *s = *state;
    static picture truth_of, other;
    const leafcast_camera c = view_of(68);
    const uint64_t least = least_budget(s, &c) + PICTURE_PIXELS * 64;
    pair v;
    open_pair(&v, s, NULL, 0);
    leafcast_scene scene = lit(&v);
    pictures_draw(v.volume[1], &scene, &c, &truth_of, NULL);
    close_pair(&v);
    for (int kind = 0; kind < 4; kind++) {
        const leafcast_options o = {
            .size = sizeof o, .threads = kind % 2 ? 3 : 1, .memory = kind < 2 ? 0 : least};
        leafcast_stats stats = {.size = sizeof stats};
        open_pair(&v, s, &o, kind < 2 ? 1 : 0);
        scene = lit(&v);
        pictures_draw(v.volume[0], &scene, &c, &other, &stats);
        same_picture(&truth_of, &other);
        if (o.memory)
            assert_true(stats.bytes_peak <= o.memory);
        assert_true(stats.treelets_loaded >= 2);
        close_pair(&v);
    }
}

/* The host's threads: one after the other, on this one. */
static void run_in_turn(void *host, int count, void (*work)(void *arg, int index), void *arg) {
    ++*(int *)host;
    for (int i = count; i-- > 0;)
        work(arg, i);
}

static void host_threads_draw_the_same(void **state) {
    const stage *s = *state;
    static picture truth_of, other;
    const leafcast_camera c = view_of(68);
    int runs = 0;
    const leafcast_options o = {.size = sizeof o, .threads = 5, .run = run_in_turn, .host = &runs};
    pair v;
    open_pair(&v, s, NULL, 0);
    leafcast_scene scene = lit(&v);
    pictures_draw(v.volume[0], &scene, &c, &truth_of, NULL);
    close_pair(&v);
    open_pair(&v, s, &o, 1);
    scene = lit(&v);
    pictures_draw(v.volume[0], &scene, &c, &other, NULL);
    same_picture(&truth_of, &other);
    assert_true(runs > 0);
    close_pair(&v);
}

static void volumes_of_a_device_share_its_budget(void **state) {
    const stage *s = *state;
    static picture alone, shared;
    const leafcast_camera c = view_of(68);
    const leafcast_options o = {.size = sizeof o, .memory = 5 << 20};
    pair v;
    open_pair(&v, s, &o, 0);
    for (int turn = 0; turn < 4; turn++) {
        leafcast *one = v.volume[turn % 2];
        leafcast_stats stats = {.size = sizeof stats};
        const leafcast_scene scene = leafcast_scene_default();
        assert_int_equal(
            leafcast_select(one, turn % 2 ? &mesh_surface : GRID_SURFACES, turn % 2 ? 1 : 2),
            LEAFCAST_OK);
        pictures_draw(one, &scene, &c, &shared, &stats);
        assert_true(stats.bytes_peak <= o.memory);
        leafcast *own;
        assert_int_equal(leafcast_open(turn % 2 ? s->mesh_path : s->grid_path, NULL, &own),
                         LEAFCAST_OK);
        assert_int_equal(
            leafcast_select(own, turn % 2 ? &mesh_surface : GRID_SURFACES, turn % 2 ? 1 : 2),
            LEAFCAST_OK);
        pictures_draw(own, &scene, &c, &alone, NULL);
        same_picture(&alone, &shared);
        leafcast_close(own);
    }
    close_pair(&v);
}

/* ---- Parts of pictures ---- */

static void parts_make_the_whole(void **state) {
    const stage *s = *state;
    static picture whole, parts;
    static uint8_t bytes[4 * PICTURE_PIXELS], part_bytes[4 * PICTURE_PIXELS];
    const leafcast_camera c = view_of(68);
    for (int samples = 1; samples <= 4; samples += 3) {
        for (int several = 0; several < 2; several++) {
            pair v;
            open_pair(&v, s, NULL, 0);
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
            close_pair(&v);
        }
    }
}

/* Two frames of one device, slice by slice in turn. */
static void slice(const stage *s, uint64_t memory) {
    static picture whole[2], sliced[2];
    const leafcast_camera c[2] = {view_of(68), view_of(-40)};
    pair v;
    leafcast_frame *frame[2];
    bool done[2] = {false, false};
    int calls = 0;
    const leafcast_options o = {.size = sizeof o, .threads = 2, .memory = memory};
    open_pair(&v, s, &o, memory ? 0 : 2);
    leafcast_scene scene[2] = {lit(&v), v.scene};
    leafcast_surface later = GRID_SURFACES[1];
    leafcast_shown shown[1] = {{v.volume[0], 0, 0, &later, 1}};
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
        same_picture(&whole[k], &sliced[k]);
    }
    close_pair(&v);
}

static void slices_make_the_whole(void **state) {
    slice(*state, 0);
    slice(*state, 8 << 20);
}

static void a_cancelled_frame_stops(void **state) {
    static picture p;
    const leafcast_camera c = view_of(68);
    const leafcast_image image = {.size = sizeof image, .z = p.z};
    pair v;
    leafcast_frame *frame;
    bool done;
    open_pair(&v, *state, NULL, 1);
    assert_int_equal(leafcast_frame_begin(v.volume[0], &v.scene, &c, &image, &frame), LEAFCAST_OK);
    assert_int_equal(leafcast_frame_advance(frame, 0, &done, NULL), LEAFCAST_OK);
    assert_false(done);
    leafcast_frame_cancel(frame);
    assert_int_equal(leafcast_frame_advance(frame, INFINITY, &done, NULL), LEAFCAST_STOPPED);
    assert_false(done);
    leafcast_frame_end(frame);
    pictures_draw(v.volume[0], &v.scene, &c, &p, NULL);
    close_pair(&v);
}

/* ---- Parallel rays ---- */

static void orthographic_is_what_the_reference_says(void **state) {
    const stage *s = *state;
    static picture p;
    leafcast_camera c = view_of(68);
    pair v;
    int judged = 0, met_any = 0;
    c.fov = 0;
    c.ortho_height = 44;
    open_pair(&v, s, NULL, 2);
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
    close_pair(&v);
}

/* ---- Batches ---- */

/* By the kernels of an ISA, NULL: the best; which of the two volumes, 2: both. Treelets are all
 * there. Returns the nodes that it took. */
static uint64_t draw_by(const stage *s, const char *isa, int which, const leafcast_camera *c,
                        picture *p) {
    const leafcast_options o = {.size = sizeof o, .threads = 2, .isa = isa};
    leafcast_stats stats;
    pair v;
    open_pair(&v, s, &o, 0);
    leafcast_scene scene = lit(&v);
    scene.volumes = which < 2 ? &v.shown[which] : v.shown;
    scene.volume_count = which < 2 ? 1 : 2;
    pictures_draw(v.volume[which % 2], &scene, c, p, NULL);
    stats.size = sizeof stats;
    pictures_draw(v.volume[which % 2], &scene, c, p, &stats);
    close_pair(&v);
    return stats.nodes;
}

/* Parallel rays, and those through two volumes, visit nodes together. */
static void no_ray_goes_alone(void **state) {
    const stage *s = *state;
    static picture alone, together;
    for (int which = 0; which < 3; which++) {
        leafcast_camera c = view_of(68);
        c.ortho_height = which < 2 ? 44 : 0;
        const uint64_t most = draw_by(s, "scalar", which, &c, &alone);
        const uint64_t nodes = draw_by(s, NULL, which, &c, &together);
        same_picture(&alone, &together);
        assert_true(most > 0);
        if (cpu_best() != CPU_SCALAR && 3 * nodes > most)
            fail_msg("volume %d: %llu nodes, one by one %llu", which, (unsigned long long)nodes,
                     (unsigned long long)most);
    }
}

/* ---- Rays of the caller's own ---- */

enum { RAYS = WATCHED ? 600 : 2500 };

static void rays_meet_what_pixels_see(void **state) {
    const stage *s = *state;
    static picture p;
    static leafcast_ray rays[PICTURE_PIXELS];
    static leafcast_ray_hit hits[PICTURE_PIXELS];
    static uint8_t occluded[PICTURE_PIXELS];
    const leafcast_camera c = view_of(68);
    pair v;
    open_pair(&v, s, NULL, 1);
    pictures_draw(v.volume[0], &v.scene, &c, &p, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        leafcast_pixel_ray(&c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, rays[i].origin,
                           rays[i].direction);
        rays[i].t1 = INFINITY;
    }
    assert_int_equal(leafcast_trace_rays(v.volume[0], &v.scene, rays, PICTURE_PIXELS, hits),
                     LEAFCAST_OK);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        assert_true(hits[i].t == p.z[i] && hits[i].surface == p.id[i]);
        if (p.id[i] < 0)
            continue;
        assert_int_equal(hits[i].volume, p.id[i] == 2);
        assert_true(hits[i].isovalue == (p.id[i] < 2 ? GRID_ISOS[p.id[i]] : s->lab.iso));
        assert_true(hits[i].error_bound < 1e-6);
        for (int a = 0; a < 3; a++)
            assert_true(hits[i].normal[a] == p.normal[a][i]);
        /* Up to just before it there is nothing. */
        rays[i].t1 = i % 2 ? hits[i].t * (1 + 1e-9) : hits[i].t - 1e-6;
    }
    assert_int_equal(leafcast_occluded_rays(v.volume[0], &v.scene, rays, PICTURE_PIXELS, occluded),
                     LEAFCAST_OK);
    for (int i = 0; i < PICTURE_PIXELS; i++)
        assert_int_equal(occluded[i], p.id[i] >= 0 && i % 2);
    close_pair(&v);
}

static void rays_are_checked(void **state) {
    const leafcast_ray bad[] = {{{0, 0, 0}, {0, 0, 0}, 0, 1},
                                {{NAN, 0, 0}, {1, 0, 0}, 0, 1},
                                {{0, 0, 0}, {1, 0, 0}, 2, 1},
                                {{0, 0, 0}, {1, 0, 0}, NAN, 1}};
    leafcast_ray_hit hit;
    pair v;
    open_pair(&v, *state, NULL, 0);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(leafcast_trace_rays(v.volume[0], &v.scene, &bad[i], 1, &hit),
                         LEAFCAST_USAGE);
    assert_int_equal(leafcast_trace_rays(v.volume[0], &v.scene, bad, 0, &hit), LEAFCAST_OK);
    close_pair(&v);
}

static void points_are_sampled(void **state) {
    static double points[RAYS][3];
    static leafcast_sample samples[RAYS];
    const stage *s = *state;
    field_random r = {3};
    pair v;
    int inside = 0;
    open_pair(&v, s, NULL, 1);
    for (int i = 0; i < RAYS; i++)
        for (int a = 0; a < 3; a++)
            points[i][a] = 40 * field_random_unit(&r) - 2;
    assert_int_equal(leafcast_sample_points(v.volume[0], (const double(*)[3])points, RAYS, samples),
                     LEAFCAST_OK);
    for (int i = 0; i < RAYS; i++) {
        const long double at[3] = {points[i][0], points[i][1], points[i][2]};
        const long double truly = ref_value(&s->grid, at, 0);
        assert_int_equal(samples[i].inside, !isnan(truly));
        inside += samples[i].inside;
        if (samples[i].inside)
            assert_true(fabsl((long double)samples[i].value - truly) < 1e-6L);
    }
    assert_true(inside > RAYS / 2 && inside < RAYS);
    close_pair(&v);
}

/* ---- Scenes that cannot be ---- */

static void scenes_are_checked(void **state) {
    static picture p;
    const stage *s = *state;
    const leafcast_camera c = view_of(68);
    leafcast_image image = {.size = sizeof image, .z = p.z};
    pair v, w;
    open_pair(&v, s, NULL, 0);
    open_pair(&w, s, NULL, 0);
#define REFUSED()                                                                         \
    assert_int_equal(leafcast_trace(v.volume[0], &v.scene, &c, &image, NULL, NULL, NULL), \
                     LEAFCAST_USAGE)
    v.shown[1].volume = w.volume[1]; /* of another device */
    REFUSED();
    v.shown[1] = v.shown[0]; /* twice */
    REFUSED();
    v.scene.volume_count = 1;
    v.shown[0].step = 1;
    REFUSED();
    v.shown[0].step = 0;
    v.shown[0].count = 0;
    REFUSED();
    v.shown[0].count = 2;
    image.width = PICTURE_WIDTH;
    image.height = PICTURE_HEIGHT;
    image.x = 1; /* beyond the picture */
    REFUSED();
    image.x = 0;
    image.stride = PICTURE_WIDTH - 1;
    REFUSED();
    image.stride = 0;
    assert_int_equal(leafcast_trace(v.volume[0], &v.scene, &c, &image, NULL, NULL, NULL),
                     LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = v.device, .memory = 1 << 20};
    leafcast *none;
    assert_int_equal(leafcast_open(s->grid_path, &o, &none), LEAFCAST_USAGE);
    close_pair(&v);
    close_pair(&w);
}

/* ---- Several threads of the host's ---- */

enum { THREADS = 8, PICTURES = 3 };

typedef struct guest {
    const stage *s;
    leafcast *volume; /* of all; NULL: its own */
    double isovalue;
    double z[PICTURE_PIXELS];
} guest;

static void *draw_as_guest(void *arg) {
    guest *g = arg;
    leafcast *v = g->volume;
    const leafcast_options o = {.size = sizeof o, .threads = 2};
    const leafcast_surface surface = leafcast_surface_default(g->isovalue);
    const leafcast_camera c = view_of(68);
    const leafcast_image image = {.size = sizeof image, .z = g->z};
    leafcast_scene scene = leafcast_scene_default();
    if (!v && leafcast_open(g->s->grid_path, &o, &v))
        return NULL;
    const leafcast_shown shown = {v, 0, 0, &surface, 1};
    scene.volumes = &shown;
    scene.volume_count = 1;
    for (int i = 0; i < PICTURES; i++)
        if (leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL))
            g->z[0] = NAN;
    if (!g->volume)
        leafcast_close(v);
    return g;
}

/* own: each with a volume; else some on one, each with an isovalue of its own. */
static void host_many(const stage *s, int threads, bool own) {
    static guest guests[THREADS], alone;
    pthread_t thread[THREADS];
    leafcast *one = NULL;
    if (!own)
        assert_int_equal(leafcast_open(s->grid_path, NULL, &one), LEAFCAST_OK);
    for (int i = 0; i < threads; i++) {
        guests[i] = (guest){.s = s, .volume = one, .isovalue = 0.4 + 0.1 * i};
        assert_int_equal(pthread_create(&thread[i], NULL, draw_as_guest, &guests[i]), 0);
    }
    for (int i = 0; i < threads; i++) {
        void *ended;
        pthread_join(thread[i], &ended);
        assert_non_null(ended);
    }
    leafcast_close(one);
    for (int i = 0; i < threads; i++) {
        alone = (guest){.s = s, .isovalue = guests[i].isovalue};
        assert_non_null(draw_as_guest(&alone));
        assert_memory_equal(alone.z, guests[i].z, sizeof alone.z);
    }
}

static void eight_threads_draw_a_volume_each(void **state) {
    host_many(*state, THREADS, true);
}

static void four_threads_draw_one_volume(void **state) {
    host_many(*state, 4, false);
}

/* Media without points are none. */
static void media_of_nothing_change_nothing(void **state) {
    const stage *s = *state;
    static picture with, without;
    const leafcast_medium nothing[2] = {{NULL, 0}, {NULL, 0}};
    const leafcast_camera c = view_of(68);
    pair v;
    open_pair(&v, s, NULL, 0);
    leafcast_scene scene = lit(&v);
    pictures_draw(v.volume[0], &scene, &c, &without, NULL);
    scene.media = nothing;
    scene.media_count = 2;
    pictures_draw(v.volume[0], &scene, &c, &with, NULL);
    same_picture(&with, &without);
    v.shown[0].count = v.shown[1].count = 0;
    const leafcast_image image = {.size = sizeof image, .z = with.z};
    assert_int_equal(leafcast_trace(v.volume[0], &scene, &c, &image, NULL, NULL, NULL),
                     LEAFCAST_USAGE);
    close_pair(&v);
}

/* Rays and probes look for surfaces; where a scene has only media there are none. */
static void media_are_no_surfaces(void **state) {
    const stage *s = *state;
    const leafcast_transfer_point point = {0.5, {1, 1, 1}, 0.1};
    const leafcast_medium media[2] = {{&point, 1}, {NULL, 0}};
    const leafcast_camera c = view_of(68);
    leafcast_ray ray = {.t1 = (double)INFINITY};
    leafcast_ray_hit first = {.t = 0};
    leafcast_hit hits[4];
    uint8_t occluded = 1;
    int count = -1;
    pair v;
    open_pair(&v, s, NULL, 0);
    leafcast_pixel_ray(&c, PICTURE_WIDTH * 0.5, PICTURE_HEIGHT * 0.5, ray.origin, ray.direction);
    v.scene.media = media;
    v.scene.media_count = 2;
    v.shown[0].count = v.shown[1].count = 0;
    assert_int_equal(leafcast_trace_rays(v.volume[0], &v.scene, &ray, 1, &first), LEAFCAST_OK);
    assert_true(isinf(first.t) && first.surface == -1);
    assert_int_equal(leafcast_occluded_rays(v.volume[0], &v.scene, &ray, 1, &occluded),
                     LEAFCAST_OK);
    assert_int_equal(occluded, 0);
    assert_int_equal(
        leafcast_probe_ray(v.volume[0], &v.scene, ray.origin, ray.direction, hits, 4, &count),
        LEAFCAST_OK);
    assert_int_equal(count, 0);
    close_pair(&v);
}

/* Values do not fall, nor rise by less than anything can tell. */
static void transfer_functions_are_checked(void **state) {
    const stage *s = *state;
    static const struct {
        leafcast_transfer_point points[2];
        const char *why; /* NULL: fine */
    } cases[] = {
        {{{-1e-290, {1, 1, 1}, 1}, {0, {1, 1, 1}, 0}}, NULL},
        {{{3, {1, 1, 1}, 1}, {3, {1, 1, 1}, 0}}, NULL},
        {{{0, {1, 1, 1}, 1}, {1e-291, {1, 1, 1}, 0}}, "point 2 of the transfer function: its"},
        {{{4, {1, 1, 1}, 1}, {3, {1, 1, 1}, 0}}, "point 2 of the transfer function has a smaller"},
        {{{4, {1, -1, 1}, 1}, {5, {1, 1, 1}, 0}}, "leafcast_scene.media[0].points[0].rgb[1] is -1"},
        {{{4, {1, 1, 1}, 1}, {(double)NAN, {1, 1, 1}, 0}}, "media[0].points[1].value is"},
        {{{4, {1, 1, 1}, 1}, {5, {1, 1, 1}, -1}}, "media[0].points[1].extinction"},
    };
    static picture p;
    const leafcast_camera c = view_of(68);
    const leafcast_image image = {.size = sizeof image, .z = p.z};
    pair v;
    open_pair(&v, s, NULL, 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const leafcast_medium media[2] = {{cases[i].points, 2}, {NULL, 0}};
        v.scene.media = media;
        v.scene.media_count = 2;
        assert_int_equal(leafcast_trace(v.volume[0], &v.scene, &c, &image, NULL, NULL, NULL),
                         cases[i].why ? LEAFCAST_USAGE : LEAFCAST_OK);
        if (cases[i].why)
            assert_non_null(strstr(leafcast_error_text(), cases[i].why));
    }
    close_pair(&v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(transfer_functions_are_checked),
        cmocka_unit_test(media_of_nothing_change_nothing),
        cmocka_unit_test(media_are_no_surfaces),
        cmocka_unit_test(two_volumes_are_what_the_references_say),
        cmocka_unit_test(budgets_and_threads_do_not_show),
        cmocka_unit_test(host_threads_draw_the_same),
        cmocka_unit_test(volumes_of_a_device_share_its_budget),
        cmocka_unit_test(parts_make_the_whole),
        cmocka_unit_test(slices_make_the_whole),
        cmocka_unit_test(a_cancelled_frame_stops),
        cmocka_unit_test(orthographic_is_what_the_reference_says),
        cmocka_unit_test(no_ray_goes_alone),
        cmocka_unit_test(rays_meet_what_pixels_see),
        cmocka_unit_test(rays_are_checked),
        cmocka_unit_test(points_are_sampled),
        cmocka_unit_test(scenes_are_checked),
        cmocka_unit_test(eight_threads_draw_a_volume_each),
        cmocka_unit_test(four_threads_draw_one_volume),
    };
    return cmocka_run_group_tests(tests, set_stage, clear_stage);
}
