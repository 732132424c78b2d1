#include "formats/base/exact.h"

#include <float.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* A finite double as +-m 2^e. */
typedef struct whole {
    uint32_t m[2]; /* low, high: 32 + 21 bits; 0, 0 for zero */
    int e;
    bool negative;
} whole;

/* One term of a sum: the product of three doubles. */
typedef struct triple {
    uint32_t m[5]; /* 3 x 53 = 159 bits, lowest first */
    int e;
    bool negative;
} triple;

enum {
    TERMS = 24, /* most terms of a sum */
    /* Exponents of a product range from 3 x -1074 to 3 x 971. Above the highest come 159 bits, and
     * the carries of 24 terms. */
    LIMBS = (3 * (1074 + 971) + 159 + 5) / 32 + 3,
};

/* A sum of triples. Limb k counts 2^(32 k + e). Limbs stay unnormalised while terms are added. Each
 * term adds less than 2^32 to a limb, so 64 bits suffice for far more terms than there are. */
typedef struct sum {
    triple term[TERMS];
    int terms;
    int e, limbs;
    int64_t limb[LIMBS];
} sum;

static whole whole_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const int field = (int)(bits >> 52 & 0x7ff);
    uint64_t m = bits & ((UINT64_C(1) << 52) - 1);
    if (field > 0)
        m |= UINT64_C(1) << 52;
    return (whole){
        {(uint32_t)m, (uint32_t)(m >> 32)}, (field > 0 ? field : 1) - 1075, bits >> 63 != 0};
}

static bool is_zero(const whole *a) {
    return (a->m[0] | a->m[1]) == 0;
}

/* to[0 .. n] = to[0 .. n - 1] + a[0 .. n - 1] x b. */
static void multiply_add(uint32_t *to, const uint32_t *a, int n, uint32_t b) {
    uint64_t carry = 0;
    for (int i = 0; i < n; i++) {
        carry += (uint64_t)a[i] * b + to[i];
        to[i] = (uint32_t)carry;
        carry >>= 32;
    }
    to[n] = (uint32_t)carry;
}

static void add_term(sum *s, const whole *a, const whole *b, const whole *c, bool negative) {
    if (is_zero(a) || is_zero(b) || is_zero(c))
        return;
    uint32_t ab[4] = {0}, abc[6] = {0};
    multiply_add(ab, a->m, 2, b->m[0]);
    multiply_add(ab + 1, a->m, 2, b->m[1]);
    multiply_add(abc, ab, 4, c->m[0]);
    multiply_add(abc + 1, ab, 4, c->m[1]); /* the sixth limb stays 0 */
    triple *t = &s->term[s->terms++];
    memcpy(t->m, abc, sizeof t->m);
    t->e = a->e + b->e + c->e;
    t->negative = negative ^ a->negative ^ b->negative ^ c->negative;
}

/* Add a . (b x c) to the sum, or subtract it. */
static void add_determinant(sum *s, const whole a[3], const whole b[3], const whole c[3],
                            bool negative) {
    for (int x = 0; x < 3; x++) {
        const int y = (x + 1) % 3, z = (x + 2) % 3;
        add_term(s, &a[x], &b[y], &c[z], negative);
        add_term(s, &a[x], &b[z], &c[y], !negative);
    }
}

static void add_up(sum *s) {
    int highest = s->term[0].e;
    s->e = s->term[0].e;
    for (int i = 1; i < s->terms; i++) {
        s->e = s->term[i].e < s->e ? s->term[i].e : s->e;
        highest = s->term[i].e > highest ? s->term[i].e : highest;
    }
    s->limbs = (highest - s->e) / 32 + 7; /* five, one for the shift, one for carries */
    memset(s->limb, 0, (size_t)s->limbs * sizeof s->limb[0]);
    for (int i = 0; i < s->terms; i++) {
        const triple *t = &s->term[i];
        const int shift = t->e - s->e;
        int64_t *to = s->limb + shift / 32;
        uint64_t wide = 0;
        for (int k = 0; k < 6; k++) {
            wide |= (k < 5 ? (uint64_t)t->m[k] : 0) << shift % 32;
            const int64_t part = (int64_t)(wide & UINT32_MAX);
            to[k] += t->negative ? -part : part;
            wide >>= 32;
        }
    }
}

/* Normalise the limbs to 0 .. 2^32 - 1. Returns the carry out of the top: negative where the sum
 * is. */
static int64_t carry_over(sum *s) {
    int64_t carry = 0;
    for (int k = 0; k < s->limbs; k++) {
        carry += s->limb[k];
        s->limb[k] = (int64_t)((uint64_t)carry & UINT32_MAX);
        carry = (carry - s->limb[k]) / ((int64_t)1 << 32);
    }
    return carry;
}

