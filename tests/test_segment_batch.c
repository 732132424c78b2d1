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

#include "formats/base/cpu.h"
#include "render/kind.h"
#include "tests/support/fixture.h"
#include "tests/support/grid_pieces_wide.h"
#include "tests/support/interests.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"

#ifdef __SANITIZE_ADDRESS__
enum { BATCHES = 2, SCENES = 6 };
#else
enum { BATCHES = 8, SCENES = 36 };
#endif

enum { PIECES_MAX = 600, FOREVER = UINT32_MAX };

/* ---- A volume, and the rays through it ---- */

typedef struct stage {
    leafcast *v;
    tracer tr;
    leafcast_info info;
    ref_volume world;    /* a grid; */
    const lab_mesh *lab; /* or a mesh */
    kernels with[8];
    int kernel_count;
    void *scratch;
    field_random random;
    size_t rays, pieces, blocked;
} stage;

static void add_kernels(stage *s, const char *name) {
    if (kernels_for(name, &s->with[s->kernel_count]))
        s->kernel_count++;
}

static void stage_open(stage *s, const char *path, uint64_t seed) {
    *s = (stage){.random = {seed}};
    s->v = fixture_open(path, NULL);
    s->info = leafcast_describe(s->v);
    for (int isa = 0; isa <= (int)cpu_best(); isa++)
        add_kernels(s, cpu_isa_name((cpu_isa)isa));
    add_kernels(s, "scalar");
    s->with[s->kernel_count - 1].grid_pieces = grid_pieces_wide;
    s->scratch = aligned_alloc(64, (s->v->kind->batch_scratch + 127) / 64 * 64);
    assert_non_null(s->scratch);
}

static void stage_close(stage *s, const char *name) {
    print_message("# %s: %zu rays, %zu pieces, %zu blocked\n", name, s->rays, s->pieces,
                  s->blocked);
    free(s->scratch);
    leafcast_close(s->v);
}

static double unit(stage *s) {
    return field_random_unit(&s->random);
}

static bool one_in(stage *s, long of) {
    return field_random_below(&s->random, of) == 0;
}

/* All, or a set of values at random. */
static void select_some(stage *s) {
    interests set;
    double values[8];
    const interest all = interest_of_all();
    for (int i = 0; i < 8; i++)
        values[i] = s->info.value_min + unit(s) * (s->info.value_max - s->info.value_min);
    interests_random(&set, &s->random, values, 8);
    loader_select(s->v->treelets, one_in(s, 2) ? &all : &set.in);
}

static void stage_show(stage *s, const leafcast_scene *scene) {
    const leafcast_surface surface =
        leafcast_surface_default(0.5 * (s->info.value_min + s->info.value_max));
    const leafcast_camera view = leafcast_standard_view(s->v, 1.5, 40, 40);
    camera c;
    assert_int_equal(leafcast_select(s->v, &surface, 1), LEAFCAST_OK);
    volume_show(s->v, 0, 0, &surface, 1);
    assert_int_equal(camera_init(&c, &view), ST_OK);
    assert_int_equal(volume_tracer(s->v, scene, &c, &s->tr), ST_OK);
    select_some(s);
}

/* One treelet in `of` stays absent, at random; 0: none. */
static void bring_in(stage *s, long of) {
    const uint32_t treelets = s->v->file->layout.treelets;
    loader_request *requests = malloc(treelets * sizeof *requests);
    size_t count = 0;
    assert_non_null(requests);
    loader_clear(s->v->treelets);
    loader_set_capacity(s->v->treelets, treelets, 0);
    for (uint32_t t = 0; t < treelets; t++)
        if (of == 0 || field_random_below(&s->random, of) > 0)
            requests[count++] = (loader_request){t, t};
    if (count > 0)
        assert_int_equal(loader_admit(s->v->treelets, requests, count), ST_OK);
    assert_int_equal(loader_settle(s->v->treelets), ST_OK);
    free(requests);
}

