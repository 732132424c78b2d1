/* test_exact_sign.c - exact signs against whole numbers of any size, from the definition. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/exact.h"
#include "tests/support/fields.h"

/* ---- whole numbers, as slow as they are plain ------------------------------------------------ */

enum { DIGITS = 420, UNIT = -1074 }; /* of 16 bits; unit of a double: 2^UNIT */

typedef struct big {
    bool negative;
    int n; /* digits in use; 0 is 0 */
    uint16_t digit[DIGITS];
} big;

static void trim(big *a) {
    while (a->n > 0 && a->digit[a->n - 1] == 0)
        a->n--;
}

static big big_of(double x) {
    big r = {.negative = x < 0.0};
    int e;
    uint64_t m = (uint64_t)ldexp(frexp(fabs(x), &e), 53);
    for (e -= 53 + UNIT; e < 0; e++)
        m /= 2; /* a denormal: its lowest bits are 0 */
    for (int bit = 0; bit < 53; bit++)
        if (m >> bit & 1)
            r.digit[(bit + e) / 16] |= (uint16_t)(1u << (bit + e) % 16);
    r.n = (53 + e) / 16 + 1;
    trim(&r);
    return r;
}

static int compare_sizes(const big *a, const big *b) {
    if (a->n != b->n)
        return a->n < b->n ? -1 : 1;
    for (int i = a->n - 1; i >= 0; i--)
        if (a->digit[i] != b->digit[i])
            return a->digit[i] < b->digit[i] ? -1 : 1;
    return 0;
}

static big sum_of(big a, big b) {
    if (compare_sizes(&a, &b) < 0) {
        const big c = a;
        a = b;
        b = c;
    }
    const int sign = a.negative == b.negative ? 1 : -1;
    int carry = 0;
    for (int i = 0; i < a.n || carry; i++) {
        const int v = a.digit[i] + sign * (i < b.n ? b.digit[i] : 0) + carry;
        a.digit[i] = (uint16_t)v;
        carry = v < 0 ? -1 : v >> 16;
        a.n = i >= a.n ? i + 1 : a.n;
    }
    trim(&a);
    return a;
}

static big difference_of(big a, big b) {
    b.negative = !b.negative;
    return sum_of(a, b);
}

static big product_of(const big *a, const big *b) {
    big r = {.negative = a->negative != b->negative, .n = a->n + b->n};
    for (int i = 0; i < a->n; i++) {
        uint32_t carry = 0;
        for (int j = 0; j < b->n || carry; j++) {
            carry += r.digit[i + j] + (j < b->n ? (uint32_t)a->digit[i] * b->digit[j] : 0);
            r.digit[i + j] = (uint16_t)carry;
            carry >>= 16;
        }
    }
    trim(&r);
    return r;
}

static int sign_of_big(const big *a) {
    return a->n == 0 ? 0 : a->negative ? -1 : 1;
}

/* Of a product of three doubles' units. */
static long double value_of_big(const big *a) {
    long double v = 0.0L;
    for (int i = a->n - 1; i >= 0 && i >= a->n - 6; i--)
        v = v * 65536.0L + (long double)a->digit[i];
    v = ldexpl(v, 16 * (a->n > 6 ? a->n - 6 : 0) + 3 * UNIT);
    return a->negative ? -v : v;
}

static big determinant_of(const big a[3], const big b[3], const big c[3]) {
    big r = {.n = 0};
    for (int x = 0; x < 3; x++) {
        const int y = (x + 1) % 3, z = (x + 2) % 3;
        const big up = product_of(&b[y], &c[z]), down = product_of(&b[z], &c[y]);
        const big turn = difference_of(up, down);
        r = sum_of(r, product_of(&a[x], &turn));
    }
    return r;
}

/* By the definition: d . ((P - o) x (Q - o)). */
static big truth_of(const double o[3], const double d[3], const double p[3], const double q[3]) {
    big wd[3], wp[3], wq[3];
    for (int k = 0; k < 3; k++) {
        const big wo = big_of(o[k]);
        wd[k] = big_of(d[k]);
        wp[k] = difference_of(big_of(p[k]), wo);
        wq[k] = difference_of(big_of(q[k]), wo);
    }
    return determinant_of(wd, wp, wq);
}

