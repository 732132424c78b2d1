/* test_extreme_batch.c - the greatest and the least values on many rays are those of rays one by
 * one, to the bit, and so are the places, the treelets that are walked and those that are waited
 * for: every ISA, whatever is of interest, wherever rays begin and end, and however few treelets
 * are there.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/leaf_files.h"
#include "tests/support/pictures.h"
#include "tests/support/ray_stage.h"

#ifdef __SANITIZE_ADDRESS__
enum { BATCHES = 2, SCENES = 6 };
#else
enum { BATCHES = 8, SCENES = 36 };
#endif

static extreme_state want[RAY_BATCH], got[RAY_BATCH];
static uint8_t wanted[1 << 16];              /* treelets that single rays walk */
static uint64_t cells_alone, cells_together; /* by the first kernel */

/* ---- Rays ---- */

static unsigned fill_picture(ray_stage *s, const leafcast_camera *view, ray out[RAY_BATCH]) {
    camera c;
    unsigned count = 0;
    assert_int_equal(camera_init(&c, view), ST_OK);
    for (unsigned i = 0; i < RAY_BATCH; i++) {
        double origin[3], direction[3];
        camera_ray(&c, i % 16 + 0.5, i / 16 + 0.5, origin, direction);
        count += tracer_ray(&s->tr, origin, direction, 0.0, INFINITY, &out[count]);
    }
    return count;
}

/* Those of a small picture: neighbours go together. */
static unsigned fill_square(ray_stage *s, ray out[RAY_BATCH]) {
    const leafcast_camera view =
        leafcast_standard_view(s->v, 0.2 + 1.5 * ray_stage_unit(s), 16, 16);
    return fill_picture(s, &view, out);
}

static unsigned fill_any(ray_stage *s, ray out[RAY_BATCH]) {
    const unsigned most =
        ray_stage_one_in(s, 2) ? 1 + (unsigned)field_random_below(&s->random, 20) : RAY_BATCH;
    unsigned count = 0;
    for (unsigned i = 0; i < most; i++) {
        const ref_ray r = ray_stage_aim(s);
        const bool cut = ray_stage_one_in(s, 3);
        const double t0 = cut ? 1.5 * ray_stage_unit(s) - 0.5 : 0.0;
        const double t1 = cut && ray_stage_one_in(s, 2) ? t0 + ray_stage_unit(s) : (double)INFINITY;
        count += tracer_ray(&s->tr, r.o, r.d, t0, t1, &out[count]);
    }
    return count;
}

/* ---- One by one, and together ---- */