static ref_ray aim(stage *s) {
    field_random *r = &s->random;
    if (s->lab)
        return lab_mesh_ray(s->lab, (lab_ray)field_random_below(r, LAB_RAY_KINDS), r);
    switch (field_random_below(r, 6)) {
    case 0:
    case 1: return field_exact_ray(&s->world, r); /* along axes and planes, through corners */
    case 2: return field_aimed_ray(&s->world, r, 5);
    case 3: return field_random_ray(&s->world, r, 1e6);
    case 4: return field_random_ray(&s->world, r, 20);
    default: return field_random_ray(&s->world, r, -1);
    }
}

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
static void follow(stage *s, const segment_batch *b) {
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

static void judge_ray(stage *s, const segment_batch *b, unsigned i, const char *kernel) {
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

static void fill(stage *s, segment_batch *b) {
    const unsigned most =
        one_in(s, 2) ? 1 + (unsigned)field_random_below(&s->random, 20) : RAY_BATCH;
    b->count = 0;
    for (unsigned i = 0; i < most; i++) {
        const ref_ray r = aim(s);
        const bool cut = one_in(s, 3);
        const double t0 = cut ? 1.5 * unit(s) - 0.5 : 0.0;
        b->count += tracer_ray(&s->tr, r.o, r.d, t0, cut && one_in(s, 2) ? t0 + unit(s) : INFINITY,
                               &b->rays[b->count]);
    }
}

static void clear_touched(const stage *s) {
    for (uint32_t t = 0; t < s->v->file->layout.treelets; t++)
        atomic_store(&s->tr.touched[t], 0);
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
static void walk(stage *s, segment_batch *b, int k, const segments_state from[]) {
    ray_counters counters = {0};
    size_t before = 0, after = 0;
    set_out(from, got_state, got_ahead);
    for (unsigned i = 0; i < b->count; i++) {
        b->state[i] = &got_state[i];
        b->kept[i] = got_ahead[i];
        before += got[i].count + from[i].count;
    }
    b->take = take;
    memset(s->scratch, 0xa5, s->v->kind->batch_scratch);
    clear_touched(s);
    segment_batch_walk(&s->tr, &s->with[k], b, s->scratch, &counters);
    for (unsigned i = 0; i < b->count; i++)
        after += got[i].count;
    assert_true(counters.cells + before >= after);
}

/* A ray that has been on its way by itself may have pieces ahead. */
static void begin_alone(stage *s, const ray *r, segments_state *state, given *so_far) {
    ray_counters counters = {0};
    segment piece;
    if (segments_next(&s->tr, r, state, &piece, &counters) != SEGMENTS_SOME)
        return;
    piece.cell = 0;
    give(so_far, &piece);
    segments_move(state, state->ahead, SEGMENTS_KEPT);
}

/* All kernels' pieces up to where treelets are absent, and the treelets that count as visible; then
 * these come, and rays go on. */
static void judge(stage *s, segment_batch *b, bool impatient) {
    static segments_state from[RAY_BATCH];
    static given so_far[RAY_BATCH];
    static uint8_t touched[1 << 16];
    const uint32_t treelets = s->v->file->layout.treelets;
    bool more = b->count > 0;
    assert_true(treelets <= sizeof touched);
    for (unsigned i = 0; i < b->count; i++) {
        from[i] = segments_begin(ahead[i], SEGMENTS_KEPT);
        so_far[i].count = 0;
        if (one_in(s, 8))
            begin_alone(s, &b->rays[i], &from[i], &so_far[i]);
        patience[i] = impatient && one_in(s, 2)
                          ? so_far[i].count + 1 + (uint32_t)field_random_below(&s->random, 50)
                          : FOREVER;
    }
    while (more) {
        more = false;
        set_out(from, want_state, want_ahead);
        memcpy(wanted, so_far, sizeof so_far);
        clear_touched(s);
        follow(s, b);
        for (uint32_t t = 0; t < treelets; t++)
            touched[t] = atomic_load(&s->tr.touched[t]);
        for (int k = 0; k < s->kernel_count; k++) {
            memcpy(got, so_far, sizeof so_far);
            walk(s, b, k, from);
            for (unsigned i = 0; i < b->count; i++)
                judge_ray(s, b, i, s->with[k].name);
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
        s->pieces += wanted[i].count;
    s->rays += b->count;
}

static void judge_some(stage *s, int batches) {
    static segment_batch b;
    for (int i = 0; i < batches; i++) {
        fill(s, &b);
        judge(s, &b, i % 4 == 3);
    }
}

/* ---- The tests ---- */

/* Returns how many rays had to wait. */
static size_t check_field(field *f, int seed, uint32_t cells_log2) {
    stage s;
    const leafcast_scene scene = leafcast_scene_default();
    stage_open(&s, fixture_leaf(f, cells_log2, (uint32_t)seed % 3 > 0, false), (uint64_t)seed + 1);
    s.world = field_volume(f);
    for (int absent = 0; absent < 9; absent += 4) {
        stage_show(&s, &scene);
        bring_in(&s, absent);
        judge_some(&s, BATCHES);
        assert_true(s.blocked == 0 || absent > 0);
    }
    assert_true(s.pieces > s.rays);
    stage_close(&s, f->name);
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

/* The types that no field has: noise of all their values. */
static void test_other_types(void **state) {
    (void)state;
    static const struct {
        const char *field, *type;
        float below;
    } types[] = {{"noise-u8", "i8", 128.0F}, {"noise-i16", "u16", -32768.0F}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        field f;
        assert_true(field_make(&f, types[i].field, 23, FIELD_SEED));
        f.type = f.name = types[i].type;
        for (long k = 0; k < f.dims[0] * f.dims[1] * f.dims[2]; k++)
            f.samples[k] -= types[i].below;
        (void)check_field(&f, (int)i, 4);
        field_release(&f);
    }
}

/* Clips, levels, previews. */
static void test_every_scene(void **state) {
    (void)state;
    for (int i = 0; i < SCENES; i++) {
        stage s;
        field f;
        assert_true(field_make(&f, field_name(i % field_count()), 37, FIELD_SEED));
        stage_open(&s, fixture_leaf(&f, 4, i % 3 > 0, false), (uint64_t)i + 1);
        s.world = field_volume(&f);
        leafcast_scene scene = pictures_scene(i, &s.info);
        stage_show(&s, &scene);
        bring_in(&s, 3);
        judge_some(&s, 2);
        scene.preview = true;
        stage_show(&s, &scene);
        bring_in(&s, 3);
        judge_some(&s, 2);
        stage_close(&s, f.name);
        field_release(&f);
    }
}

/* Rays of a kind without a kernel go one by one. */
static void test_mesh(void **state) {
    (void)state;
    stage s;
    lab_mesh lab;
    const leafcast_scene scene = leafcast_scene_default();
    assert_true(lab_mesh_make(&lab, "sphere", 5, FIELD_SEED));
    stage_open(&s, lab_leaf_make(&lab, 40, false), 1);
    s.lab = &lab;
    stage_show(&s, &scene);
    bring_in(&s, 5);
    judge_some(&s, BATCHES);
    assert_true(s.blocked > 0 && s.pieces > s.rays);
    stage_close(&s, "mesh");
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
