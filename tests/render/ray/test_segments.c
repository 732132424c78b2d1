/* test_segments.c - the pieces of rays through cells against the references: each cell once, ends
 * that adjoin, values; the same bits however little is resident. */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "render/door/leafcast_volume.h"
#include "render/mesh/mesh_walk.h"
#include "render/ray/kind.h"
#include "stream/grid_resident.h"
#include "tests/support/fixture.h"
#include "tests/support/interests.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/segment_truth.h"
#include "tests/support/watched.h"

enum { RAYS = WATCHED ? 30 : 60, PIECES_MAX = 4096, AHEAD = 64 };

/* An open volume whose every value is of interest. */
typedef struct stage {
    leafcast *v;
    tracer tr;
} stage;

static void select_all(stage *s) {
    const interest all = interest_of_all();
    loader_select(s->v->treelets, &all);
}

static void stage_open(stage *s, const char *path) {
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_surface surface = leafcast_surface_default(0.0);
    s->v = fixture_open(path, NULL);
    assert_int_equal(leafcast_select(s->v, &surface, 1), LEAFCAST_OK);
    assert_int_equal(volume_tracer(s->v, &scene, NULL, &s->tr), ST_OK);
    select_all(s);
}

static void stage_close(stage *s) {
    leafcast_close(s->v);
}

/* All pieces of a ray, with room for so many ahead. */
static size_t follow(const stage *s, const ray *r, uint32_t room, segment *out) {
    static segment ahead[AHEAD];
    ray_counters counters = {0};
    segments_state state = segments_begin(ahead, room);
    size_t count = 0;
    for (;;) {
        const treelet *at;
        switch (segments_next(&s->tr, r, &state, &out[count], &counters)) {
        case SEGMENTS_END: return count;
        case SEGMENTS_SOME: assert_true(++count < PIECES_MAX); break;
        case SEGMENTS_BLOCKED: assert_int_equal(volume_treelet(s->v, state.blocked, &at), ST_OK);
        }
    }
}

/* Of what is selected at random, those pieces in whose cells it is met. */
static void check_interest(stage *s, const segment_truth *truth, const ray *r, const segment *all,
                           size_t count, field_random *random) {
    static segment got[PIECES_MAX];
    interests set;
    double values[8] = {0.0};
    size_t expected = 0;
    for (int i = 0; i < 8 && count > 0; i++) {
        const segment *of = &all[field_random_below(random, (long)count)];
        double range[2];
        truth->range(truth->of, of->cell, range);
        values[i] = range[i % 2];
    }
    interests_random(&set, random, values, 8);
    loader_select(s->v->treelets, &set.in);
    const size_t found = follow(s, r, AHEAD, got);
    for (size_t i = 0; i < count; i++) {
        double range[2];
        truth->range(truth->of, all[i].cell, range);
        if (!interests_meet(&set, range[0], range[1]))
            continue;
        assert_true(expected < found);
        assert_memory_equal(&all[i], &got[expected], sizeof *got);
        expected++;
    }
    assert_int_equal(expected, found);
    select_all(s);
}

static void check_ray(segment_tally *sum, stage *s, const segment_truth *truth, const char *name,
                      const ref_ray *world, field_random *random) {
    static segment got[PIECES_MAX], again[PIECES_MAX];
    ray r;
    assert_true(tracer_ray(&s->tr, world->o, world->d, 0.0, INFINITY, &r));
    const ref_ray in_grid = {{r.o[0], r.o[1], r.o[2]}, {r.d[0], r.d[1], r.d[2]}};
    const size_t count = follow(s, &r, AHEAD, got);
    const segments_error error = segments_error_of(&s->tr, &r, (double[2]){0.0, 1.0});
    segment_judge(sum, truth, name, &in_grid, got, count, &error);
    /* No room to speak of; and now and then, no place for more than one treelet. */
    loader *l = s->v->treelets;
    const uint32_t slots = l->file->layout.treelets, room = 1 + (uint32_t)(sum->rays % 9);
    loader_set_capacity(l, sum->rays % 8 ? slots : 1, 0);
    assert_int_equal(follow(s, &r, room, again), count);
    assert_memory_equal(got, again, count * sizeof *got);
    loader_set_capacity(l, slots, 0);
    if (sum->rays % 4 == 0)
        check_interest(s, truth, &r, got, count, random);
}

