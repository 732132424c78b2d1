/* test_dynamic.c - triangles in memory whose vertices move: after each update rays and pictures
 * have the bits of a volume that is opened with these positions, and are right by brute force in
 * long double; whatever has begun shows one set of positions to its end; bad arguments are named.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/triangle_truth.h"

static void fine(leafcast_status st) {
    if (st != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

static void refused(leafcast_status st, leafcast_status as, const char *why) {
    assert_int_equal(st, as);
    if (!strstr(leafcast_error_text(), why))
        fail_msg("\"%s\" is not in: %s", why, leafcast_error_text());
}

static void select_one(leafcast *v) {
    const leafcast_surface surface = leafcast_surface_default(0.0);
    fine(leafcast_select(v, &surface, 1));
}

/* ---- A bent tube of several treelets ---- */

enum { ROUND = 24, TUBE_SIDES = 2 * ROUND };

typedef struct tube {
    leafcast_triangles of;
    float (*xyz)[3];
    uint32_t (*rows)[3], *colours;
    float *values;
    leafcast *shown; /* by whoever wants it */
} tube;

/* A helix that is bent and turned with the phase. */
static void bend(tube *t, double phase) {
    const uint32_t rings = t->of.vertex_count / ROUND;
    for (uint32_t i = 0; i < rings; i++) {
        const double u = (double)i / rings, turn = 6.0 * 6.28318530717958648 * u * (1.0 + phase);
        for (uint32_t k = 0; k < ROUND; k++) {
            const double v = 6.28318530717958648 * k / ROUND,
                         away = 1.0 + 0.25 * cos(v) + phase * u;
            float *p = t->xyz[ROUND * i + k];
            p[0] = (float)(away * cos(turn));
            p[1] = (float)(away * sin(turn) + 0.5 * phase * u * u);
            p[2] = (float)(4.0 * u + 0.25 * sin(v));
        }
    }
}

static tube tube_make(uint32_t rings) {
    const uint32_t vertices = rings * ROUND, triangles = (rings - 1) * TUBE_SIDES;
    tube t = {.xyz = malloc(vertices * sizeof *t.xyz),
              .rows = malloc(triangles * sizeof *t.rows),
              .colours = malloc(vertices * sizeof *t.colours),
              .values = malloc(vertices * sizeof *t.values)};
    uint32_t n = 0;
    for (uint32_t i = 0; i + 1 < rings; i++)
        for (uint32_t k = 0; k < ROUND; k++) {
            const uint32_t a = ROUND * i + k, b = ROUND * i + (k + 1) % ROUND;
            const uint32_t two[2][3] = {{a, b, a + ROUND}, {b, b + ROUND, a + ROUND}};
            memcpy(t.rows + n, two, sizeof two);
            n += 2;
        }
    assert_int_equal(n, triangles);
    for (uint32_t v = 0; v < vertices; v++) {
        t.values[v] = (float)(v % 1000) * 0.001f;
        t.colours[v] = v * 2654435761u >> 8;
    }
    t.of = (leafcast_triangles){.size = sizeof t.of,
                                .vertex_count = vertices,
                                .triangle_count = triangles,
                                .vertices = (const float(*)[3])t.xyz,
                                .triangles = (const uint32_t(*)[3])t.rows,
                                .values = t.values,
                                .colours = t.colours,
                                .field = "heat"};
    bend(&t, 0.0);
    return t;
}

static void tube_free(tube *t) {
    free(t->xyz);
    free(t->rows);
    free(t->colours);
    free(t->values);
}

static void move(leafcast *v, const tube *t) {
    fine(leafcast_update_vertices(v, (const float(*)[3])t->xyz, t->of.vertex_count));
}

static leafcast *open_tube(const tube *t, const leafcast_options *o) {
    leafcast *v;
    fine(leafcast_open_triangles(&t->of, o, &v));
    select_one(v);
    return v;
}

