/* test_mesh_scene.c - pictures of meshes with many isosurfaces, clipping, depth peeling, shadows:
 * what the reference says, and from tiles the bits of single rays. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"
#include "tests/support/tet_judge.h"

#ifdef __SANITIZE_ADDRESS__
enum { CUBES = 5, STEP = 31 };
#else
enum { CUBES = 8, STEP = 7 };
#endif

static const char *const MESHES[] = {"sphere", "noise"};

/* A mesh, its file opened with all kernels, and the reference. */
typedef struct stage {
    lab_mesh lab;
    picture_volumes v;
    tet_ref_mesh mesh;
    tet_ref *reference;
} stage;

static void set_stage(stage *s, const char *name) {
    assert_true(lab_mesh_make(&s->lab, name, CUBES, 7));
    s->v = pictures_open(lab_leaf_make(&s->lab, 200, false), 2);
    s->mesh = lab_mesh_reference(&s->lab);
    s->reference = tet_ref_create(&s->mesh);
    assert_non_null(s->reference);
}

static void clear_stage(stage *s) {
    tet_ref_destroy(s->reference);
    pictures_close(&s->v);
    lab_mesh_release(&s->lab);
}

static ref_ray pixel_ray_of(const leafcast_camera *c, int i) {
    ref_ray r;
    leafcast_pixel_ray(c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, r.o, r.d);
    return r;
}

/* ---- Many surfaces, clipped and peeled ---- */

enum { ISOS = 5, PEELED = 16 };

/* By turns: nothing, a box, two planes, both. */
static void clip_scene(leafcast_scene *scene, const lab_mesh *lab, int kind) {
    for (int a = 0; a < 3; a++) {
        const double size = lab->hi[a] - lab->lo[a];
        scene->clip_min[a] = lab->lo[a] + 0.21 * size;
        scene->clip_max[a] = lab->hi[a] - (a == 2 ? -1.0 : 0.13 * size);
    }
    const double middle[3] = {0.5 * (lab->lo[0] + lab->hi[0]), 0.5 * (lab->lo[1] + lab->hi[1]),
                              0.5 * (lab->lo[2] + lab->hi[2])};
    const double planes[2][4] = {{1, 0.3, -0.2, -middle[0] - 0.3 * middle[1] + 0.2 * middle[2]},
                                 {-0.5, -0.7, 1, 0.5 * middle[0] + 0.7 * middle[1] - middle[2]}};
    scene->clip_box = kind & 1;
    scene->clip_plane_count = kind & 2;
    memcpy(scene->clip_planes, planes, sizeof planes);
}

/* What the first `layers` surfaces (0: all) make of a pixel. */
static void composite(const ref_hit *hits, size_t count, size_t layers,
                      const leafcast_surface *surfaces, double rgba[4]) {
    memset(rgba, 0, 4 * sizeof *rgba);
    for (size_t i = 0; i < count && (layers == 0 || i < layers); i++) {
        const leafcast_surface *s = &surfaces[hits[i].iso];
        const double weight = (1 - rgba[3]) * (double)s->opacity;
        for (int c = 0; c < 3; c++)
            rgba[c] += weight * (double)s->rgb[c];
        rgba[3] += weight;
    }
}

typedef struct peel_tally {
    int judged, grazing, deep, many; /* pixels; of four surfaces or more; of four isovalues */
} peel_tally;

static int different_isos(const ref_hit *hits, size_t count) {
    unsigned seen = 0;
    for (size_t i = 0; i < count; i++)
        seen |= 1u << hits[i].iso;
    return __builtin_popcount(seen);
}

