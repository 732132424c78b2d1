/* test_places.c - objects with places: each ray, taken by hand to each volume's own world and
 * traced there alone, and the results merged by t. Instances are the same data converted where they
 * are; thousands of them are few questions a ray; the same bits for any budget and any order of the
 * search. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/ray/affine.h"
#include "tests/support/fixture.h"
#include "tests/support/scene_stage.h"

enum { HITS = 64, OBJECTS = 5, STEP = WATCHED ? 31 : 7 };

/* Turned, sheared, scaled unevenly, mirrored, far away. The volumes fill 0 .. 35. */
static const double PLACES[OBJECTS][12] = {
    {0.8, -0.5, 0.1, 6, 0.4, 0.7, -0.3, -5, 0.1, 0.3, 0.9, 2},
    {-0.6, 0, 0.2, 30, 0.1, 0.5, 0, 8, 0, -0.2, 0.7, 1},
    {0.3, 0.2, 0, -4, -0.2, 0.4, 0.1, 22, 0, 0, 1.4, -9},
    {0, -0.5, 0, 40, 0, 0, 0.5, 10, 0.5, 0, 0, 12},
    {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};

static const leafcast_surface LONE = {0.8, {0.7f, 0.7f, 0.1f}, 0.5f, 0, 0};

/* The grid and the mesh in turn, the grid once with another surface; the last one has no place. */
typedef struct crowd {
    scene_pair pair;
    leafcast_shown shown[OBJECTS + 8];
    leafcast_scene scene;
} crowd;

static void crowd_open(crowd *c, const scene_stage *s, const leafcast_options *o,
                       uint32_t treelets) {
    scene_stage_open(&c->pair, s, o, treelets);
    for (int i = 0; i < OBJECTS; i++) {
        c->shown[i] = c->pair.shown[i % 2];
        c->shown[i].place = i + 1 < OBJECTS ? PLACES[i] : NULL;
    }
    c->shown[2].surfaces = &LONE;
    c->shown[2].count = 1;
    c->scene = c->pair.scene;
    c->scene.analytic_normals = true;
    c->scene.volumes = c->shown;
    c->scene.volume_count = OBJECTS;
}

/* ---- By hand ---- */

typedef struct met {
    leafcast_hit hit; /* of the volume's own world */
    int object;
    double normal[3]; /* towards lower values, in the scene's world */
} met;

static int order(const void *a, const void *b) {
    const met *x = a, *y = b;
    if (x->hit.t != y->hit.t)
        return x->hit.t < y->hit.t ? -1 : 1;
    return x->object - y->object;
}

/* All hits of a ray of the scene with some objects, in order. */
static int trace_by_hand(const crowd *c, int objects, const double o[3], const double d[3],
                         met all[]) {
    int count = 0;
    for (int i = 0; i < objects; i++) {
        leafcast_hit hits[HITS];
        leafcast_shown alone = c->shown[i];
        leafcast_scene scene = c->scene;
        affine space;
        double own_o[3], own_d[3];
        int found;
        alone.place = NULL;
        scene.volumes = &alone;
        scene.volume_count = 1;
        affine_init(&space, PLACES[i]);
        affine_point_to_grid(&space, o, own_o);
        affine_vector_to_grid(&space, d, own_d);
        assert_int_equal(leafcast_probe_ray(alone.volume, &scene, own_o, own_d, hits, HITS, &found),
                         LEAFCAST_OK);
        assert_true(found < HITS);
        for (int k = 0; k < found; k++) {
            met *m = &all[count++];
            double length = 0;
            m->hit = hits[k];
            m->object = i;
            /* The inverse transpose, from two tangents taken to the scene. */
            const double *n = hits[k].normal;
            const int a = fabs(n[0]) < 0.6 ? 0 : 1;
            const double u[3] = {a == 0 ? 0 : -n[2], a == 0 ? n[2] : 0, a == 0 ? -n[1] : n[0]};
            const double v[3] = {n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2],
                                 n[0] * u[1] - n[1] * u[0]};
            double to[3][3];
            for (int r = 0; r < 3; r++) {
                const double *row = PLACES[i] + 4 * r;
                to[0][r] = row[0] * u[0] + row[1] * u[1] + row[2] * u[2];
                to[1][r] = row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
                to[2][r] = row[0] * n[0] + row[1] * n[1] + row[2] * n[2];
            }
            double along = 0;
            for (int r = 0; r < 3; r++) {
                const int p = (r + 1) % 3, q = (r + 2) % 3;
                m->normal[r] = to[0][p] * to[1][q] - to[0][q] * to[1][p];
                length += m->normal[r] * m->normal[r];
                along += m->normal[r] * to[2][r];
            }
            for (int r = 0; r < 3; r++)
                m->normal[r] /= along < 0 ? -sqrt(length) : sqrt(length);
        }
    }
    qsort(all, (size_t)count, sizeof *all, order);
    return count;
}

