/* test_medium_batch.c - every SIMD version of the media kernel that this CPU has against the scalar
 * one, to the bit: random pieces of rays, hostile transfer functions.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/fields.h"
#include "tests/support/hostile_transfer.h"
#include "tests/support/medium_batch_wide.h"

enum { SEED = 77, ROUNDS = 12 };

static int versions(void) {
    return (int)cpu_best() + 2;
}

static medium_batch_fn version(int v, const char **name) {
    const bool wide = v > (int)cpu_best();
    *name = wide ? "wide" : cpu_isa_name((cpu_isa)v);
    return wide ? medium_batch_wide : medium_batch_kernels[(cpu_isa)v];
}

/* Values of a cell: anything in the range, next to nothing apart, or those of points. */
static double value_of(const transfer_range *range, const leafcast_transfer_point *points,
                       int count, field_random *r) {
    if (field_random_below(r, 3) == 0)
        return points[field_random_below(r, (uint32_t)count)].value;
    return field_random_in(r, range->least, range->most);
}

static void fill_pieces(segment_columns *c, medium_batch *m, const transfer_range *range,
                        const leafcast_transfer_point *points, int count, field_random *r) {
    c->count = 1 + (unsigned)field_random_below(r, SEGMENT_COLUMNS);
    c->degree = field_random_below(r, 2) ? 3 : 1;
    for (unsigned i = 0; i < c->count; i++) {
        const double centre = value_of(range, points, count, r);
        const double spread = (range->most - range->least) *
                              (field_random_below(r, 3) ? field_random_in(r, 0, 0.02) : 0.5) *
                              (field_random_below(r, 6) != 0);
        c->t0[i] = field_random_in(r, 0, range->length);
        c->t1[i] = c->t0[i] + range->length * field_random_in(r, 1e-9, 0.01);
        c->treelet[i] = 0;
        c->ray[i] = 0;
        const bool even = field_random_below(r, 8) == 0;
        c->spread[i] = even ? SEGMENT_EVEN : 0.0;
        for (int k = 0; k < 4; k++)
            c->b[k][i] = even ? centre * (1.0 + 0x1p-52 * (k % 3 == 0 && c->degree == 3))
                              : centre + spread * field_random_in(r, -1, 1);
        m->per_length[i] = field_random_in(r, 0, 1e-3) / range->length;
        m->t_error[i] = 1e-15 * range->length;
        m->value_error[i] = (double)field_random_below(r, 2) * 1e-13 * fabs(range->most);
    }
}

static transfer_range random_range(field_random *r) {
    static const double scales[] = {1.0, 1e-30, 1e30, 255.0};
    float samples[64];
    const double scale = scales[field_random_below(r, 4)];
    for (int i = 0; i < 64; i++)
        samples[i] = (float)(scale * field_random_in(r, -0.2, 1));
    return transfer_range_of(samples, 64, exp2(field_random_in(r, -3, 10)), r);
}

static void same(const char *name, const medium_batch *got, const medium_batch *meant, unsigned i) {
    static const medium_stretch nothing = {.through = 1.0};
    medium_stretch s[2] = {nothing, nothing};
    const medium_batch *of[2] = {got, meant};
    for (int k = 0; k < 2; k++)
        if (of[k]->seen[i])
            s[k] = (medium_stretch){{of[k]->rgb[0][i], of[k]->rgb[1][i], of[k]->rgb[2][i]},
                                    of[k]->through[i],
                                    of[k]->rgb_error[i],
                                    of[k]->through_error[i]};
    if (memcmp(&s[0], &s[1], sizeof s[0]) != 0)
        fail_msg("%s, piece %u: through %a error %a, not %a error %a", name, i, s[0].through,
                 s[0].rgb_error, s[1].through, s[1].rgb_error);
}

/* Of the pieces looked at by vectors. */
static struct { unsigned long pieces, alone, cut, stretches, stepped; } tally;

static void note(const medium_batch *m, unsigned pieces) {
    tally.pieces += pieces;
    tally.alone += m->alone;
    tally.cut += m->cut;
    tally.stretches += m->stretches;
    tally.stepped += m->stepped;
}

static void the_same_bits(void **state) {
    static segment_columns pieces;
    static medium_batch got, meant;
    leafcast_transfer_point points[HOSTILE_POINTS_MAX];
    field_random r = {SEED};
    mem m;
    (void)state;
    mem_init(&m, 0);
    for (int round = 0; round < ROUNDS * hostile_transfer_kinds(); round++) {
        const transfer_range range = random_range(&r);
        const int count = hostile_transfer(round % hostile_transfer_kinds(), &range, &r, points);
        const leafcast_medium medium = {points, count};
        transfer t;
        assert_int_equal(transfer_init(&t, &m, &medium), ST_OK);
        meant.transfer = &t;
        meant.share = 1e-3;
        meant.drop = 1e-6;
        fill_pieces(&pieces, &meant, &range, points, count, &r);
        got = meant;
        medium_batch_kernels[CPU_SCALAR](&meant, &pieces);
        for (int v = 1; v < versions(); v++) {
            const char *name;
            const medium_batch_fn kernel = version(v, &name);
            got.alone = got.cut = got.stretches = got.stepped = 0;
            kernel(&got, &pieces);
            note(&got, pieces.count);
            for (unsigned i = 0; i < pieces.count; i++)
                same(name, &got, &meant, i);
        }
        transfer_release(&t, &m);
    }
    print_message("# of %lu pieces %lu alone; %lu cuts, %lu stretches, %lu by steps\n",
                  tally.pieces, tally.alone, tally.cut, tally.stretches, tally.stepped);
    assert_true(tally.alone > 0 && tally.alone < tally.pieces / 2);
    assert_true(tally.cut > tally.pieces / 4);
    assert_true(tally.stretches > tally.pieces / 4);
    assert_true(tally.stepped > tally.stretches / 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_same_bits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