/* ---- The same bits ---- */

static bool same_hit(const leafcast_ray_hit *a, const leafcast_ray_hit *b) {
    return memcmp(&a->t, &b->t, sizeof a->t) == 0 &&
           memcmp(&a->error_bound, &b->error_bound, sizeof a->error_bound) == 0 &&
           a->cell == b->cell && a->volume == b->volume && a->surface == b->surface &&
           a->entering == b->entering && memcmp(a->normal, b->normal, sizeof a->normal) == 0;
}

static void same_facts(leafcast *moved, leafcast *fresh) {
    const leafcast_info a = leafcast_describe(moved), b = leafcast_describe(fresh);
    assert_memory_equal(a.bounds, b.bounds, sizeof a.bounds);
    assert_true(a.cell_size == b.cell_size && a.cells == b.cells && a.nodes == b.nodes);
    assert_true(a.steps == 1 && a.fields == b.fields && a.value_min == b.value_min &&
                a.value_max == b.value_max);
    assert_string_equal(a.kind, "triangles");
    for (uint64_t n = 0; n < a.cells; n += 1 + a.cells / 50) {
        leafcast_cell x = {.size = sizeof x}, y = {.size = sizeof y};
        fine(leafcast_get_cell(moved, 0, n, &x));
        fine(leafcast_get_cell(fresh, 0, n, &y));
        assert_true(x.cell == n && x.corners == 3);
        assert_memory_equal(x.position, y.position, sizeof x.position);
        assert_memory_equal(x.value, y.value, sizeof x.value);
    }
}

static void same_pixels(const picture *a, const picture *b) {
    assert_memory_equal(a->rgba, b->rgba, sizeof a->rgba);
    assert_memory_equal(a->normal, b->normal, sizeof a->normal);
    assert_memory_equal(a->z, b->z, sizeof a->z);
    assert_memory_equal(a->id, b->id, sizeof a->id);
}

/* Looks: plain; with shadows, occlusion; through a transparent surface cut by a plane, with an
 * orthographic camera; twice at places, coloured by value, beside each other. */
enum { PLAIN, LIT, CLEAR, TWICE, LOOKS };

static void draw(leafcast *v, int look, uint32_t of, picture *to) {
    static const leafcast_transfer_point points[2] = {{0.0, {0.1, 0.2, 0.9}, 0.0},
                                                      {1.0, {0.9, 0.3, 0.1}, 0.0}};
    static const leafcast_medium map = {points, 2};
    static const double aside[12] = {0, -1, 0, 2.5, 1, 0, 0, 0, 0, 0, 0.5, 1};
    leafcast_surface surface = leafcast_surface_default(0.0);
    leafcast_shown shown[2] = {{.volume = v, .field = of, .surfaces = &surface, .count = 1},
                               {.volume = NULL}};
    leafcast_scene scene = leafcast_scene_default();
    leafcast_camera c = leafcast_standard_view(v, 1.6, PICTURE_WIDTH, PICTURE_HEIGHT);
    leafcast_stats stats = {.size = sizeof stats};
    scene.volumes = shown;
    scene.volume_count = 1 + (look == TWICE);
    if (look == LIT) {
        scene.shadows = true;
        scene.light_count = 2;
        scene.lights[0] = (leafcast_light){.vector = {1, 2, 3}, .rgb = {1, 1, 1}};
        scene.lights[1] = (leafcast_light){.point = true, .vector = {0, 0, 2}, .rgb = {0.5, 0, 0}};
        scene.occlusion = 0.5;
    }
    if (look == CLEAR) {
        surface.opacity = 0.4f;
        scene.clip_plane_count = 1;
        scene.clip_planes[0][0] = 1;
        scene.clip_planes[0][3] = 0.3;
        c.ortho_height = 6.0;
    }
    if (look == TWICE) {
        shown[1] = shown[0];
        shown[1].place = aside;
        shown[0].colours = shown[1].colours = &map;
    }
    pictures_draw(v, &scene, &c, to, &stats);
}