/* ---- the cases ------------------------------------------------------------------------------- */

enum { SEED = 41, COUNT = 1500 };

static field_random dice;

static double uniform(void) {
    return field_random_in(&dice, -1.0, 1.0);
}

static int below(int n) {
    return (int)field_random_below(&dice, n);
}

typedef struct edge_case {
    double o[3], d[3], p[3], q[3];
} edge_case;

/* Of any size, down to denormals and up to the largest. */
static double wild(void) {
    for (;;) {
        const uint64_t bits = field_random_bits(&dice);
        double x;
        memcpy(&x, &bits, sizeof x);
        if (isfinite(x))
            return below(8) == 0 ? 0.0 : below(16) == 0 ? copysign(DBL_TRUE_MIN, x) : x;
    }
}

static edge_case make(const char *kind) {
    edge_case c;
    for (int k = 0; k < 3; k++) {
        const bool lattice = strcmp(kind, "lattice") == 0;
        const int m = 1 << below(30);
        c.o[k] = lattice ? below(9) - 4 : uniform() * 10.0;
        c.p[k] = lattice ? below(9) - 4 : uniform();
        c.q[k] = lattice ? below(9) - 4 : uniform();
        c.d[k] = lattice ? below(5) - 2 : uniform();
        if (strcmp(kind, "sizes") == 0)
            c.p[k] *= m, c.q[k] /= m, c.d[k] *= m;
        if (strcmp(kind, "far") == 0)
            c.p[k] = 1e6 + c.p[k] * 1e-3, c.q[k] = c.p[k] + uniform() * 1e-5;
        if (strcmp(kind, "wild") == 0)
            c.o[k] = wild(), c.d[k] = wild(), c.p[k] = wild(), c.q[k] = wild();
    }
    const double s = strcmp(kind, "lattice") == 0 ? below(3) : 0.5 + 0.5 * uniform();
    if (strcmp(kind, "through") == 0 || strcmp(kind, "far") == 0 ||
        (strcmp(kind, "lattice") == 0 && below(2)))
        for (int k = 0; k < 3; k++)
            c.d[k] = (1.0 - s) * (c.p[k] - c.o[k]) + s * (c.q[k] - c.o[k]);
    return c;
}

static int sign_of(double x) {
    return (x > 0.0) - (x < 0.0);
}

/* The filter first, as the kernel does it. */
static exact_estimate filtered(const double o[3], const double d[3], const double p[3],
                               const double q[3]) {
    double a[3], e[3];
    for (int k = 0; k < 3; k++) {
        a[k] = p[k] - o[k];
        e[k] = q[k] - p[k];
    }
    const exact_estimate near = exact_near(d, a, e);
    return fabs(near.value) > near.bound ? near : exact_edge(o, d, p, q);
}

static void check_case(const edge_case *c, const char *kind, int i, int counts[4]) {
    const big truth = truth_of(c->o, c->d, c->p, c->q);
    const int sign = sign_of_big(&truth);
    const exact_estimate w = filtered(c->o, c->d, c->p, c->q);
    const exact_estimate back = filtered(c->o, c->d, c->q, c->p);
    const exact_estimate exact = exact_edge(c->o, c->d, c->p, c->q);
    double a[3], e[3];
    for (int k = 0; k < 3; k++) {
        a[k] = c->p[k] - c->o[k];
        e[k] = c->q[k] - c->p[k];
    }
    const exact_estimate near = exact_near(c->d, a, e);
    const bool sure = fabs(near.value) > near.bound;
    const bool promised = fabs(c->d[0] * 0x1p-299) < 1.0 && fabs(c->d[1] * 0x1p-299) < 1.0 &&
                          fabs(c->d[2] * 0x1p-299) < 1.0;
    const long double v = value_of_big(&truth);
    const bool ordinary = fabsl(v) < 1e300L && (fabsl(v) > 1e-200L || sign == 0);
    bool good =
        sign_of(exact.value) == sign && exact.value == -exact_edge(c->o, c->d, c->q, c->p).value;
    if (promised)
        good = good && sign_of(w.value) == sign && sign_of(back.value) == -sign &&
               (!sure || sign_of(near.value) == sign);
    if (ordinary)
        good = good && fabsl((long double)exact.value - v) <= (long double)exact.bound;
    if (ordinary && promised && isfinite(near.bound))
        good = good && fabsl((long double)near.value - v) <= (long double)near.bound;
    if (!good)
        fail_msg("%s %d (seed %d): sign %d, not %d; %a, %a, %Lg", kind, i, SEED, sign,
                 sign_of(w.value), w.value, exact.value, v);
    counts[sign + 1]++;
    counts[3] += !sure;
}