static const leafcast_surface *surface_of(const crowd *c, const met *m) {
    return &c->shown[m->object].surfaces[m->hit.surface];
}

static int id_of(const crowd *c, const met *m) {
    int id = m->hit.surface;
    for (int i = 0; i < m->object; i++)
        id += c->shown[i].count;
    return id;
}

/* How much of a light arrives at a hit; NaN: it begins or ends too near to some surface. */
static double arriving(const crowd *c, int objects, const double at[3], const double to[3],
                       double distance, int object) {
    met all[OBJECTS * HITS];
    const int count = trace_by_hand(c, objects, at, to, all);
    double left = 1;
    for (int i = 0; i < count && all[i].hit.t < distance; i++) {
        const double t = all[i].hit.t;
        if (t < 1e-9 && all[i].object == object)
            continue; /* the surface itself */
        if (t < 1e-3 || distance - t < 1e-3)
            return NAN;
        left *= 1 - (double)surface_of(c, &all[i])->opacity;
    }
    return left;
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* M08 eq. 4.6 at a hit, lit from all lights. Returns false for what is too near to call. */
static bool shade_by_hand(const crowd *c, int objects, const double o[3], const double d[3],
                          const met *m, double rgb[3]) {
    const leafcast_scene *s = &c->scene;
    const double turn = dot(m->normal, d) > 0 ? -1 : 1;
    for (int k = 0; k < 3; k++)
        rgb[k] = (double)s->ambient * (double)surface_of(c, m)->rgb[k];
    for (int l = 0; l < s->light_count; l++) {
        double at[3], to[3], far = 0;
        for (int a = 0; a < 3; a++) {
            at[a] = o[a] + m->hit.t * d[a];
            to[a] = s->lights[l].vector[a] - (s->lights[l].point ? at[a] : 0);
            far += to[a] * to[a];
        }
        far = sqrt(far);
        for (int a = 0; a < 3; a++)
            to[a] /= far;
        const double n_l = turn * dot(m->normal, to);
        if (fabs(n_l) < 1e-3 || fabs(dot(m->normal, d)) < 1e-3)
            return false;
        if (n_l < 0)
            continue;
        const double arrives =
            arriving(c, objects, at, to, s->lights[l].point ? far : INFINITY, m->object);
        if (isnan(arrives))
            return false;
        for (int k = 0; k < 3; k++)
            rgb[k] += arrives * (1 - (double)s->ambient) * n_l * (double)s->lights[l].rgb[k] *
                      (double)surface_of(c, m)->rgb[k];
    }
    return true;
}

static bool pixel_by_hand(const crowd *c, int objects, const double o[3], const double d[3],
                          const met all[], int count, double rgba[4]) {
    memset(rgba, 0, 4 * sizeof *rgba);
    for (int i = 0; i < count; i++) {
        double rgb[3];
        const double weight = (1 - rgba[3]) * (double)surface_of(c, &all[i])->opacity;
        if (weight < 1e-3)
            break;
        if (!shade_by_hand(c, objects, o, d, &all[i], rgb))
            return false;
        for (int k = 0; k < 3; k++)
            rgba[k] += weight * rgb[k];
        rgba[3] += weight;
    }
    return true;
}

/* With so many objects: of 3 each ray asks all, of 5 those in a tree of boxes. */
static void check_crowd(const scene_stage *s, int objects) {
    static picture p;
    const leafcast_camera view = scene_stage_view(56);
    crowd c;
    int judged = 0, lit = 0, mixed = 0, drawn = 0;
    crowd_open(&c, s, NULL, 0);
    const leafcast_scene lights = scene_stage_lit(&c.pair);
    c.scene.light_count = lights.light_count;
    memcpy(c.scene.lights, lights.lights, sizeof lights.lights);
    c.scene.shadows = true;
    c.scene.volume_count = objects;
    pictures_draw(c.pair.volume[0], &c.scene, &view, &p, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i += STEP) {
        double o[3], d[3], rgba[4];
        met all[OBJECTS * HITS];
        leafcast_pixel_ray(&view, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        const int count = trace_by_hand(&c, objects, o, d, all);
        judged++;
        assert_int_equal(p.id[i], count ? id_of(&c, &all[0]) : -1);
        assert_true(count ? p.z[i] == all[0].hit.t : isinf(p.z[i])); /* to the bit */
        for (int k = 1; k < count; k++)
            mixed += all[k].object != all[0].object;
        for (int a = 0; a < 3 && count; a++)
            assert_true(fabs((double)p.normal[a][i] - all[0].normal[a]) < 2e-6);
        if (!pixel_by_hand(&c, objects, o, d, all, count, rgba))
            continue;
        drawn++;
        lit += count > 0;
        for (int k = 0; k < 4; k++)
            if (fabs((double)p.rgba[k][i] - rgba[k]) > 4e-3)
                fail_msg("%d objects, pixel %d: channel %d is %g, by hand %g", objects, i, k,
                         (double)p.rgba[k][i], rgba[k]);
    }
    assert_true(mixed > judged / 10);
    assert_true(lit > judged / 20 && drawn > judged / 2);
    scene_stage_close(&c.pair);
}

static void each_ray_is_that_of_each_volume_alone(void **state) {
    check_crowd(*state, 3);
    check_crowd(*state, OBJECTS);
}

/* ---- The same bits ---- */

static void budgets_threads_and_trees_do_not_show(void **state) {
    static picture truth, other;
    const leafcast_camera view = scene_stage_view(56);
    crowd c;
    for (int kind = 0; kind < 5; kind++) {
        const leafcast_options o = {.size = sizeof o, .threads = kind % 2 ? 3 : 1};
        crowd_open(&c, *state, &o, kind < 3 ? 1 : 0);
        leafcast_scene scene = scene_stage_lit(&c.pair);
        scene.volumes = c.shown;
        scene.volume_count = 3;
        /* Objects out of sight turn the list into a tree, and change nothing. */
        static const double away[12] = {1, 0, 0, 1e5, 0, 1, 0, 1e5, 0, 0, 1, -3e5};
        for (int k = 3; k < 11 && kind >= 2; k++, scene.volume_count++) {
            c.shown[k] = c.pair.shown[k % 2];
            c.shown[k].place = away;
        }
        pictures_draw(c.pair.volume[0], &scene, &view, kind ? &other : &truth, NULL);
        if (kind)
            scene_stage_same(&truth, &other);
        scene_stage_close(&c.pair);
    }
}

/* ---- The same data, converted where the place takes it ---- */

static void an_instance_is_the_mesh_converted_there(void **state) {
    /* Floats stay floats. */
    static const double place[12] = {0, -2, 0, 64, 0, 0, 2, -16, 2, 0, 0, 8};
    static picture placed, moved;
    const scene_stage *s = *state;
    lab_mesh lab = s->lab;
    char path[512];
    float(*points)[3] = malloc(lab.point_count * sizeof *points);
    assert_non_null(points);
    for (size_t i = 0; i < lab.point_count; i++)
        for (int r = 0; r < 3; r++) {
            const double *m = place + 4 * r;
            points[i][r] = (float)m[3];
            for (int a = 0; a < 3; a++)
                points[i][r] += (float)m[a] * lab.points[i][a];
        }
    lab.points = points;
    lab.name = "moved";
    strcpy(path, lab_leaf_make(&lab, 200, false));
    leafcast_camera view = scene_stage_view(110);
    memcpy(view.look_at, (double[3]){29, 19, 43}, sizeof view.look_at);
    leafcast *v = fixture_open(path, NULL);
    leafcast_shown shown = {v, 0, 0, &scene_stage_mesh, 1, 0.0, NULL, NULL, NULL};
    scene_pair pair;
    scene_stage_open(&pair, s, NULL, 0);
    leafcast_scene scene = scene_stage_lit(&pair);
    scene.volumes = &shown;
    scene.volume_count = 1;
    pictures_draw(v, &scene, &view, &moved, NULL);
    shown.volume = pair.volume[1];
    shown.place = place;
    pictures_draw(pair.volume[1], &scene, &view, &placed, NULL);
    int covered = 0, other = 0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        covered += moved.id[i] == 0;
        const bool z = moved.id[i] == placed.id[i] &&
                       (moved.id[i] < 0 || fabs(moved.z[i] - placed.z[i]) < 1e-9 * moved.z[i]);
        bool colour = true;
        for (int k = 0; k < 4; k++)
            colour = colour && fabsf(moved.rgba[k][i] - placed.rgba[k][i]) < 1e-4f;
        other += !z || !colour;
    }
    assert_true(covered > PICTURE_PIXELS / 10);
    assert_true(other <= PICTURE_PIXELS / 1000); /* what grazes by less than rounding */
    scene_stage_close(&pair);
    leafcast_close(v);
    free(points);
}

/* ---- Thousands ---- */

static void thousands_are_few_questions_a_ray(void **state) {
    enum { SIDE = 16, COUNT = SIDE * SIDE * SIDE };
    static double places[COUNT][12];
    static leafcast_shown shown[COUNT];
    static leafcast_ray rays[COUNT];
    static leafcast_ray_hit hits[COUNT];
    static picture p;
    leafcast_stats stats = {.size = sizeof stats};
    (void)state;
    field f;
    assert_true(field_make(&f, "sphere", 12, FIELD_SEED));
    leafcast *v = fixture_open(fixture_leaf(&f, 5, 1, false), NULL);
    const leafcast_info info = leafcast_describe(v);
    const leafcast_surface surface = {f.iso, {1, 1, 1}, 1, 0, 0};
    const double unit = info.bounds[1][0] - info.bounds[0][0];
    const double step = exp2(ceil(log2(2 * unit)));
    for (int i = 0; i < COUNT; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int a = 0; a < 3; a++) {
            places[i][5 * a] = i % 3 ? 1 : 0.5; /* exact to invert */
            places[i][4 * a + 3] = at[a] * step;
        }
        shown[i] =
            (leafcast_shown){.volume = v, .surfaces = &surface, .count = 1, .place = places[i]};
    }
    leafcast_scene scene = leafcast_scene_default();
    scene.volumes = shown;
    scene.volume_count = COUNT;
    const double middle = SIDE * step / 2;
    leafcast_camera view = scene_stage_view(1);
    for (int a = 0; a < 3; a++) {
        view.look_at[a] = middle;
        view.eye[a] = middle + (a == 0 ? 1.3 : a == 1 ? 0.8 : 0.6) * SIDE * step;
    }
    pictures_draw(v, &scene, &view, &p, NULL);
    pictures_draw(v, &scene, &view, &p, &stats); /* no ray waits */
    int met_any = 0;
    for (int i = 0; i < PICTURE_PIXELS; i += 97) {
        double o[3], d[3];
        leafcast_shown alone = {v, 0, 0, &surface, 1, 0.0, NULL, NULL, NULL};
        leafcast_scene one = scene;
        one.volumes = &alone;
        one.volume_count = 1;
        leafcast_pixel_ray(&view, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o, d);
        for (int k = 0; k < COUNT; k++) {
            const double scale = places[k][0];
            for (int a = 0; a < 3; a++) {
                rays[k].origin[a] = (o[a] - places[k][4 * a + 3]) / scale;
                rays[k].direction[a] = d[a] / scale;
            }
            rays[k].t0 = 0;
            rays[k].t1 = INFINITY;
        }
        assert_int_equal(leafcast_trace_rays(v, &one, rays, COUNT, hits), LEAFCAST_OK);
        int first = 0;
        for (int k = 1; k < COUNT; k++)
            if (hits[k].t < hits[first].t)
                first = k;
        met_any += !isinf(hits[first].t);
        assert_true(p.z[i] == hits[first].t || (isinf(p.z[i]) && isinf(hits[first].t)));
        assert_int_equal(p.id[i], isinf(hits[first].t) ? -1 : first);
    }
    assert_true(met_any > PICTURE_PIXELS / 97 / 8);
    print_message("%d objects: %.2f questions a ray\n", COUNT,
                  (double)stats.objects / (double)stats.primary_rays);
    assert_true(stats.objects < 12 * stats.primary_rays);
    assert_true(stats.objects > 0 && stats.treelets_total == info.treelets);
    leafcast_close(v);
    field_release(&f);
}