static void same_pictures(leafcast *moved, leafcast *fresh, uint32_t of) {
    static picture is, want;
    for (int look = 0; look < LOOKS; look++) {
        draw(moved, look, of, &is);
        draw(fresh, look, of, &want);
        same_pixels(&is, &want);
    }
}

/* ---- Motions of hostile surfaces, against brute force ---- */

typedef void motion(const float from[3], double phase, field_random *r, float to[3]);

static void rigid(const float p[3], double phase, field_random *r, float to[3]) {
    const double c = cos(phase), s = sin(phase);
    (void)r;
    to[0] = (float)(c * (double)p[0] - s * (double)p[1] + 3.0);
    to[1] = (float)(s * (double)p[0] + c * (double)p[1] - 7.0);
    to[2] = p[2] + 0.125f;
}

static void bent(const float p[3], double phase, field_random *r, float to[3]) {
    const double turn = phase * (double)p[2];
    (void)r;
    to[0] = (float)(cos(turn) * (double)p[0] - sin(turn) * (double)p[1]);
    to[1] = (float)(sin(turn) * (double)p[0] + cos(turn) * (double)p[1]);
    to[2] = (float)((double)p[2] + 0.2 * sin(3.0 * (double)p[0]));
}

static void noisy(const float p[3], double phase, field_random *r, float to[3]) {
    for (int a = 0; a < 3; a++)
        to[a] = (float)((double)p[a] + phase * field_random_in(r, -0.2, 0.2));
}

static void scattered(const float p[3], double phase, field_random *r, float to[3]) {
    (void)p;
    for (int a = 0; a < 3; a++)
        to[a] = (float)field_random_in(r, -1.0 - phase, 1.0 + phase);
}

static void flattened(const float p[3], double phase, field_random *r, float to[3]) {
    (void)phase, (void)r;
    to[0] = p[0];
    to[1] = p[1];
    to[2] = 0.5f;
}

static void in_one_place(const float p[3], double phase, field_random *r, float to[3]) {
    (void)p, (void)phase, (void)r;
    for (int a = 0; a < 3; a++)
        to[a] = 1.0f;
}

static void back(const float p[3], double phase, field_random *r, float to[3]) {
    (void)phase, (void)r;
    memcpy(to, p, sizeof(float[3]));
}

static motion *const motions[] = {rigid, bent, noisy,        scattered, flattened,
                                  noisy, back, in_one_place, back};
enum { MOTIONS = sizeof motions / sizeof *motions, RAYS = SLOW ? 20 : 150 };

static triangle_lab lab;

static void aim(leafcast_ray rays[], field_random *r) {
    for (int i = 0; i < RAYS; i++) {
        double o[3], d[3];
        rays[i] = (leafcast_ray){.t1 = (double)INFINITY};
        for (int a = 0; a < 3; a++) {
            o[a] = field_random_in(r, -2.0, 2.0);
            d[a] = 1.0 - o[a]; /* towards the one place */
        }
        if (lab.size > 0.0)
            triangle_lab_ray(&lab, r, o, d);
        memcpy(rays[i].origin, o, sizeof o);
        memcpy(rays[i].direction, d, sizeof d);
    }
}

static void same_probes(leafcast *moved, leafcast *fresh, const leafcast_ray *ray) {
    const leafcast_scene scene = leafcast_scene_default();
    leafcast_hit hits[2][24];
    int count[2];
    for (int i = 0; i < 2; i++)
        fine(leafcast_probe_ray(i ? fresh : moved, &scene, ray->origin, ray->direction, hits[i], 24,
                                &count[i]));
    assert_int_equal(count[0], count[1]);
    for (int i = 0; i < count[0]; i++)
        assert_true(hits[0][i].t == hits[1][i].t && hits[0][i].cell == hits[1][i].cell &&
                    hits[0][i].entering == hits[1][i].entering);
}