static void judge_peeled(const stage *s, const leafcast_scene *scene, const leafcast_camera *c,
                         const leafcast_surface *surfaces, peel_tally *tally) {
    static picture p;
    leafcast_stats stats = {.size = sizeof stats};
    double isos[ISOS];
    const double box[2][3] = {{scene->clip_min[0], scene->clip_min[1], scene->clip_min[2]},
                              {scene->clip_max[0], scene->clip_max[1], scene->clip_max[2]}};
    const ref_clip clip = {.t1 = INFINITY,
                           .planes = scene->clip_planes,
                           .plane_count = scene->clip_plane_count,
                           .box = scene->clip_box ? box : NULL};
    for (int k = 0; k < ISOS; k++)
        isos[k] = surfaces[k].isovalue;
    pictures_draw(s->v.of[s->v.count - 1], scene, c, &p, &stats);
    for (int i = 0; i < PICTURE_PIXELS; i += STEP) {
        const ref_ray look = pixel_ray_of(c, i);
        ref_hit hits[PEELED];
        double want[4], worst = 0;
        size_t count = tet_ref_trace(s->reference, &look, isos, ISOS, &clip, hits, PEELED);
        count = count < PEELED ? count : PEELED;
        composite(hits, count, (size_t)scene->layers_max, surfaces, want);
        for (int k = 0; k < 4; k++)
            worst = fmax(worst, fabs(want[k] - (double)p.rgba[k][i]));
        tally->deep += count >= 4;
        tally->many += different_isos(hits, count) >= 4;
        tally->judged++;
        if (worst < 1e-3)
            continue;
        if (!tet_judge_grazing(s->reference, &look, isos, ISOS, &clip, PEELED))
            fail_msg("%s, pixel %d, %d layers: off by %g", s->lab.name, i, scene->layers_max,
                     worst);
        tally->grazing++;
    }
}

static void test_peeling(void **state) {
    (void)state;
    peel_tally tally = {0};
    field_random r = {3};
    for (size_t i = 0; i < sizeof MESHES / sizeof *MESHES; i++) {
        stage s;
        leafcast_surface surfaces[ISOS];
        set_stage(&s, MESHES[i]);
        for (int k = 0; k < ISOS; k++) {
            surfaces[k] = leafcast_surface_default(s.lab.iso + 0.07 * (k - 2));
            surfaces[k].opacity = k == 4 ? 1.0f : 0.3f + 0.05f * (float)k;
            for (int c = 0; c < 3; c++)
                surfaces[k].rgb[c] = k % 3 == c ? 1.0f : 0.1f * (float)k;
        }
        pictures_select(&s.v, surfaces, ISOS);
        for (int kind = 0; kind < 10; kind++) {
            leafcast_scene scene = leafcast_scene_default();
            scene.shading = LEAFCAST_SHADING_FLAT;
            scene.layers_max = (kind + 1) % 5;
            clip_scene(&scene, &s.lab, kind % 4);
            const leafcast_camera c = pictures_view(s.v.of[0], kind % PICTURE_VIEWS, &r);
            (void)pictures_alike(&s.v, &scene, &c, MESHES[i]);
            judge_peeled(&s, &scene, &c, surfaces, &tally);
        }
        clear_stage(&s);
    }
    print_message("%d pixels, %d in the grazing band; %d with 4 surfaces, %d with 4 isovalues\n",
                  tally.judged, tally.grazing, tally.deep, tally.many);
    assert_true(tally.grazing * 50 < tally.judged);
    assert_true(tally.deep > tally.judged / 20 && tally.many > tally.judged / 50);
}

/* ---- Shadows ---- */

#define NEAR 1e-4 /* of an edge: this near a surface, what lies in a shadow is not judged */

typedef struct shadow_counts {
    int lit, shaded, away, unclear;
} shadow_counts;

/* The way to a light, of unit direction; returns how far it is. */
static double way_to(const leafcast_light *light, const double at[3], double to[3]) {
    double length = 0;
    for (int a = 0; a < 3; a++) {
        to[a] = light->point ? light->vector[a] - at[a] : light->vector[a];
        length += to[a] * to[a];
    }
    for (int a = 0; a < 3; a++)
        to[a] /= sqrt(length);
    return light->point ? sqrt(length) : INFINITY;
}

/* Of the light's way from a point on a surface: 0 free, 1 not, -1: cannot be told. */
static int in_shadow(const stage *s, const double at[3], const double to[3], double distance,
                     double edge) {
    ref_ray way;
    ref_hit hits[3];
    for (int a = 0; a < 3; a++) {
        way.d[a] = to[a];
        way.o[a] = at[a] - NEAR * edge * to[a];
    }
    const ref_clip clip = {.t1 = distance};
    const size_t count = tet_ref_trace(s->reference, &way, &s->lab.iso, 1, &clip, hits, 3);
    if (count == 0 || hits[0].t > 2 * NEAR * edge || (count > 1 && hits[1].t < 3 * NEAR * edge) ||
        tet_judge_grazing(s->reference, &way, &s->lab.iso, 1, &clip, 2))
        return -1;
    return count > 1;
}