/* Two objects have a surface at one t, to the bit: the one that is entered later is listed first,
 * and comes first. */
static void at_one_t_the_first_listed_comes_first(void **state) {
    const scene_stage *s = *state;
    static const double away[12] = {1, 0, 0, 500, 0, 1, 0, 0, 0, 0, 1, 0};
    double about[12] = {0.0625, 0, 0, 4.6875, 0, 1, 0, 0, 0, 0, 1, 0}; /* x = 5 stays */
    scene_pair pair;
    int row = 36;
    const float *x = NULL;
    bool first_there = false; /* the way to node 5 lies below it */
    while (!first_there && ++row < 34 * 36) {
        x = s->samples + (size_t)row * 36;
        first_there = x[5] < x[6];
        for (int i = 0; i < 5; i++)
            first_there = first_there && x[i] < x[5];
    }
    assert_true(first_there && row % 36 > 0);
    const leafcast_surface surface = {(double)x[5], {1, 1, 1}, 1, 0, 0};
    scene_stage_open(&pair, s, NULL, 0);
    leafcast_shown shown[5];
    leafcast_scene scene = leafcast_scene_default();
    scene.volumes = shown;
    for (int first = 0; first < 2; first++)
        for (int count = 2; count <= 5; count += 3) {
            leafcast_ray ray = {{-10, row % 36, row / 36}, {1, 0, 0}, 14.5, INFINITY};
            leafcast_ray_hit hit;
            for (int i = 0; i < count; i++)
                shown[i] = (leafcast_shown){pair.volume[0],
                                            0,
                                            0,
                                            &surface,
                                            1,
                                            0.0,
                                            i == first ? about : i == 1 - first ? NULL : away,
                                            NULL,
                                            NULL};
            scene.volume_count = count;
            assert_int_equal(leafcast_trace_rays(pair.volume[0], &scene, &ray, 1, &hit),
                             LEAFCAST_OK);
            assert_true(hit.t == 15);
            assert_int_equal(hit.volume, 0);
            assert_int_equal(hit.surface, 0);
        }
    scene_stage_close(&pair);
}