static void check_made(field *f, uint32_t cells_log2) {
    stage s;
    field_random random = {FIELD_SEED};
    segment_tally sum = {0};
    const char *name = f->name;
    const ref_volume world = field_volume(f);
    stage_open(&s, fixture_leaf(f, cells_log2, 1, false));
    ref_volume grid = ref_volume_regular(f->dims, f->samples, NULL, NULL);
    for (int a = 0; a < 3; a++)
        grid.axis[a] = s.v->file->axis[a];
    const segment_truth truth = segment_truth_grid(&grid);
    for (int i = 0; i < RAYS; i++) {
        const ref_ray rays[] = {
            field_random_ray(&world, &random, 20), field_random_ray(&world, &random, -1),
            field_random_ray(&world, &random, 1e6), field_exact_ray(&world, &random),
            field_aimed_ray(&world, &random, 5)};
        for (size_t k = 0; k < sizeof rays / sizeof *rays; k++)
            check_ray(&sum, &s, &truth, name, &rays[k], &random);
    }
    print_message("# %s: %zu rays, %zu pieces, %zu faces; worst t %.2g, value %.2g, sum %.2g of "
                  "the bounds; %zu faults\n",
                  name, sum.rays, sum.pieces, sum.faces, sum.worst_t, sum.worst_value,
                  sum.worst_sum, sum.faults);
    assert_int_equal(sum.faults, 0);
    assert_true(sum.pieces > sum.rays);
    stage_close(&s);
}

static void check_field(const char *name, long n, uint32_t cells_log2) {
    field f;
    assert_true(field_make(&f, name, n, FIELD_SEED));
    check_made(&f, cells_log2);
    field_release(&f);
}

static void test_every_field(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < field_count(); i++)
        check_field(field_name(i), 23, 4);
}

static void test_other_sizes(void **state) {
    (void)state;
    skip_under_thread();
    check_field("noise-u8", 2, 4);
    check_field("missing", 17, 4);
    check_field("waves", 40, 5);
    check_field("waves", 40, 6);
}

/* The types that no field has. */
static void test_other_types(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < FIELD_RETYPED; i++) {
        field f;
        field_make_retyped(&f, i, 23, FIELD_SEED);
        check_made(&f, 4);
        field_release(&f);
    }
}

/* Coarse levels, which reach past the box: as long a way, without a gap. */
static void test_levels(void **state) {
    (void)state;
    skip_under_thread();
    static segment got[PIECES_MAX], fine[PIECES_MAX];
    field f;
    stage s;
    field_random random = {FIELD_SEED};
    assert_true(field_make(&f, "waves", 40, FIELD_SEED));
    const ref_volume world = field_volume(&f);
    stage_open(&s, fixture_leaf(&f, 4, 1, false));
    leafcast_scene scene = leafcast_scene_default();
    scene.lod = LEAFCAST_LOD_LEVEL;
    scene.lod_level = 1;
    for (int i = 0; i < RAYS; i++) {
        const ref_ray aimed = field_random_ray(&world, &random, 20);
        double length[2] = {0.0, 0.0};
        ray r;
        assert_true(tracer_ray(&s.tr, aimed.o, aimed.d, 0.0, INFINITY, &r));
        const size_t all = follow(&s, &r, AHEAD, fine);
        const tracer exact = s.tr;
        assert_int_equal(volume_tracer(s.v, &scene, NULL, &s.tr), ST_OK);
        assert_true(tracer_ray(&s.tr, aimed.o, aimed.d, 0.0, INFINITY, &r));
        const size_t count = follow(&s, &r, AHEAD, got);
        s.tr = exact;
        for (size_t k = 0; k < all; k++)
            length[0] += fine[k].t1 - fine[k].t0;
        for (size_t k = 0; k < count; k++) {
            length[1] += got[k].t1 - got[k].t0;
            assert_true(k == 0 || got[k].t0 == got[k - 1].t1);
        }
        assert_true(count < all && 2 * count + 3 >= all);
        assert_true(fabs(length[1] - length[0]) < 1e-12);
    }
    stage_close(&s);
    field_release(&f);
}

/* ---- Meshes ---- */

/* The tets of a file, in its order, each with vertices of its own. */
typedef struct soup {
    tet_ref_mesh m;
    float (*points)[3], *values;
    uint32_t (*tets)[4];
} soup;

