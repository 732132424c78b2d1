/* test_segment_batch.c - the pieces of many rays in columns are those of rays one by one, to the
 * bit: every ISA, whatever is of interest, wherever rays begin and end, and however few treelets
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

#include "tests/support/pictures.h"
#include "tests/support/ray_stage.h"

#ifdef __SANITIZE_ADDRESS__
enum { BATCHES = 2, SCENES = 6 };
#else
enum { BATCHES = 8, SCENES = 36 };
#endif

enum { PIECES_MAX = 600, FOREVER = UINT32_MAX };

/* ---- Pieces ---- */

/* What a ray was given. */
typedef struct given {
    unsigned count;
    segment of[PIECES_MAX]; /* cells aside */
} given;

static given wanted[RAY_BATCH], got[RAY_BATCH];
static segments_state want_state[RAY_BATCH], got_state[RAY_BATCH];
static segments_result want_result[RAY_BATCH];
static segment ahead[RAY_BATCH][SEGMENTS_KEPT]; /* of all rays at the start, */
static segment want_ahead[RAY_BATCH][SEGMENTS_KEPT], got_ahead[RAY_BATCH][SEGMENTS_KEPT];
static uint32_t patience[RAY_BATCH]; /* pieces, after which a ray wants no more */

static void give(given *g, const segment *s) {
    assert_true(g->count < PIECES_MAX);
    g->of[g->count++] = *s;
}

static void take(void *ctx, segment_batch *b) {
    const segment_columns *c = &b->columns;
    (void)ctx;
    assert_true(c->count > 0 && c->count <= SEGMENT_COLUMNS);
    for (unsigned i = 0; i < c->count; i++) {
        segment s = {.t0 = c->t0[i],
                     .t1 = c->t1[i],
                     .spread = c->spread[i],
                     .treelet = c->treelet[i],
                     .degree = (uint32_t)c->degree};
        assert_true(c->ray[i] < b->count);
        if (b->stop[c->ray[i]])
            continue;
        for (uint32_t k = 0; k <= s.degree; k++)
            s.b[k] = c->b[k][i];
        give(&got[c->ray[i]], &s);
        b->stop[c->ray[i]] = got[c->ray[i]].count >= patience[c->ray[i]];
    }
}

/* One by one, as far as treelets are there. */
static void follow(ray_stage *s, const segment_batch *b) {
    ray_counters counters = {0};
    for (unsigned i = 0; i < b->count; i++) {
        segment piece;
        for (;;) {
            want_result[i] = segments_next(&s->tr, &b->rays[i], &want_state[i], &piece, &counters);
            if (want_result[i] != SEGMENTS_SOME)
                break;
            piece.cell = 0;
            give(&wanted[i], &piece);
        }
    }
}

static bool same_pieces(const given *want, const given *have) {
    for (unsigned k = 0; k < have->count && k < want->count; k++)
        if (memcmp(&want->of[k], &have->of[k], sizeof want->of[k]) != 0)
            return false;
    return have->count == want->count;
}

static void judge_ray(ray_stage *s, const segment_batch *b, unsigned i, const char *kernel) {
    const ray *r = &b->rays[i];
    const given *want = &wanted[i], *have = &got[i];
    const segments_state *x = &want_state[i], *y = &got_state[i];
    given cut = *want;
    cut.count = cut.count < patience[i] ? cut.count : patience[i];
    bool right = same_pieces(&cut, have);
    if (!b->stop[i])
        right = right && b->result[i] == want_result[i] && x->provisional == y->provisional &&
                x->blocked == y->blocked &&
                (want_result[i] != SEGMENTS_BLOCKED || x->t_from == y->t_from);
    if (!right)
        print_message("%s: ray %u of %u, o %a %a %a d %a %a %a t %a %a: %u pieces, not %u; result "
                      "%d, not %d; blocked %u, not %u\n",
                      kernel, i, b->count, r->o[0], r->o[1], r->o[2], r->d[0], r->d[1], r->d[2],
                      r->t0, r->t1, have->count, cut.count, (int)b->result[i], (int)want_result[i],
                      y->blocked, x->blocked);
    for (unsigned k = 0; !right && k < have->count && k < cut.count; k++) {
        const segment *p = &cut.of[k], *q = &have->of[k];
        if (memcmp(p, q, sizeof *p) == 0)
            continue;
        print_message("piece %u: t %a %a, not %a %a; %a %a %a %a, not %a %a %a %a\n", k, q->t0,
                      q->t1, p->t0, p->t1, q->b[0], q->b[1], q->b[2], q->b[3], p->b[0], p->b[1],
                      p->b[2], p->b[3]);
        break;
    }
    (void)s;
    assert_true(right);
}