/* The same as a volume of these positions, and as a file; and right. */
static void judge(leafcast *moved, triangle_tally *tally, field_random *r) {
    static leafcast_ray rays[RAYS];
    static leafcast_ray_hit hits[3][RAYS];
    static uint8_t occluded[RAYS];
    const leafcast_triangles now = {.size = sizeof now,
                                    .vertex_count = lab.points,
                                    .triangle_count = lab.triangles,
                                    .vertices = (const float(*)[3])lab.xyz,
                                    .triangles = (const uint32_t(*)[3])lab.corner,
                                    .values = lab.value};
    const leafcast_scene scene = leafcast_scene_default();
    mesh_result result;
    leafcast *of[3] = {moved};
    fine(leafcast_open_triangles(&now, NULL, &of[1]));
    triangle_lab_convert(&lab, scratch_path("moved.leaf"), 64, "f", false, &result);
    of[2] = fixture_open(scratch_path("moved.leaf"), NULL);
    same_facts(of[0], of[1]);
    aim(rays, r);
    for (int i = 0; i < 3; i++) {
        select_one(of[i]);
        fine(leafcast_trace_rays(of[i], &scene, rays, RAYS, hits[i]));
    }
    fine(leafcast_occluded_rays(moved, &scene, rays, RAYS, occluded));
    for (int i = 0; i < RAYS; i++) {
        assert_true(same_hit(&hits[0][i], &hits[1][i]));
        assert_memory_equal(&hits[0][i].t, &hits[2][i].t, sizeof(double));
        assert_int_equal(hits[0][i].entering, hits[2][i].entering);
        assert_int_equal(occluded[i], !isinf(hits[0][i].t));
        if (lab.edge > 0.0 &&
            !triangle_truth_judge(&lab, rays[i].origin, rays[i].direction, hits[0][i].t, tally))
            print_error("%s: ray %d: %.17g\n", lab.name, i, hits[0][i].t);
        if (i % 8 == 0)
            same_probes(of[0], of[1], &rays[i]);
    }
    leafcast_close(of[1]);
    leafcast_close(of[2]);
}

static void test_motions(void **state) {
    static float start[3 * TRIANGLE_LAB_MAX][3];
    (void)state;
    for (int n = 0; n < triangle_lab_count(); n++) {
        field_random r = {FIELD_SEED + 31 * (uint64_t)n};
        triangle_tally tally = {0};
        leafcast *v;
        triangle_lab_make(&lab, n, FIELD_SEED);
        memcpy(start, lab.xyz, sizeof start);
        const leafcast_triangles from = {.size = sizeof from,
                                         .vertex_count = lab.points,
                                         .triangle_count = lab.triangles,
                                         .vertices = (const float(*)[3])lab.xyz,
                                         .triangles = (const uint32_t(*)[3])lab.corner,
                                         .values = lab.value};
        fine(leafcast_open_triangles(&from, NULL, &v));
        for (int k = 0; k < (SLOW ? 4 : MOTIONS); k++) {
            for (uint32_t p = 0; p < lab.points; p++)
                motions[k](start[p], 0.3 * (k + 1), &r, lab.xyz[p]);
            triangle_lab_measure(&lab);
            fine(leafcast_update_vertices(v, (const float(*)[3])lab.xyz, lab.points));
            judge(v, &tally, &r);
        }
        print_message("%s: %llu rays, %llu in doubt, %llu surfaces, worst %.1e\n", lab.name,
                      (unsigned long long)tally.rays, (unsigned long long)tally.doubtful,
                      (unsigned long long)tally.surfaces, tally.worst);
        assert_int_equal(tally.missed + tally.invented + tally.wrong, 0);
        assert_true(tally.surfaces > tally.rays / 8);
        leafcast_close(v);
    }
}

/* ---- Several treelets ---- */