static soup soup_of(const stage *s) {
    const leaf_file *f = s->v->file;
    const size_t tets = f->header.tets;
    soup x = {.points = malloc(4 * tets * sizeof *x.points),
              .values = malloc(4 * tets * sizeof *x.values),
              .tets = malloc(tets * sizeof *x.tets)};
    assert_true(x.points && x.values && x.tets);
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const treelet *at;
        assert_int_equal(volume_treelet(s->v, t, &at), ST_OK);
        const resident_mesh *own = resident_mesh_of(at);
        for (uint32_t i = 0; i < own->mesh.tets; i++) {
            const tet y = mesh_walk_tet(own, i);
            const size_t n = own->first_tet + i;
            memcpy(x.points[4 * n], y.p, sizeof y.p);
            memcpy(&x.values[4 * n], y.f, sizeof y.f);
            for (uint32_t k = 0; k < 4; k++)
                x.tets[n][k] = (uint32_t)(4 * n) + k;
        }
    }
    x.m = (tet_ref_mesh){4 * tets, tets, (const float(*)[3])x.points, x.values,
                         (const uint32_t(*)[4])x.tets};
    return x;
}

static void soup_release(soup *x) {
    free(x->points);
    free(x->values);
    free(x->tets);
}

static void check_mesh(const char *name, int cubes, uint32_t treelet_tets) {
    lab_mesh lab;
    stage s;
    field_random random = {FIELD_SEED};
    segment_tally sum = {0};
    assert_true(lab_mesh_make(&lab, name, cubes, FIELD_SEED));
    stage_open(&s, lab_leaf_make(&lab, treelet_tets, false));
    soup x = soup_of(&s);
    const segment_truth truth = segment_truth_mesh(&x.m, lab.sound);
    for (int i = 0; i < RAYS / 3 * LAB_RAY_KINDS; i++) {
        const ref_ray aimed = lab_mesh_ray(&lab, (lab_ray)(i % LAB_RAY_KINDS), &random);
        check_ray(&sum, &s, &truth, name, &aimed, &random);
    }
    print_message("# %s%s: %u treelets; %zu rays, %zu pieces, %zu faces; worst t %.2g, value %.2g, "
                  "sum %.2g of the bounds; %zu faults\n",
                  name, lab.sound ? "" : ", unsound", s.v->file->layout.treelets, sum.rays,
                  sum.pieces, sum.faces, sum.worst_t, sum.worst_value, sum.worst_sum, sum.faults);
    assert_int_equal(sum.faults, 0);
    /* The bounds are for the worst: what there is stays below. */
    assert_true(sum.worst_t < 0.2 && sum.worst_value < 0.1);
    assert_true(sum.pieces > sum.rays && sum.faces >= sum.rays * lab.sound);
    soup_release(&x);
    stage_close(&s);
    lab_mesh_release(&lab);
}

static void test_every_mesh(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < lab_mesh_count(); i++)
        check_mesh(lab_mesh_name(i), 5, 40);
}

static double t_error(const lab_mesh *lab, uint32_t treelet_tets) {
    const double o[3] = {-3.0, 2.2, 2.7}, d[3] = {1.0, 0.4, 0.3};
    stage s;
    ray r;
    stage_open(&s, lab_leaf_make(lab, treelet_tets, false));
    assert_true(tracer_ray(&s.tr, o, d, 0.0, INFINITY, &r));
    const double t = segments_error_of(&s.tr, &r, (double[2]){0.0, 1.0}).t;
    stage_close(&s);
    return t;
}

/* The t of a tet errs by the size of what is around it, not of the whole mesh. */
static void test_own_size(void **state) {
    (void)state;
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, "sphere", 6, FIELD_SEED));
    assert_true(t_error(&lab, 40) < 0.6 * t_error(&lab, 2000));
    lab_mesh_release(&lab);
}

/* ---- leafcast.h ---- */

enum { SIDE = WATCHED ? 12 : 24 };

static void draw(leafcast *v, double *z) {
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera c = leafcast_standard_view(v, 1.1, SIDE, SIDE);
    const leafcast_image image = {.size = sizeof image, .z = z};
    assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_OK);
}