static void judge_light(const stage *s, const leafcast_scene *scene, const leafcast_camera *c,
                        shadow_counts *n) {
    static picture p;
    leafcast_stats stats = {.size = sizeof stats};
    const leafcast_light *light = &scene->lights[0];
    pictures_draw(s->v.of[s->v.count - 1], scene, c, &p, &stats);
    for (int i = 0; i < PICTURE_PIXELS; i += STEP) {
        const ref_ray look = pixel_ray_of(c, i);
        double at[3], to[3], n_l = 0, n_v = 0;
        if (!(p.z[i] < INFINITY))
            continue;
        for (int a = 0; a < 3; a++)
            at[a] = look.o[a] + p.z[i] * look.d[a];
        const double distance = way_to(light, at, to);
        for (int a = 0; a < 3; a++) {
            n_l += (double)p.normal[a][i] * to[a];
            n_v -= (double)p.normal[a][i] * look.d[a];
        }
        n_l = n_v < 0 ? -n_l : n_l;
        const double share =
            ((double)p.rgba[0][i] - (double)scene->ambient) / (1.0 - (double)scene->ambient);
        const int hidden =
            fabs(n_l) < 0.02 || fabs(n_v) < 1e-3 ? -1
            : n_l < 0                            ? 1
                      : in_shadow(s, at, to, distance, (s->lab.hi[0] - s->lab.lo[0]) / CUBES);
        n->unclear += hidden < 0;
        if (hidden < 0)
            continue;
        n->away += n_l < 0;
        n->shaded += n_l > 0 && hidden;
        n->lit += !hidden;
        if (fabs(share - (hidden ? 0.0 : n_l)) > 1e-5)
            fail_msg("%s, pixel %d: %g of the light, not %g", s->lab.name, i, share,
                     hidden ? 0.0 : n_l);
    }
}

static void test_shadows(void **state) {
    (void)state;
    field_random r = {9};
    for (int point = 0; point < 2; point++) {
        shadow_counts n = {0};
        for (size_t i = 0; i < sizeof MESHES / sizeof *MESHES; i++) {
            stage s;
            set_stage(&s, MESHES[i]);
            leafcast_surface surface = leafcast_surface_default(s.lab.iso);
            for (int c = 0; c < 3; c++)
                surface.rgb[c] = 1.0f;
            pictures_select(&s.v, &surface, 1);
            for (int kind = 0; kind < PICTURE_VIEWS; kind++) {
                leafcast_scene scene = leafcast_scene_default();
                scene.light_count = 1;
                scene.shadows = true;
                scene.lights[0] = (leafcast_light){.point = point, .rgb = {1, 1, 1}};
                for (int a = 0; a < 3; a++) {
                    const double middle = 0.5 * (s.lab.lo[a] + s.lab.hi[a]);
                    const double off = ((double)(field_random_bits(&r) % 2001) - 1000) / 1000;
                    scene.lights[0].vector[a] =
                        point ? middle + (kind % 2 ? 0.45 : 2) * off * (s.lab.hi[a] - s.lab.lo[a])
                              : off + 0.001;
                }
                const leafcast_camera c = pictures_view(s.v.of[0], kind, &r);
                (void)pictures_alike(&s.v, &scene, &c, MESHES[i]);
                judge_light(&s, &scene, &c, &n);
            }
            clear_stage(&s);
        }
        print_message("%s light: %d lit, %d in shadows, %d turned away, %d unclear\n",
                      point ? "point" : "directional", n.lit, n.shaded, n.away, n.unclear);
        assert_true(n.lit > 1000 / STEP && n.shaded > 500 / STEP && n.away > 1000 / STEP);
        assert_true(n.unclear < (n.lit + n.shaded + n.away) / 4);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_peeling),
        cmocka_unit_test(test_shadows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