static void test_pictures(void **state) {
    (void)state;
    tube t = tube_make(WATCHED ? 120 : 300);
    for (int how = 0; how < 3; how++) {
        const leafcast_options o = {
            .size = sizeof o, .threads = how == 1 ? 3 : 1, .isa = how == 2 ? "scalar" : NULL};
        t.of.smooth = how > 0;
        bend(&t, 0.0);
        leafcast *v = open_tube(&t, &o);
        assert_true(leafcast_describe(v).treelets > 1);
        for (int k = 1; k <= 3; k++) {
            const double phase = k == 3 ? 0.0 : 0.2 * k;
            bend(&t, phase);
            leafcast *fresh = open_tube(&t, NULL);
            for (uint32_t of = 0; of < 2; of++) {
                bend(&t, phase + 0.5);
                move(v, &t);
                fine(leafcast_select_set(v, of, 0));
                fine(leafcast_select_set(fresh, of, 0));
                /* The picture is the first call that comes to know of the positions. */
                bend(&t, phase);
                move(v, &t);
                same_pictures(v, fresh, of);
                same_facts(v, fresh);
            }
            leafcast_close(fresh);
        }
        leafcast_close(v);
    }
    tube_free(&t);
}

/* Two fields: values, then colours of the vertices' own. */
static void test_fields(void **state) {
    (void)state;
    tube t = tube_make(WATCHED ? 100 : 200);
    uint32_t number;
    leafcast *v = open_tube(&t, NULL);
    assert_int_equal(leafcast_describe(v).fields, 2);
    assert_string_equal(leafcast_field_name(v, 0), "heat");
    fine(leafcast_find_field(v, "rgb", &number));
    assert_int_equal(number, 1);
    leafcast_cell cell = {.size = sizeof cell};
    for (uint32_t of = 0; of < 2; of++) {
        fine(leafcast_select_set(v, of, 0));
        fine(leafcast_get_cell(v, 0, 4321, &cell));
        for (int k = 0; k < 3; k++) {
            const uint32_t id = t.rows[4321][k];
            assert_true(cell.value[k] == (of ? (float)(t.colours[id] & 0xffffff) : t.values[id]));
            for (int a = 0; a < 3; a++)
                assert_true(cell.position[k][a] == (double)t.xyz[id][a]);
        }
    }
    leafcast_close(v);
    /* Without any, there is one of zeros. */
    t.of.values = NULL;
    t.of.colours = NULL;
    v = open_tube(&t, NULL);
    assert_true(leafcast_describe(v).fields == 1 && leafcast_describe(v).value_max == 0.0);
    assert_string_equal(leafcast_field_name(v, 0), "");
    leafcast_close(v);
    /* A triangle without finite values is not there. */
    t.values[t.rows[17][0]] = NAN;
    t.of.values = t.values;
    v = open_tube(&t, NULL);
    leafcast_ray ray = {.t1 = (double)INFINITY};
    leafcast_ray_hit hit;
    const leafcast_scene scene = leafcast_scene_default();
    const float *p[3] = {t.xyz[t.rows[17][0]], t.xyz[t.rows[17][1]], t.xyz[t.rows[17][2]]};
    double e[2][3];
    for (int a = 0; a < 3; a++) {
        e[0][a] = (double)p[1][a] - (double)p[0][a];
        e[1][a] = (double)p[2][a] - (double)p[0][a];
    }
    for (int a = 0; a < 3; a++) {
        ray.direction[a] =
            e[0][(a + 1) % 3] * e[1][(a + 2) % 3] - e[0][(a + 2) % 3] * e[1][(a + 1) % 3];
        ray.origin[a] =
            ((double)p[0][a] + (double)p[1][a] + (double)p[2][a]) / 3.0 - ray.direction[a];
    }
    for (int k = 0; k < 2; k++) {
        fine(leafcast_trace_rays(v, &scene, &ray, 1, &hit));
        assert_int_equal(hit.cell == 17, k);
        leafcast_close(v);
        t.values[t.rows[17][0]] = 0.5f;
        v = k ? NULL : open_tube(&t, NULL);
    }
    tube_free(&t);
}