/* ---- Media, projections, clips ---- */

/* A picture of the grid at a place, and of the grid alone, by a camera that is placed the other way
 * about. place: turns by quarters, scales by a power of two. */
typedef struct pair_of {
    double rgba[4 * PICTURE_PIXELS], error[PICTURE_PIXELS], value[PICTURE_PIXELS],
        z[PICTURE_PIXELS];
} pair_of;

static const double QUARTER[12] = {0, 2, 0, 10, 0, 0, 2, -16, 2, 0, 0, 8};

static void to_scene(double p[3], bool point) {
    double q[3];
    for (int r = 0; r < 3; r++) {
        const double *m = QUARTER + 4 * r;
        q[r] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + (point ? m[3] : 0);
    }
    memcpy(p, q, sizeof q);
}

static void draw_grid(const scene_pair *pair, leafcast_scene scene, bool placed, pair_of *out) {
    leafcast_shown shown = pair->shown[0];
    leafcast_camera view = scene_stage_view(68);
    if (scene.media_count || scene.project)
        shown.count = 0;
    scene.volumes = &shown;
    scene.volume_count = 1;
    if (placed) {
        shown.place = QUARTER;
        to_scene(view.eye, true);
        to_scene(view.look_at, true);
        to_scene(view.up, false);
    }
    const leafcast_image image = {.size = sizeof image,
                                  .rgba = out->rgba,
                                  .error = out->error,
                                  .value = out->value,
                                  .z = out->z};
    assert_int_equal(leafcast_trace(shown.volume, &scene, &view, &image, NULL, NULL, NULL),
                     LEAFCAST_OK);
}

