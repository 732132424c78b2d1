#include "stream/interest.h"

#include <assert.h>
#include <math.h>

/* Returns the least float greater than v. */
static float above(double v) {
    const float f = (float)v;
    return (double)f <= v ? nextafterf(f, INFINITY) : f;
}

static value_limits limits_of(const interest_interval *a) {
    return (value_limits){.reach = a->lo_open ? above(a->lo) : value_limits_threshold(a->lo),
                          .beyond = a->hi_open ? value_limits_threshold(a->hi) : above(a->hi)};
}

/* ---- Normalising ---- */

static bool begins_before(const interest_interval *a, const interest_interval *b) {
    return a->lo != b->lo ? a->lo < b->lo : a->lo_open < b->lo_open;
}

static bool ends_before(const interest_interval *a, const interest_interval *b) {
    return a->hi != b->hi ? a->hi < b->hi : a->hi_open > b->hi_open;
}

/* Order by begin; of equal begins, the longest first. */
static bool sorts_before(const interest_interval *a, const interest_interval *b) {
    return begins_before(a, b) || (!begins_before(b, a) && ends_before(b, a));
}

/* Returns whether a and b form one interval. a is sorted before b and does not imply b. Never true
 * of an isovalue: an interval that could absorb it implies it, and is sorted before it. */
static bool joined(const interest_interval *a, const interest_interval *b) {
    return b->lo < a->hi || (b->lo == a->hi && !(a->hi_open && b->lo_open));
}

static void sort(interest_interval *of, int count) {
    for (int i = 1; i < count; i++) {
        const interest_interval a = of[i];
        int k = i;
        for (; k > 0 && sorts_before(&a, &of[k - 1]); k--)
            of[k] = of[k - 1];
        of[k] = a;
    }
}

interest interest_of_intervals(const interest_interval of[], int count) {
    interest_interval sorted[INTEREST_MAX];
    interest in = {.count = 0};
    assert(count >= 0 && count <= INTEREST_MAX);
    for (int i = 0; i < count; i++) {
        assert(of[i].lo < of[i].hi || (of[i].lo == of[i].hi && !of[i].lo_open));
        sorted[i] = of[i];
    }
    sort(sorted, count);
    for (int i = 0; i < count; i++) {
        /* Compare with the last interval only: nothing lies between it and what it implies or
         * joins. */
        interest_interval *last = in.count ? &in.of[in.count - 1] : NULL;
        if (last && !ends_before(last, &sorted[i]))
            continue;
        if (last && joined(last, &sorted[i])) {
            last->hi = sorted[i].hi;
            last->hi_open = sorted[i].hi_open;
        } else {
            in.of[in.count++] = sorted[i];
        }
    }
    for (int i = 0; i < in.count; i++)
        in.limits[i] = limits_of(&in.of[i]);
    return in;
}

interest interest_of_isovalues(const double isovalues[], int count) {
    interest_interval of[INTEREST_MAX];
    assert(count >= 0 && count <= INTEREST_MAX);
    for (int i = 0; i < count; i++)
        of[i] = (interest_interval){.lo = isovalues[i], .hi = isovalues[i], .hi_open = true};
    return interest_of_intervals(of, count);
}

interest interest_of_all(void) {
    const interest_interval all = {.lo = -(double)INFINITY, .hi = (double)INFINITY};
    return interest_of_intervals(&all, 1);
}

/* ---- Asking ---- */

bool interest_same(const interest *a, const interest *b) {
    bool same = a->count == b->count && homogeneous_same(&a->whole, &b->whole);
    for (int i = 0; same && i < a->count; i++) {
        const interest_interval *x = &a->of[i], *y = &b->of[i];
        same = x->lo == y->lo && x->hi == y->hi && x->lo_open == y->lo_open &&
               x->hi_open == y->hi_open;
    }
    return same;
}

bool interest_meets(const interest *in, float min, float max) {
    for (int i = 0; i < in->count; i++)
        if (value_limits_meet(&in->limits[i], min, max))
            return true;
    return false;
}

void interest_within(interest_part *part, const interest *in, const quantizer *q) {
    part->count = 0;
    for (int i = 0; i < in->count; i++) {
        const value_limits at = in->limits[i];
        const quantized_limits codes = quantizer_limits(q, (double)at.reach, (double)at.beyond);
        part->limits[part->count] = at;
        part->codes[part->count] = codes;
        part->count += codes.below >= 0;
    }
}