/* ---- Frames and threads ---- */

static void test_frames(void **state) {
    (void)state;
    static picture want[3], is;
    tube t = tube_make(WATCHED ? 100 : 200);
    leafcast *v = open_tube(&t, NULL);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera c = leafcast_standard_view(v, 1.6, PICTURE_WIDTH, PICTURE_HEIGHT);
    leafcast_stats stats = {.size = sizeof stats};
    leafcast_frame *frame;
    bool done = false;
    for (int k = 0; k < 3; k++) {
        bend(&t, 0.2 * k);
        move(v, &t);
        pictures_draw(v, &scene, &c, &want[k], &stats);
    }
    bend(&t, 0.0);
    move(v, &t);
    memset(&is, 0, sizeof is);
    const leafcast_image image = {.size = sizeof image, .z = is.z, .id = is.id};
    fine(leafcast_frame_begin(v, &scene, &c, &image, &frame));
    fine(leafcast_frame_advance(frame, 0.0, &done, NULL));
    bend(&t, 0.2);
    move(v, &t); /* the other positions */
    refused(leafcast_update_vertices(v, (const float(*)[3])t.xyz, t.of.vertex_count),
            LEAFCAST_USAGE, "end it first");
    static picture between;
    pictures_draw(v, &scene, &c, &between, &stats);
    same_pixels(&between, &want[1]);
    while (!done)
        fine(leafcast_frame_advance(frame, 0.0, &done, NULL));
    assert_memory_equal(is.z, want[0].z, sizeof is.z);
    leafcast_frame_end(frame);
    bend(&t, 0.4);
    move(v, &t);
    pictures_draw(v, &scene, &c, &between, &stats);
    same_pixels(&between, &want[2]);
    leafcast_close(v);
    tube_free(&t);
}

static void *move_once(void *ctx) {
    tube *t = ctx;
    fine(leafcast_update_vertices(t->shown, (const float(*)[3])t->xyz, t->of.vertex_count));
    return NULL;
}

/* A writer that waits for another thread's frame does not keep that thread from hearing of it. */
static void test_writers(void **state) {
    (void)state;
    static double z[PICTURE_PIXELS];
    tube t = tube_make(40);
    leafcast *v = t.shown = open_tube(&t, NULL);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera c = leafcast_standard_view(v, 1.6, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_image image = {.size = sizeof image, .z = z};
    leafcast_frame *frame;
    pthread_t other;
    fine(leafcast_frame_begin(v, &scene, &c, &image, &frame));
    move(v, &t);
    assert_int_equal(pthread_create(&other, NULL, move_once, &t), 0);
    (void)usleep(50000); /* so that it waits; the same is true if it does not */
    refused(leafcast_update_vertices(v, (const float(*)[3])t.xyz, t.of.vertex_count),
            LEAFCAST_USAGE, "end it first");
    leafcast_frame_end(frame);
    pthread_join(other, NULL);
    move(v, &t);
    leafcast_close(v);
    tube_free(&t);
}

/* Treelets are on the map where they are now: mirrored, where they were seen from the other end. */
static void test_map(void **state) {
    enum { BLOCKS = 5 };
    static const uint32_t blocks[3] = {1, 1, BLOCKS};
    leafcast_block map[2][BLOCKS];
    (void)state;
    tube t = tube_make(WATCHED ? 500 : 1000);
    leafcast *v = open_tube(&t, NULL);
    bool even = true;
    for (int k = 0; k < 2; k++) {
        for (uint32_t i = 0; i < t.of.vertex_count; i++)
            t.xyz[i][2] = k ? -t.xyz[i][2] : t.xyz[i][2] * t.xyz[i][2];
        move(v, &t);
        fine(leafcast_map_treelets(v, 0, blocks, map[k]));
    }
    for (int i = 0; i < BLOCKS; i++) {
        assert_int_equal(map[0][i].treelets, map[1][BLOCKS - 1 - i].treelets);
        even = even && map[0][i].treelets == map[0][BLOCKS - 1 - i].treelets;
    }
    assert_false(even);
    leafcast_close(v);
    tube_free(&t);
}

enum { PHASES = 4, SURFACES = 2, ROUNDS = WATCHED ? 6 : 40 };

typedef struct stage {
    tube t;
    leafcast *v;
    float (*xyz[PHASES])[3];
    double z[PHASES][PICTURE_PIXELS];
    atomic_bool *over;
    atomic_int updates;
} stage;

static void *keep_moving(void *ctx) {
    stage *s = ctx;
    for (int k = 0; !atomic_load(s->over) || k < PHASES; k++) {
        if (leafcast_update_vertices(s->v, (const float(*)[3])s->xyz[k % PHASES],
                                     s->t.of.vertex_count) != LEAFCAST_OK)
            break;
        (void)leafcast_describe(s->v);
        atomic_fetch_add(&s->updates, 1);
    }
    return NULL;
}

static void depths(leafcast *v, const leafcast_camera *c, double z[]) {
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof image, .z = z};
    fine(leafcast_trace(v, &scene, c, &image, NULL, NULL, NULL));
}

