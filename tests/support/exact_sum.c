#include "tests/support/exact_sum.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* A product's lowest bit weighs no less than 2^(3 * -1074). */
enum { LOWEST = -32 * 102, HALF_BITS = 27 };

/* x = mantissa * 2^exponent, the mantissa an integer below 2^53. */
static uint64_t integer_part(double x, int *exponent) {
    double m = ldexp(frexp(fabs(x), exponent), 53);
    *exponent -= 53;
    /* Subnormals: no bit below 2^-1074. */
    if (*exponent < -1074) {
        m = ldexp(m, *exponent + 1074);
        *exponent = -1074;
    }
    return (uint64_t)m;
}

void exact_sum_clear(exact_sum *s) {
    memset(s, 0, sizeof *s);
    s->first = EXACT_SUM_LIMBS;
}

static void add_bits(exact_sum *s, unsigned __int128 bits, int place, bool negative) {
    int at = place / 32;
    s->first = at < s->first ? at : s->first;
    for (bits <<= place % 32; bits; bits >>= 32) {
        int64_t part = (int64_t)(bits & 0xffffffff);
        s->limb[at++] += negative ? -part : part;
    }
    s->end = at > s->end ? at : s->end;
}

void exact_sum_add(exact_sum *s, double a, double b, double c) {
    if (a == 0 || b == 0 || c == 0)
        return;
    int ea, eb, ec;
    const uint64_t low = (UINT64_C(1) << HALF_BITS) - 1;
    uint64_t ma = integer_part(a, &ea), mb = integer_part(b, &eb), mc = integer_part(c, &ec);
    bool negative = (a < 0) ^ (b < 0) ^ (c < 0);
    /* Eight products of halves, 81 bits each. */
    for (int n = 0; n < 8; n++) {
        uint64_t ha = n & 1 ? ma >> HALF_BITS : ma & low;
        uint64_t hb = n & 2 ? mb >> HALF_BITS : mb & low;
        uint64_t hc = n & 4 ? mc >> HALF_BITS : mc & low;
        int halves = (n & 1) + (n >> 1 & 1) + (n >> 2);
        if (!ha || !hb || !hc)
            continue;
        add_bits(s, (unsigned __int128)(ha * hb) * hc, ea + eb + ec - LOWEST + HALF_BITS * halves,
                 negative);
    }
}

/* Limbs below 2^32 each; the carry out of the last one is 0, or -1: the sum is negative. */
static int64_t pass_carries(exact_sum *s) {
    int64_t carry = 0;
    for (int i = s->first; i < s->end; i++) {
        int64_t x = s->limb[i] + carry;
        s->limb[i] = x & 0xffffffff;
        carry = (x - s->limb[i]) / (INT64_C(1) << 32);
    }
    return carry;
}

long double exact_sum_value(exact_sum *s) {
    s->end += s->end > 0 && s->end < EXACT_SUM_LIMBS; /* where the last carry goes */
    bool negative = pass_carries(s) < 0;
    if (negative) {
        for (int i = s->first; i < s->end; i++)
            s->limb[i] = -s->limb[i];
        pass_carries(s);
    }
    int top = s->end - 1;
    while (top >= s->first && s->limb[top] == 0)
        top--;
    long double value = 0;
    for (int i = top; i >= s->first && i > top - 4; i--)
        value += ldexpl((long double)s->limb[i], 32 * i + LOWEST);
    return negative ? -value : value;
}

long double exact_sum_volume(const double a[3], const double b[3], const double c[3],
                             const double p[3]) {
    /* The rows a - p, b - p, c - p, multiplied out: no difference is rounded. */
    static const int ORDER[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                    {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    exact_sum sum;
    exact_sum_clear(&sum);
    for (int n = 0; n < 6; n++) {
        const int x = ORDER[n][0], y = ORDER[n][1], z = ORDER[n][2];
        const double sign = n < 3 ? 1 : -1;
        for (int pick = 0; pick < 8; pick++)
            exact_sum_add(&sum, sign * (pick & 1 ? -p[x] : a[x]), pick & 2 ? -p[y] : b[y],
                          pick & 4 ? -p[z] : c[z]);
    }
    return exact_sum_value(&sum);
}