/* Each kind asks for what it is there for: signs of both kinds, zeros, doubts. */
static void check_kind(const char *kind, int zeros, int doubts) {
    int counts[4] = {0};
    dice.state = SEED;
    for (int i = 0; i < COUNT; i++) {
        const edge_case c = make(kind);
        check_case(&c, kind, i, counts);
    }
    print_message("%s: %d -, %d 0, %d +, %d doubtful\n", kind, counts[0], counts[1], counts[2],
                  counts[3]);
    assert_true(counts[0] > COUNT / 10 && counts[2] > COUNT / 10);
    assert_true(counts[1] >= zeros && counts[3] >= doubts);
}

static void ordinary_rays(void **test) {
    (void)test;
    check_kind("ordinary", 0, 0);
    check_kind("sizes", 0, 0);
}

static void rays_through_the_edge(void **test) {
    (void)test;
    check_kind("through", 0, COUNT / 2);
    check_kind("far", 0, COUNT / 2);
    check_kind("lattice", COUNT / 3, COUNT / 3);
}

static void any_doubles(void **test) {
    (void)test;
    check_kind("wild", 1, COUNT / 20);
}

static void not_finite(void **test) {
    (void)test;
    const double o[3] = {0.0, 0.0, 0.0}, d[3] = {0.0, 0.0, 1.0}, p[3] = {1.0, 0.0, 1.0};
    for (int k = 0; k < 2; k++) {
        const double q[3] = {0.0, k ? (double)INFINITY : (double)NAN, 1.0};
        assert_true(exact_edge(o, d, p, q).value == 0.0);
        assert_true(exact_edge(q, d, p, o).value == 0.0);
    }
}

static int sign_of_tet(const float a[3], const float b[3], const float c[3], const float d[3]) {
    double p[4][3];
    for (int k = 0; k < 3; k++) {
        p[0][k] = (double)a[k];
        p[1][k] = (double)b[k];
        p[2][k] = (double)c[k];
        p[3][k] = (double)d[k];
    }
    return exact_orientation((const double(*)[3])p);
}

static void orientation(void **test) {
    (void)test;
    int flat = 0;
    dice.state = SEED;
    for (int i = 0; i < 4 * COUNT; i++) {
        float p[4][3];
        big w[3][3];
        const int how = i % 4;
        for (int v = 0; v < 4; v++)
            for (int k = 0; k < 3; k++)
                p[v][k] = how == 0   ? (float)(below(3) + 1000000)
                          : how == 1 ? (float)ldexp(uniform(), below(250) - 140)
                                     : (float)(1e3 + uniform() * 1e-3);
        if (how == 3) /* as flat as floats can say */
            for (int k = 0; k < 3; k++)
                p[3][k] = (float)(0.25 * (double)p[0][k] + 0.25 * (double)p[1][k] +
                                  0.5 * (double)p[2][k]);
        for (int v = 0; v < 3; v++)
            for (int k = 0; k < 3; k++)
                w[v][k] = difference_of(big_of((double)p[v + 1][k]), big_of((double)p[0][k]));
        const big truth = determinant_of(w[0], w[1], w[2]);
        const int sign = sign_of_big(&truth);
        if (sign_of_tet(p[0], p[1], p[2], p[3]) != sign ||
            sign_of_tet(p[1], p[0], p[2], p[3]) != -sign)
            fail_msg("tet %d (seed %d): sign is %d", i, SEED, sign);
        flat += sign == 0;
    }
    assert_in_range(flat, COUNT / 10, 3 * COUNT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ordinary_rays), cmocka_unit_test(rays_through_the_edge),
        cmocka_unit_test(any_doubles),   cmocka_unit_test(not_finite),
        cmocka_unit_test(orientation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
