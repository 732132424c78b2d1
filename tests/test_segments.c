/* test_segments.c - the pieces of rays through cells against the references: each cell once, ends
 * that adjoin, values; the same bits however little is resident. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <string.h>

#include "render/kind.h"
#include "tests/support/fixture.h"
#include "tests/support/segment_truth.h"

enum { RAYS = 60, PIECES_MAX = 4096, AHEAD = 64 };

/* An open volume whose every value is of interest. */
typedef struct stage {
    leafcast *v;
    tracer tr;
} stage;

static void select_all(stage *s) {
    loader *l = s->v->treelets;
    for (uint32_t t = 0; t < l->file->layout.treelets; t++) {
        l->own[t] = 1;
        l->children[t] = leaf_layout_children(&l->file->layout, t);
    }
}

/* Whether the cell at a bit of a block's mask is there. */
static bool cell_exists(const treelet *at, uint32_t block, unsigned bit) {
    const uint32_t levels = at->shape.node_levels;
    for (unsigned a = 0; a < 3; a++) {
        uint32_t c = (bit >> a & 1) | (bit >> (3 + a) & 1) << 1;
        for (unsigned k = 0; k < levels; k++)
            c |= (block >> (3 * k + a) & 1) << (k + 2);
        if (c >= at->shape.cells[a])
            return false;
    }
    return true;
}

/* Every cell is active. */
static void mask_all(const treelet *at) {
    active_masks *m = at->masks;
    memset(m->nodes, 255, active_nodes_at(at->shape.node_levels));
    m->root = 255;
    for (uint32_t b = 0; b < 1u << (3 * at->shape.node_levels); b++) {
        m->cells[b] = 0;
        for (unsigned i = 0; i < 64; i++)
            m->cells[b] |= (uint64_t)cell_exists(at, b, i) << i;
    }
}

static void stage_open(stage *s, const char *path) {
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_surface surface = leafcast_surface_default(0.0);
    s->v = fixture_open(path, NULL);
    assert_int_equal(leafcast_select(s->v, &surface, 1), LEAFCAST_OK);
    assert_int_equal(volume_tracer(s->v, &scene, NULL, &s->tr), ST_OK);
    select_all(s);
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
        case SEGMENTS_BLOCKED:
            assert_int_equal(volume_treelet(s->v, state.blocked, &at), ST_OK);
            mask_all(at);
        }
    }
}

static void check_ray(segment_tally *sum, const stage *s, const segment_truth *truth,
                      const char *name, const ref_ray *world) {
    static segment got[PIECES_MAX], again[PIECES_MAX];
    ray r;
    assert_true(tracer_ray(&s->tr, world->o, world->d, 0.0, INFINITY, &r));
    const ref_ray in_grid = {{r.o[0], r.o[1], r.o[2]}, {r.d[0], r.d[1], r.d[2]}};
    const size_t count = follow(s, &r, AHEAD, got);
    segment_judge(sum, truth, name, &in_grid, got, count);
    assert_int_equal(follow(s, &r, 1, again), count);
    assert_memory_equal(got, again, count * sizeof *got);
}

static void check_field(const char *name, long n, uint32_t cells_log2) {
    field f;
    stage s;
    field_random random = {FIELD_SEED};
    segment_tally sum = {0};
    assert_true(field_make(&f, name, n, FIELD_SEED));
    const ref_volume world = field_volume(&f);
    stage_open(&s, fixture_leaf(&f, cells_log2, 1, false));
    ref_volume grid = ref_volume_regular(f.dims, f.samples, NULL, NULL);
    for (int a = 0; a < 3; a++)
        grid.axis[a] = s.v->file->axis[a];
    const segment_truth truth = segment_truth_grid(&grid);
    for (int i = 0; i < RAYS; i++) {
        const ref_ray rays[] = {
            field_random_ray(&world, &random, 20), field_random_ray(&world, &random, -1),
            field_random_ray(&world, &random, 1e6), field_exact_ray(&world, &random),
            field_aimed_ray(&world, &random, 5)};
        for (size_t k = 0; k < sizeof rays / sizeof *rays; k++)
            check_ray(&sum, &s, &truth, name, &rays[k]);
    }
    print_message("# %s: %zu rays, %zu pieces, %zu faces; worst t %.2g, value %.2g, sum %.2g of "
                  "the bounds; %zu faults\n",
                  name, sum.rays, sum.pieces, sum.faces, sum.worst_t, sum.worst_value,
                  sum.worst_sum, sum.faults);
    assert_int_equal(sum.faults, 0);
    assert_true(sum.pieces > sum.rays);
    leafcast_close(s.v);
    field_release(&f);
}

static void test_every_field(void **state) {
    (void)state;
    for (int i = 0; i < field_count(); i++)
        check_field(field_name(i), 23, 4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