/* ---- Batches ---- */

static void fill(ray_stage *s, segment_batch *b) {
    const unsigned most =
        ray_stage_one_in(s, 2) ? 1 + (unsigned)field_random_below(&s->random, 20) : RAY_BATCH;
    b->count = 0;
    for (unsigned i = 0; i < most; i++) {
        const ref_ray r = ray_stage_aim(s);
        const bool cut = ray_stage_one_in(s, 3);
        const double t0 = cut ? 1.5 * ray_stage_unit(s) - 0.5 : 0.0;
        b->count += tracer_ray(&s->tr, r.o, r.d, t0,
                               cut && ray_stage_one_in(s, 2) ? t0 + ray_stage_unit(s) : INFINITY,
                               &b->rays[b->count]);
    }
}

/* From where all rays are in `from`, with what is ahead of them. */
static void set_out(const segments_state from[], segments_state to[],
                    segment to_ahead[][SEGMENTS_KEPT]) {
    memcpy(to_ahead, ahead, sizeof ahead);
    for (unsigned i = 0; i < RAY_BATCH; i++) {
        to[i] = from[i];
        to[i].ahead = to_ahead[i];
    }
}

/* By kernel k from where all rays are in `from`. */
static void walk(ray_stage *s, segment_batch *b, int k, const segments_state from[]) {
    ray_counters counters = {0};
    size_t before = 0, after = 0;
    set_out(from, got_state, got_ahead);
    for (unsigned i = 0; i < b->count; i++) {
        b->state[i] = &got_state[i];
        b->kept[i] = got_ahead[i];
        before += got[i].count + from[i].count;
    }
    b->take = take;
    memset(s->scratch, 0xa5, kind_batch_scratch(s->v->kind));
    ray_stage_clear_touched(s);
    s->tr.kernels = &s->with[k];
    segment_batch_walk(&s->tr, b, s->scratch, &counters);
    for (unsigned i = 0; i < b->count; i++)
        after += got[i].count;
    assert_true(counters.cells + before >= after);
}

/* A ray that has been on its way by itself may have pieces ahead. */
static void begin_alone(ray_stage *s, const ray *r, segments_state *state, given *so_far) {
    ray_counters counters = {0};
    segment piece;
    if (segments_next(&s->tr, r, state, &piece, &counters) != SEGMENTS_SOME)
        return;
    piece.cell = 0;
    give(so_far, &piece);
    segments_move(state, state->ahead, SEGMENTS_KEPT);
}

static size_t whole; /* pieces with a spread */

static void count_pieces(ray_stage *s, const given *g) {
    s->found += g->count;
    for (unsigned i = 0; i < g->count; i++)
        whole += g->of[i].spread > 0.0;
}

/* All kernels' pieces up to where treelets are absent, and the treelets that count as visible; then
 * these come, and rays go on. */