static void a_medium_is_as_thick_as_the_scene_says(void **state) {
    static pair_of own, placed, twice;
    const leafcast_transfer_point thin[2] = {{0.2, {1, 0.5, 0.1}, 0.0}, {1.6, {0.2, 0.6, 1}, 0.2}};
    leafcast_transfer_point half[2] = {thin[0], thin[1]}, lower[2] = {thin[0], thin[1]};
    half[1].extinction = 0.5 * thin[1].extinction; /* twice as long */
    scene_pair pair;
    scene_stage_open(&pair, *state, NULL, 0);
    for (int shaded = 0; shaded < 2; shaded++) {
        leafcast_scene scene = leafcast_scene_default();
        leafcast_medium medium = {thin, 2};
        scene.media = &medium;
        scene.media_count = 1;
        scene.shade_media = shaded;
        draw_grid(&pair, scene, false, &own);
        medium.points = half;
        draw_grid(&pair, scene, true, &placed);
        double most = 0, bright = 0;
        for (int i = 0; i < PICTURE_PIXELS; i++)
            for (int k = 0; k < 4; k++) {
                const double off = fabs(own.rgba[4 * i + k] - placed.rgba[4 * i + k]);
                most = fmax(most, off);
                bright = fmax(bright, own.rgba[4 * i + k]);
                assert_true(shaded ? off < 4e-3 : off <= own.error[i] + placed.error[i] + 1e-12);
            }
        assert_true(bright > 0.2);
        assert_true(shaded || most < 1e-6);
    }
    /* Two of half the extinction at one place are one. */
    leafcast_shown shown[2] = {pair.shown[0], pair.shown[0]};
    lower[1].extinction = 0.5 * half[1].extinction;
    const leafcast_medium media[2] = {{lower, 2}, {lower, 2}};
    leafcast_scene scene = leafcast_scene_default();
    leafcast_camera view = scene_stage_view(68);
    to_scene(view.eye, true);
    to_scene(view.look_at, true);
    to_scene(view.up, false);
    for (int i = 0; i < 2; i++) {
        shown[i].count = 0;
        shown[i].place = QUARTER;
    }
    scene.media = media;
    scene.media_count = scene.volume_count = 2;
    scene.volumes = shown;
    const leafcast_image image = {.size = sizeof image, .rgba = twice.rgba, .error = twice.error};
    assert_int_equal(leafcast_trace(pair.volume[0], &scene, &view, &image, NULL, NULL, NULL),
                     LEAFCAST_OK);
    leafcast_scene once = leafcast_scene_default();
    const leafcast_medium medium = {half, 2};
    once.media = &medium;
    once.media_count = 1;
    draw_grid(&pair, once, true, &placed);
    for (int i = 0; i < PICTURE_PIXELS; i++)
        for (int k = 0; k < 4; k++)
            assert_true(fabs(twice.rgba[4 * i + k] - placed.rgba[4 * i + k]) <=
                        twice.error[i] + placed.error[i] + 1e-12);
    scene_stage_close(&pair);
}