static void assert_told(const segment *s, const leafcast_segment *told, bool is_mesh) {
    assert_true(told->t0 == s->t0 && told->t1 == s->t1 && told->degree == (int)s->degree);
    assert_memory_equal(told->control, s->b, (s->degree + 1) * sizeof *s->b);
    assert_int_equal(told->degree, is_mesh ? 1 : 3);
    for (int i = 0; i <= 32; i++) {
        const double value = segment_at(s, i / 32.0),
                     slack = 1e-13 * fmax(fabs(told->least), fabs(told->most));
        assert_true(value >= told->least - slack && value <= told->most + slack);
    }
    assert_true(told->least_t >= s->t0 && told->least_t <= s->t1);
    assert_true(told->most_t >= s->t0 && told->most_t <= s->t1);
}

/* What the internal functions give; a picture before and after, by one selection. */
static void check_public(const char *path, double iso, const ref_ray *r) {
    static segment want[PIECES_MAX];
    static leafcast_segment told[PIECES_MAX];
    static double before[SIDE * SIDE], after[SIDE * SIDE];
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_surface surface = leafcast_surface_default(iso);
    stage s;
    ray in_volume;
    int count = 0, some = 0;
    stage_open(&s, path);
    const bool is_mesh = leafcast_describe(s.v).dims[0] == 0;
    assert_true(tracer_ray(&s.tr, r->o, r->d, 0.0, INFINITY, &in_volume));
    const size_t expected = follow(&s, &in_volume, AHEAD, want);
    stage_close(&s);

    leafcast *v = fixture_open(path, NULL);
    assert_int_equal(leafcast_probe_segments(v, &scene, r->o, r->d, told, PIECES_MAX, &count),
                     LEAFCAST_OK);
    assert_int_equal(count, expected);
    for (int i = 0; i < count; i++)
        assert_told(&want[i], &told[i], is_mesh);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    draw(v, before);
    const uint32_t active = v->treelets->treelets_active;
    assert_int_equal(leafcast_probe_segments(v, &scene, r->o, r->d, told, 3, &some), LEAFCAST_OK);
    assert_int_equal(some, 3);
    assert_told(&want[2], &told[2], is_mesh);
    assert_int_equal(v->treelets->treelets_active, active);
    draw(v, after);
    assert_memory_equal(before, after, sizeof before);
    assert_int_equal(
        leafcast_probe_segments(v, &scene, r->o, (double[3]){0.0, 0.0, 0.0}, told, 3, &some),
        LEAFCAST_USAGE);
    leafcast_close(v);
}

static void test_public(void **state) {
    (void)state;
    field f;
    lab_mesh lab;
    assert_true(field_make(&f, "sphere", 40, FIELD_SEED));
    const ref_ray across = {{-3.0, 12.2, 17.7}, {1.0, 0.2, 0.1}};
    check_public(fixture_leaf(&f, 4, 1, false), f.iso, &across);
    field_release(&f);
    assert_true(lab_mesh_make(&lab, "sphere", 6, FIELD_SEED));
    const ref_ray through = {{-3.0, 2.2, 2.7}, {1.0, 0.1, 0.05}};
    check_public(lab_leaf_make(&lab, 40, false), lab.iso, &through);
    lab_mesh_release(&lab);
}

/* The extremes of a cubic against sampling, those of a line at its ends. */
static void test_range(void **state) {
    (void)state;
    skip_under_thread();
    field_random r = {FIELD_SEED};
    for (int i = 0; i < 2000; i++) {
        segment s = {.t0 = 2.0, .t1 = 5.0, .degree = i % 2 ? 3 : 1};
        double least = INFINITY, most = -INFINITY;
        for (uint32_t k = 0; k <= s.degree; k++)
            s.b[k] = field_random_in(&r, -1.0, 1.0);
        const segment_extent e = segment_range(&s);
        for (int k = 0; k <= 1000; k++) {
            least = fmin(least, segment_at(&s, k / 1000.0));
            most = fmax(most, segment_at(&s, k / 1000.0));
        }
        assert_true(e.least <= least && e.least > least - 1e-5);
        assert_true(e.most >= most && e.most < most + 1e-5);
        assert_true(fabs(segment_at(&s, (e.least_t - 2.0) / 3.0) - e.least) < 1e-14);
        assert_true(fabs(segment_at(&s, (e.most_t - 2.0) / 3.0) - e.most) < 1e-14);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field), cmocka_unit_test(test_other_sizes),
        cmocka_unit_test(test_other_types), cmocka_unit_test(test_levels),
        cmocka_unit_test(test_every_mesh),  cmocka_unit_test(test_own_size),
        cmocka_unit_test(test_public),      cmocka_unit_test(test_range),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