/* Each picture has the positions of one update. */
static void test_threads(void **state) {
    (void)state;
    static stage stages[SURFACES];
    pthread_t movers[SURFACES];
    atomic_bool over = false;
    leafcast_device *d;
    const leafcast_options on = {.size = sizeof on, .threads = 2};
    fine(leafcast_device_create(&on, &d));
    leafcast_options o = {.size = sizeof o, .device = d};
    leafcast_camera c[SURFACES];
    for (int i = 0; i < SURFACES; i++) {
        stage *s = &stages[i];
        *s = (stage){.t = tube_make(100 + 20 * (uint32_t)i), .over = &over};
        const size_t bytes = s->t.of.vertex_count * sizeof *s->xyz[0];
        s->v = open_tube(&s->t, &o);
        c[i] = leafcast_standard_view(s->v, 1.6, PICTURE_WIDTH, PICTURE_HEIGHT);
        for (int k = 0; k < PHASES; k++) {
            bend(&s->t, 0.1 * k);
            s->xyz[k] = malloc(bytes);
            memcpy(s->xyz[k], s->t.xyz, bytes);
            move(s->v, &s->t);
            depths(s->v, &c[i], s->z[k]);
        }
    }
    for (int i = 0; i < SURFACES; i++)
        assert_int_equal(pthread_create(&movers[i], NULL, keep_moving, &stages[i]), 0);
    for (int n = 0; n < ROUNDS; n++) {
        static double z[PICTURE_PIXELS];
        const stage *s = &stages[n % SURFACES];
        bool known = false;
        depths(s->v, &c[n % SURFACES], z);
        for (int k = 0; k < PHASES; k++)
            known |= memcmp(z, s->z[k], sizeof z) == 0;
        assert_true(known);
    }
    atomic_store(&over, true);
    for (int i = 0; i < SURFACES; i++) {
        pthread_join(movers[i], NULL);
        assert_true(atomic_load(&stages[i].updates) >= PHASES);
        leafcast_close(stages[i].v);
        for (int k = 0; k < PHASES; k++)
            free(stages[i].xyz[k]);
        tube_free(&stages[i].t);
    }
    leafcast_device_destroy(d);
}

/* ---- Errors and memory ---- */