static void projections_and_clips_are_the_scenes(void **state) {
    static pair_of own, placed;
    scene_pair pair;
    scene_stage_open(&pair, *state, NULL, 0);
    for (int kind = 0; kind < 6; kind++) {
        leafcast_scene scene = leafcast_scene_default();
        scene.project = kind < 5 ? (leafcast_project)kind : LEAFCAST_PROJECT_NONE;
        scene.project_value = 1.2;
        scene.caps = kind == 5;
        scene.shading = LEAFCAST_SHADING_FLAT;
        /* x <= 20 of the grid is z <= 48 of the scene: rays enter through the clip. */
        scene.clip_plane_count = 1;
        memcpy(scene.clip_planes[0], (double[4]){-1, 0, 0, 20}, sizeof scene.clip_planes[0]);
        draw_grid(&pair, scene, false, &own);
        memcpy(scene.clip_planes[0], (double[4]){0, 0, -1, 48}, sizeof scene.clip_planes[0]);
        draw_grid(&pair, scene, true, &placed);
        int there = 0, other = 0;
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            const bool any = !isinf(own.z[i]) || !isnan(own.value[i]);
            there += any;
            bool same = isnan(own.value[i]) ? isnan(placed.value[i])
                                            : fabs(own.value[i] - placed.value[i]) < 1e-9;
            if (isinf(own.z[i]) || isinf(placed.z[i]))
                same = same && isinf(own.z[i]) == isinf(placed.z[i]);
            else
                same = same && fabs(2 * own.z[i] - placed.z[i]) < 1e-7;
            for (int k = 0; k < 4; k++)
                same = same && fabs(own.rgba[4 * i + k] - placed.rgba[4 * i + k]) < 1e-6;
            other += !same;
        }
        assert_true(there > PICTURE_PIXELS / 10);
        assert_true(other <= PICTURE_PIXELS / 400);
    }
    scene_stage_close(&pair);
}

