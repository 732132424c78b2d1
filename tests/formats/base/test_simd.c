/* test_simd.c - every word of formats/base/simd.h means the same on every ISA that this CPU has. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/fields.h"
#include "tests/support/simd_probe.h"

enum { SEED = 41, ROUNDS = 20000 };

/* Ordinary numbers, now and then one that comparisons and rounding may get wrong. */
static double number(field_random *r) {
    static const double odd[] = {
        0.0,       -0.0, 1.0,      -1.0,           0.5,   -0.5, 0x1p-1074, 0x1p-149, INFINITY,
        -INFINITY, NAN,  0x1p1023, 0x1.fffffep127, 1e300, 2.5,  -2.5};
    if (field_random_below(r, 4) == 0)
        return odd[field_random_below(r, sizeof odd / sizeof odd[0])];
    return field_random_in(r, -1, 1) * exp2((double)field_random_below(r, 12) - 3);
}

static void fill(field_random *r, simd_probe_input *in) {
    for (int i = 0; i < SIMD_PROBE_F; i++) {
        in->a[i] = number(r);
        in->b[i] = field_random_below(r, 5) ? number(r) : in->a[i];
        in->x[i] = (float)number(r);
        in->y[i] = field_random_below(r, 5) ? (float)number(r) : in->x[i];
    }
    in->p = (unsigned)field_random_bits(r) & 0xffffu;
    in->q = (unsigned)field_random_bits(r) & 0xffffu;
    in->keep = field_random_bits(r);
}

/* The same bits; which NaN is left open. */
static bool same_double(double x, double y) {
    return (isnan(x) && isnan(y)) || memcmp(&x, &y, sizeof x) == 0;
}

static bool same_float(float x, float y) {
    return (isnan(x) && isnan(y)) || memcmp(&x, &y, sizeof x) == 0;
}

static void compare(const char *isa, const simd_probe_input *in, const simd_probe_output *got,
                    const simd_probe_output *meant) {
    for (int word = 0; word < PROBE_WORDS; word++) {
        for (int i = 0; i < SIMD_PROBE_D; i++)
            if (!same_double(got->d[word][i], meant->d[word][i]))
                fail_msg("%s: word %d of doubles, lane %d: %a, not %a (%a, %a)", isa, word, i,
                         got->d[word][i], meant->d[word][i], in->a[i], in->b[i]);
        for (int i = 0; i < SIMD_PROBE_F; i++)
            if (!same_float(got->f[word][i], meant->f[word][i]))
                fail_msg("%s: word %d of floats, lane %d: %a, not %a (%a, %a)", isa, word, i,
                         (double)got->f[word][i], (double)meant->f[word][i], (double)in->x[i],
                         (double)in->y[i]);
    }
    for (int mask = 0; mask < PROBE_MASKS; mask++)
        if (got->d_mask[mask] != meant->d_mask[mask] || got->f_mask[mask] != meant->f_mask[mask])
            fail_msg("%s: mask %d: %x and %x, not %x and %x", isa, mask, got->d_mask[mask],
                     got->f_mask[mask], meant->d_mask[mask], meant->f_mask[mask]);
    for (int i = 0; i < got->floats; i++) {
        const double x = (double)in->x[i], r = (double)got->reciprocal[i];
        if (fabs(x) > 1e-3 && fabs(x) < 1e3)
            assert_true(fabs(r * x - 1) <= 0x1p-22);
    }
}

static void every_word_means_the_same(void **state) {
    (void)state;
    print_message("# up to %s\n", cpu_isa_name(cpu_best()));
    if (cpu_best() == CPU_SCALAR)
        skip();
    for (int isa = CPU_SCALAR + 1; isa <= (int)cpu_best(); isa++) {
        field_random r = {SEED};
        for (int n = 0; n < ROUNDS; n++) {
            simd_probe_input in;
            simd_probe_output got, meant;
            fill(&r, &in);
            memset(&got, 0, sizeof got);
            simd_probe_run((cpu_isa)isa, &in, &got);
            assert_true(got.doubles == 1 << isa && got.floats == 2 << isa);
            simd_probe_meant(&in, got.doubles, got.floats, &meant);
            compare(cpu_isa_name((cpu_isa)isa), &in, &got, &meant);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_word_means_the_same)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