static void test_errors(void **state) {
    (void)state;
    tube t = tube_make(100);
    leafcast *v = open_tube(&t, NULL), *none = NULL;
    const float kept = t.xyz[1234][1];
    const leafcast_info before = leafcast_describe(v);
    t.xyz[1234][1] = NAN;
    t.xyz[1300][2] = INFINITY;
    refused(leafcast_update_vertices(v, (const float(*)[3])t.xyz, t.of.vertex_count),
            LEAFCAST_USAGE, "vertex 1234 is at ");
    refused(leafcast_open_triangles(&t.of, NULL, &none), LEAFCAST_USAGE, "vertex 1234 is at ");
    assert_null(none);
    const leafcast_info after = leafcast_describe(v);
    assert_memory_equal(before.bounds, after.bounds, sizeof after.bounds);
    t.xyz[1234][1] = kept;
    t.xyz[1300][2] = 0.0f;
    refused(leafcast_update_vertices(v, (const float(*)[3])t.xyz, t.of.vertex_count - 1),
            LEAFCAST_USAGE, "the surface has 2400 vertices");
    t.rows[77][2] = t.of.vertex_count;
    refused(leafcast_open_triangles(&t.of, NULL, &none), LEAFCAST_USAGE,
            "triangles[77][2] is 2400: vertices are 0 to 2399");
    t.rows[77][2] = 0;
    t.of.field = "rgb";
    refused(leafcast_open_triangles(&t.of, NULL, &none), LEAFCAST_USAGE, "the name of colours");
    t.of.field = NULL;
    /* Neither kind of volume in memory is the other. */
    refused(leafcast_commit(v, 0.0), LEAFCAST_USAGE, "leafcast_open_live");
    const leafcast_grid some = {.size = sizeof some, .dims = {4, 4, 4}, .type = LEAFCAST_U8};
    fine(leafcast_open_live(&some, NULL, &none));
    refused(leafcast_update_vertices(none, (const float(*)[3])t.xyz, t.of.vertex_count),
            LEAFCAST_USAGE, "leafcast_open_triangles");
    leafcast_close(none);
    /* All in less than the least extent of a surface. */
    for (uint32_t i = 0; i < t.of.vertex_count; i++)
        t.xyz[i][0] = t.xyz[i][1] = t.xyz[i][2] = i ? 1e-40f : 0.0f;
    refused(leafcast_update_vertices(v, (const float(*)[3])t.xyz, t.of.vertex_count),
            LEAFCAST_USAGE, "its points lie within");
    bend(&t, 0.1);
    move(v, &t);
    leafcast_close(v);
    tube_free(&t);
}

/* What the text says would do does, and no budget gives other bits. */
static void test_memory(void **state) {
    (void)state;
    static picture want, is;
    tube t = tube_make(400);
    leafcast *v = open_tube(&t, NULL);
    leafcast_options o = {.size = sizeof o, .threads = 2, .memory = 600 << 10};
    leafcast *small = NULL;
    draw(v, LIT, 1, &want);
    refused(leafcast_open_triangles(&t.of, &o, &small), LEAFCAST_NOMEM, "bytes would do");
    const char *told = strstr(leafcast_error_text(), "vertices: ");
    assert_non_null(told);
    o.memory = strtoull(told + strlen("vertices: "), NULL, 10);
    assert_true(o.memory > 600 << 10 && o.memory < 400 * t.of.triangle_count + (2 << 20));
    fine(leafcast_open_triangles(&t.of, &o, &small));
    leafcast_close(small);
    o.memory += 8 << 20;
    small = open_tube(&t, &o);
    for (int k = 0; k < 2; k++) {
        bend(&t, k ? 0.0 : 0.3);
        move(small, &t);
        draw(small, LIT, 1, &is);
    }
    same_pixels(&is, &want);
    leafcast_close(small);
    leafcast_close(v);
    tube_free(&t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_motions), cmocka_unit_test(test_pictures),
        cmocka_unit_test(test_fields),  cmocka_unit_test(test_frames),
        cmocka_unit_test(test_writers), cmocka_unit_test(test_map),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_errors),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