/* ---- What is refused ---- */

static void check_refused(const scene_pair *pair, const double *place, const char *why) {
    leafcast_shown shown = pair->shown[0];
    leafcast_scene scene = pair->scene;
    double o[3] = {0}, d[3] = {1, 0, 0};
    leafcast_hit hits[2];
    int count;
    shown.place = place;
    scene.volumes = &shown;
    scene.volume_count = 1;
    assert_int_equal(leafcast_probe_ray(pair->volume[0], &scene, o, d, hits, 2, &count),
                     LEAFCAST_USAGE);
    if (!strstr(leafcast_error_text(), why))
        fail_msg("\"%s\" is not in \"%s\"", why, leafcast_error_text());
}

static void wrong_places_are_refused(void **state) {
    scene_pair pair;
    double flat[12] = {1, 2, 3, 0, 2, 4, 6.0000001, 0, 1, 0, 1, 0},
           line[12] = {1e-7, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, zero[12] = {0},
           huge[12] = {1e31, 0, 0, 0, 0, 1e31, 0, 0, 0, 0, 1e31, 0},
           nan[12] = {1, 0, 0, 0, 0, 1, 0, NAN, 0, 0, 1, 0};
    scene_stage_open(&pair, *state, NULL, 0);
    check_refused(&pair, flat, "flattens space");
    check_refused(&pair, line, "flattens space");
    check_refused(&pair, zero, "scale and turn is 0");
    check_refused(&pair, huge, "scale and turn is 1e+31");
    check_refused(&pair, nan, "leafcast_scene.volumes[0].place[7] is nan");
    leafcast_shown shown[2] = {pair.shown[0], pair.shown[0]};
    leafcast_scene scene = pair.scene;
    leafcast_hit hits[2];
    int count;
    scene.volumes = shown;
    shown[0].place = flat;
    flat[6] = -6;
    scene.lod = LEAFCAST_LOD_PIXEL;
    assert_int_equal(leafcast_probe_ray(pair.volume[0], &scene, (double[3]){0},
                                        (double[3]){1, 0, 0}, hits, 2, &count),
                     LEAFCAST_USAGE);
    assert_non_null(strstr(leafcast_error_text(), "levels by pixels"));
    scene_stage_close(&pair);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_ray_is_that_of_each_volume_alone),
        cmocka_unit_test(budgets_threads_and_trees_do_not_show),
        cmocka_unit_test(an_instance_is_the_mesh_converted_there),
        cmocka_unit_test(thousands_are_few_questions_a_ray),
        cmocka_unit_test(at_one_t_the_first_listed_comes_first),
        cmocka_unit_test(a_medium_is_as_thick_as_the_scene_says),
        cmocka_unit_test(projections_and_clips_are_the_scenes),
        cmocka_unit_test(wrong_places_are_refused),
    };
    return cmocka_run_group_tests(tests, scene_stage_set, scene_stage_clear);
}