static bool same_double(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

static void judge_ray(const extreme_batch *b, unsigned i, const char *kernel) {
    const ray *r = &b->rays[i];
    const extreme_state *x = &want[i], *y = &got[i];
    const bool right = x->provisional == y->provisional && same_double(x->score, y->score) &&
                       same_double(x->t, y->t);
    if (!right)
        print_message("%s: ray %u of %u, o %a %a %a d %a %a %a t %a %a: %s of %a at %a, not %a at "
                      "%a\n",
                      kernel, i, b->count, r->o[0], r->o[1], r->o[2], r->d[0], r->d[1], r->d[2],
                      r->t0, r->t1, x->least ? "least" : "greatest", y->score, y->t, x->score,
                      x->t);
    assert_true(right);
}

/* A ray by itself, until it has all the treelets that it needs. */
static void search_alone(ray_stage *s, const ray *r, extreme_state *state) {
    ray_counters counters = {0};
    const treelet *at;
    while (extreme_next(&s->tr, r, NULL, state, &counters) == TRACE_BLOCKED)
        assert_int_equal(volume_treelet(s->v, state->blocked, &at), ST_OK);
    cells_alone += counters.cells;
}

/* The treelets that rays wait for come; those rays go on. */
static void keep_blocked(ray_stage *s, extreme_batch *b) {
    unsigned kept = 0;
    for (unsigned i = 0; i < b->count; i++) {
        const treelet *at;
        if (b->result[i] != TRACE_BLOCKED)
            continue;
        assert_int_equal(b->state[i]->next.t, b->state[i]->blocked);
        assert_int_equal(volume_treelet(s->v, b->state[i]->blocked, &at), ST_OK);
        b->rays[kept] = b->rays[i];
        b->state[kept++] = b->state[i];
    }
    b->count = kept;
    s->blocked += kept;
}

/* All of them by kernel k, likewise. It walks no treelet that single rays leave out. */
static void judge_kernel(ray_stage *s, const extreme_batch *b, int k) {
    static extreme_batch left;
    ray_counters counters = {0};
    ray_stage_clear_touched(s);
    left = *b;
    for (unsigned i = 0; i < b->count; i++)
        left.state[i] = &got[i];
    for (unsigned turn = 0; left.count > 0; turn++) {
        assert_true(turn < s->v->file->layout.treelets);
        memset(s->scratch, 0xa5, kind_batch_scratch(s->v->kind));
        s->tr.kernels = &s->with[k];
        extreme_batch_next(&s->tr, &left, s->scratch, &counters);
        keep_blocked(s, &left);
    }
    cells_together += k == 0 ? counters.cells : 0;
    for (unsigned i = 0; i < b->count; i++)
        judge_ray(b, i, cpu_isa_name(s->with[k].isa));
    for (uint32_t t = 0; t < s->v->file->layout.treelets; t++)
        assert_true(wanted[t] || !atomic_load(&s->tr.touched[t]));
}

/* One treelet in `absent` is not there at first. */
static void judge(ray_stage *s, const extreme_batch *b, bool least, long absent) {
    const uint32_t treelets = s->v->file->layout.treelets;
    extreme_state begin = extreme_begin(least);
    assert_true(treelets <= sizeof wanted);
    extreme_go_on(&begin, &s->tr);
    ray_stage_clear_touched(s);
    for (unsigned i = 0; i < b->count; i++) {
        want[i] = begin;
        search_alone(s, &b->rays[i], &want[i]);
        s->found += extreme_found(&want[i]);
    }
    for (uint32_t t = 0; t < treelets; t++)
        wanted[t] = atomic_load(&s->tr.touched[t]);
    for (int k = 0; k < s->kernel_count && b->count > 0; k++) {
        for (unsigned i = 0; i < b->count; i++)
            got[i] = begin;
        if (absent > 0 && !s->tr.preview)
            ray_stage_bring_in(s, absent);
        judge_kernel(s, b, k);
    }
    s->rays += b->count;
}

static void judge_some(ray_stage *s, int batches, long absent) {
    static extreme_batch b;
    for (int i = 0; i < batches; i++) {
        b.count = i % 2 ? fill_square(s, b.rays) : fill_any(s, b.rays);
        judge(s, &b, i % 4 < 2, absent);
    }
}

/* ---- The tests ---- */

/* Returns how many rays had to wait. */
static size_t check_field(field *f, int seed, uint32_t cells_log2) {
    ray_stage s;
    const leafcast_scene scene = leafcast_scene_default();
    ray_stage_open(&s, fixture_leaf(f, cells_log2, (uint32_t)seed % 3 > 0, false),
                   (uint64_t)seed + 1);
    s.world = field_volume(f);
    for (int absent = 0; absent < 9; absent += 4) {
        ray_stage_show(&s, &scene);
        ray_stage_bring_in(&s, absent);
        judge_some(&s, BATCHES, absent);
        assert_true(s.blocked == 0 || absent > 0);
    }
    assert_true(s.found > s.rays / 20);
    ray_stage_close(&s, f->name);
    return s.blocked;
}

static void test_every_field(void **state) {
    (void)state;
    size_t blocked = 0;
    for (int i = 0; i < field_count(); i++) {
        field f;
        assert_true(field_make(&f, field_name(i), 37, FIELD_SEED));
        blocked += check_field(&f, i, 4);
        field_release(&f);
    }
    assert_true(blocked > 20 * (size_t)field_count());
}

static void test_larger_treelets(void **state) {
    (void)state;
    for (uint32_t cells_log2 = 5; cells_log2 <= 6; cells_log2++) {
        field f;
        assert_true(field_make(&f, "waves", 70, FIELD_SEED));
        (void)check_field(&f, 1, cells_log2);
        field_release(&f);
    }
}

/* The types that no field has. */
static void test_other_types(void **state) {
    (void)state;
    for (int i = 0; i < FIELD_RETYPED; i++) {
        field f;
        field_make_retyped(&f, i, 23, FIELD_SEED);
        (void)check_field(&f, i, 4);
        field_release(&f);
    }
}

/* Few values: most places, and most treelets, are as good as others. */
static void test_ties(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        field f;
        assert_true(field_make(&f, i ? "noise-u8" : "noise-f32", 37, FIELD_SEED));
        for (long k = 0; k < f.dims[0] * f.dims[1] * f.dims[2]; k++)
            f.samples[k] = f.samples[k] > f.iso ? 3.0F : 1.0F;
        (void)check_field(&f, 1, 4);
        field_release(&f);
    }
}