static void judge(ray_stage *s, segment_batch *b, bool impatient) {
    static segments_state from[RAY_BATCH];
    static given so_far[RAY_BATCH];
    static uint8_t touched[1 << 16];
    const uint32_t treelets = s->v->file->layout.treelets;
    bool more = b->count > 0;
    assert_true(treelets <= sizeof touched);
    for (unsigned i = 0; i < b->count; i++) {
        from[i] = segments_begin(ahead[i], SEGMENTS_KEPT);
        so_far[i].count = 0;
        if (ray_stage_one_in(s, 8))
            begin_alone(s, &b->rays[i], &from[i], &so_far[i]);
        patience[i] = impatient && ray_stage_one_in(s, 2)
                          ? so_far[i].count + 1 + (uint32_t)field_random_below(&s->random, 50)
                          : FOREVER;
    }
    while (more) {
        more = false;
        set_out(from, want_state, want_ahead);
        memcpy(wanted, so_far, sizeof so_far);
        ray_stage_clear_touched(s);
        follow(s, b);
        for (uint32_t t = 0; t < treelets; t++)
            touched[t] = atomic_load(&s->tr.touched[t]);
        for (int k = 0; k < s->kernel_count; k++) {
            memcpy(got, so_far, sizeof so_far);
            walk(s, b, k, from);
            for (unsigned i = 0; i < b->count; i++)
                judge_ray(s, b, i, cpu_isa_name(s->with[k].isa));
            for (uint32_t t = 0; t < treelets && !impatient; t++)
                assert_int_equal(touched[t], atomic_load(&s->tr.touched[t]));
        }
        for (unsigned i = 0; i < b->count && !impatient; i++) {
            const treelet *at;
            from[i] = want_state[i];
            memcpy(ahead[i], want_ahead[i], sizeof ahead[i]);
            so_far[i] = wanted[i];
            more |= want_result[i] == SEGMENTS_BLOCKED;
            s->blocked += want_result[i] == SEGMENTS_BLOCKED;
            if (want_result[i] == SEGMENTS_BLOCKED)
                assert_int_equal(volume_treelet(s->v, want_state[i].blocked, &at), ST_OK);
            if (want_result[i] == SEGMENTS_END)
                from[i].t_from = INFINITY;
        }
    }
    for (unsigned i = 0; i < b->count; i++)
        count_pieces(s, &wanted[i]);
    s->rays += b->count;
}

static void judge_some(ray_stage *s, int batches) {
    static segment_batch b;
    for (int i = 0; i < batches; i++) {
        fill(s, &b);
        judge(s, &b, i % 4 == 3);
    }
}

/* ---- The tests ---- */

/* Returns how many rays had to wait. */
static size_t check_field(field *f, int seed, uint32_t cells_log2) {
    ray_stage s;
    const leafcast_scene scene = leafcast_scene_default();
    ray_stage_open(&s, fixture_leaf(f, cells_log2, (uint32_t)seed % 3 > 0, false),
                   (uint64_t)seed + 1);
    s.homogeneous = true;
    s.world = field_volume(f);
    for (int absent = 0; absent < 9; absent += 4) {
        ray_stage_show(&s, &scene);
        ray_stage_bring_in(&s, absent);
        judge_some(&s, BATCHES);
        assert_true(s.blocked == 0 || absent > 0);
    }
    assert_true(s.found > s.rays);
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
    assert_true(whole > 100 * (size_t)field_count());
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

/* Clips, levels, previews with doubts. */
static void test_every_scene(void **state) {
    (void)state;
    for (int i = 0; i < SCENES; i++) {
        ray_stage s;
        field f;
        assert_true(field_make(&f, field_name(i % field_count()), 37, FIELD_SEED));
        ray_stage_open(&s, fixture_leaf(&f, 4, i % 3 > 0, false), (uint64_t)i + 1);
        s.homogeneous = true;
        s.world = field_volume(&f);
        leafcast_scene scene = pictures_scene(i, &s.info);
        ray_stage_show(&s, &scene);
        ray_stage_bring_in(&s, 3);
        judge_some(&s, 2);
        scene.preview = true;
        ray_stage_show(&s, &scene);
        s.tr.doubts = i % 4 > 0;
        ray_stage_bring_in(&s, 3);
        judge_some(&s, 2);
        ray_stage_close(&s, f.name);
        field_release(&f);
    }
}

/* Rays of a kind without a kernel go one by one. */
static void test_mesh(void **state) {
    (void)state;
    ray_stage s;
    lab_mesh lab;
    const leafcast_scene scene = leafcast_scene_default();
    assert_true(lab_mesh_make(&lab, "sphere", 5, FIELD_SEED));
    ray_stage_open(&s, lab_leaf_make(&lab, 40, false), 1);
    s.homogeneous = true;
    s.lab = &lab;
    ray_stage_show(&s, &scene);
    ray_stage_bring_in(&s, 5);
    judge_some(&s, BATCHES);
    assert_true(s.blocked > 0 && s.found > s.rays);
    ray_stage_close(&s, "mesh");
    lab_mesh_release(&lab);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field), cmocka_unit_test(test_larger_treelets),
        cmocka_unit_test(test_other_types), cmocka_unit_test(test_every_scene),
        cmocka_unit_test(test_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
