/* Two-sums, Dekker's products, and merging by size with zeros left out: Shewchuk's
 * FAST-EXPANSION-SUM and SCALE-EXPANSION (Adaptive Precision Floating-Point Arithmetic, 1997). */
#include "formats/base/expansion.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>

typedef struct pair {
    double high, low; /* the sum is exact */
} pair;

static pair two_sum(double a, double b) {
    const double sum = a + b, other = sum - a;
    return (pair){sum, (a - (sum - other)) + (b - other)};
}

static pair split(double a) {
    const double large = 134217729.0 * a; /* 2^27 + 1 */
    const double high = large - (large - a);
    return (pair){high, a - high};
}

static pair two_product(double a, double b) {
    const pair s = split(a), t = split(b);
    const double product = a * b;
    const double rest = ((product - s.high * t.high) - s.low * t.high) - s.high * t.low;
    return (pair){product, s.low * t.low - rest};
}

static void put(expansion *e, double term) {
    if (term == 0)
        return;
    assert(e->terms < EXPANSION_MAX);
    e->term[e->terms++] = term;
}

void expansion_difference(expansion *e, double a, double b) {
    const pair d = two_sum(a, -b);
    e->terms = 0;
    put(e, d.low);
    put(e, d.high);
}

/* Terms of both by size, each summed into what runs along. */
static void merge(expansion *to, const expansion *x, double sign) {
    double own[EXPANSION_MAX];
    const int terms = to->terms;
    for (int i = 0; i < terms; i++)
        own[i] = to->term[i];
    double run = 0;
    to->terms = 0;
    for (int i = 0, k = 0; i < terms || k < x->terms;) {
        const bool first = k == x->terms || (i < terms && fabs(own[i]) <= fabs(x->term[k]));
        const pair s = two_sum(run, first ? own[i++] : sign * x->term[k++]);
        put(to, s.low);
        run = s.high;
    }
    put(to, run);
}

void expansion_add(expansion *to, const expansion *x) {
    merge(to, x, 1);
}

void expansion_subtract(expansion *to, const expansion *x) {
    merge(to, x, -1);
}

static void scale(expansion *e, const expansion *a, double b) {
    e->terms = 0;
    if (a->terms == 0)
        return;
    pair product = two_product(a->term[0], b);
    put(e, product.low);
    double run = product.high;
    for (int i = 1; i < a->terms; i++) {
        product = two_product(a->term[i], b);
        const pair s = two_sum(run, product.low);
        put(e, s.low);
        const pair t = two_sum(product.high, s.high);
        put(e, t.low);
        run = t.high;
    }
    put(e, run);
}

void expansion_multiply(expansion *e, const expansion *a, const expansion *b) {
    expansion part;
    e->terms = 0;
    for (int i = 0; i < b->terms; i++) {
        scale(&part, a, b->term[i]);
        expansion_add(e, &part);
    }
}

double expansion_value(const expansion *e) {
    double sum = 0;
    for (int i = 0; i < e->terms; i++)
        sum += e->term[i];
    return sum;
}