/* The sum, rounded. A sum other than 0 never becomes 0 or infinite. */
static double value_of(sum *s) {
    if (s->terms == 0)
        return 0.0;
    add_up(s);
    const bool negative = carry_over(s) < 0;
    if (negative) {
        for (int k = 0; k < s->limbs; k++)
            s->limb[k] = -s->limb[k];
        carry_over(s);
    }
    int top = s->limbs - 1;
    while (top >= 0 && s->limb[top] == 0)
        top--;
    if (top < 0)
        return 0.0;
    /* Three limbs hold 65 significant bits or more. */
    double value = 0.0;
    for (int k = top; k > top - 3; k--)
        value = value * 0x1p32 + (k >= 0 ? (double)s->limb[k] : 0.0);
    value = ldexp(value, s->e + 32 * (top - 2));
    value = value > DBL_MAX ? DBL_MAX : value > 0.0 ? value : DBL_TRUE_MIN;
    return negative ? -value : value;
}

/* Convert three doubles; false: not all are finite. */
static bool wholes_of(const double v[3], whole out[3]) {
    for (int a = 0; a < 3; a++) {
        if (!isfinite(v[a]))
            return false;
        out[a] = whole_of(v[a]);
    }
    return true;
}

/* E = d . (P x Q) - d . (P x o) - d . (o x Q): this needs no difference of arguments. */
exact_estimate exact_edge(const double o[3], const double d[3], const double p[3],
                          const double q[3]) {
    if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
        return (exact_estimate){0.0, 0.0}; /* common: surfaces through vertices give many such
                                              edges */
    whole wo[3], wd[3], wp[3], wq[3];
    if (!wholes_of(o, wo) || !wholes_of(d, wd) || !wholes_of(p, wp) || !wholes_of(q, wq))
        return (exact_estimate){0.0, 0.0};
    sum s;
    s.terms = 0;
    add_determinant(&s, wd, wp, wq, false);
    add_determinant(&s, wd, wp, wo, true);
    add_determinant(&s, wd, wo, wq, true);
    const double value = value_of(&s);
    return (exact_estimate){value, 2.0 * DBL_EPSILON * fabs(value)};
}

/* The edges from point 0 to the other three. False: some difference is not exact in doubles. */
static bool edges_of(const double (*p)[3], double e[3][3]) {
    bool exact = true;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const double a = p[i + 1][k], b = -p[0][k];
            const double edge = a + b, other = edge - a; /* a two-sum */
            e[i][k] = edge;
            exact &= (a - (edge - other)) + (b - other) == 0.0;
        }
    return exact;
}

/* Compute one determinant of edges, or four of points: [b c d] - [a c d] + [a b d] - [a b c]. */
double exact_volume(const double (*p)[3]) {
    double e[3][3];
    const bool exact = edges_of(p, e);
    const int rows = exact ? 3 : 4;
    whole w[4][3];
    for (int i = 0; i < rows; i++)
        if (!wholes_of(exact ? e[i] : p[i], w[i]))
            return 0.0;
    sum s;
    s.terms = 0;
    if (exact) {
        add_determinant(&s, w[0], w[1], w[2], false);
    } else {
        add_determinant(&s, w[1], w[2], w[3], false);
        add_determinant(&s, w[0], w[2], w[3], true);
        add_determinant(&s, w[0], w[1], w[3], false);
        add_determinant(&s, w[0], w[1], w[2], true);
    }
    return value_of(&s);
}

/* The height of a point over the plane of a tet's face, times twice the face's area: positive
 * inside, negative outside. For negative ones only the sign is right. */
static double height_over(const double p[4][3], const int face[3], int sign,
                          const double point[3]) {
    double from[3][3]; /* by axes, not by corners: the determinant is the same, and no edges are
                          needed */
    for (int a = 0; a < 3; a++)
        for (int n = 0; n < 3; n++)
            from[a][n] = p[face[n]][a] - point[a];
    const exact_estimate near = exact_near(from[2], from[0], from[1]);
    const double height = sign * near.value;
    if (height > EXACT_ENOUGH * near.bound || height < -2.0 * near.bound)
        return height;
    double tet[4][3];
    memcpy(tet[0], point, sizeof tet[0]);
    for (int n = 0; n < 3; n++)
        memcpy(tet[n + 1], p[face[n]], sizeof tet[0]);
    return sign * exact_volume((const double(*)[3])tet);
}

bool exact_weights(const double p[4][3], int sign, const double point[3], double weight[4]) {
    static const int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (int i = 0; i < 4; i++) {
        weight[i] = height_over(p, faces[i], sign, point);
        if (weight[i] < 0.0)
            return false;
    }
    return true;
}