/* Clips, levels, previews. */
static void test_every_scene(void **state) {
    (void)state;
    for (int i = 0; i < SCENES; i++) {
        ray_stage s;
        field f;
        assert_true(field_make(&f, field_name(i % field_count()), 37, FIELD_SEED));
        ray_stage_open(&s, fixture_leaf(&f, 4, i % 3 > 0, false), (uint64_t)i + 1);
        s.world = field_volume(&f);
        leafcast_scene scene = pictures_scene(i, &s.info);
        ray_stage_show(&s, &scene);
        ray_stage_bring_in(&s, 3);
        judge_some(&s, 2, 3);
        scene.preview = true;
        ray_stage_show(&s, &scene);
        ray_stage_bring_in(&s, 3);
        judge_some(&s, 2, 3);
        ray_stage_close(&s, f.name);
        field_release(&f);
    }
}

/* Single rays keep some treelets in order at a time, batches all. */
static void test_long_way(void **state) {
    (void)state;
    static extreme_batch b;
    ray_stage s;
    const leafcast_scene scene = leafcast_scene_default();
    ray_stage_open(&s, leaf_files_long("long.leaf"), 2);
    ray_stage_show(&s, &scene);
    ray_stage_bring_in(&s, 0);
    for (b.count = 0; b.count < 16;)
        b.count += tracer_ray(&s.tr, (double[3]){-2.0, 2.3 + 0.5 * b.count, 1.7},
                              (double[3]){1, 0, 0}, 0.0, INFINITY, &b.rays[b.count]);
    judge(&s, &b, false, 0);
    assert_true(s.found > 0);
    ray_stage_close(&s, "long");
}

/* Rays of a kind without a kernel go one by one. */
static void test_mesh(void **state) {
    (void)state;
    ray_stage s;
    lab_mesh lab;
    const leafcast_scene scene = leafcast_scene_default();
    assert_true(lab_mesh_make(&lab, "sphere", 5, FIELD_SEED));
    ray_stage_open(&s, lab_leaf_make(&lab, 40, false), 1);
    s.lab = &lab;
    ray_stage_show(&s, &scene);
    ray_stage_bring_in(&s, 5);
    judge_some(&s, BATCHES, 5);
    assert_true(s.blocked > 0 && s.found > 0);
    ray_stage_close(&s, "mesh");
    lab_mesh_release(&lab);
}

/* Neighbours of a picture: each looks first where the one before has found. What that costs is less
 * than what it saves, of both extrema together. */
static void test_mesh_of_neighbours(void **state) {
    (void)state;
    static extreme_batch b;
    ray_stage s;
    lab_mesh lab;
    const leafcast_scene scene = leafcast_scene_default();
    assert_true(lab_mesh_make(&lab, "waves", 12, FIELD_SEED));
    ray_stage_open(&s, lab_leaf_make(&lab, 40, false), 1);
    s.lab = &lab;
    ray_stage_show(&s, &scene);
    ray_stage_bring_in(&s, 0);
    leafcast_camera view = leafcast_standard_view(s.v, 1.5, 16, 16);
    view.fov = 2.0;
    cells_alone = cells_together = 0;
    for (int least = 0; least < 2; least++) {
        b.count = fill_picture(&s, &view, b.rays);
        judge(&s, &b, least, 0);
    }
    assert_true(cells_together < cells_alone);
    ray_stage_close(&s, "mesh of neighbours");
    lab_mesh_release(&lab);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field), cmocka_unit_test(test_larger_treelets),
        cmocka_unit_test(test_other_types), cmocka_unit_test(test_ties),
        cmocka_unit_test(test_every_scene), cmocka_unit_test(test_long_way),
        cmocka_unit_test(test_mesh),        cmocka_unit_test(test_mesh_of_neighbours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
