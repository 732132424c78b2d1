#include "tests/support/interests.h"

#include <math.h>
#include <stdio.h>

void interests_of_isovalues(interests *set, const double isovalues[], int count) {
    set->count = count;
    for (int i = 0; i < count; i++)
        set->raw[i] = (interest_interval){isovalues[i], isovalues[i], false, true};
    set->in = interest_of_isovalues(isovalues, count);
}

void interests_of_all(interests *set) {
    set->count = 1;
    set->raw[0] = (interest_interval){-(double)INFINITY, (double)INFINITY, false, false};
    set->in = interest_of_all();
}

static double random_end(field_random *r, const double values[], int count) {
    const double v = values[field_random_below(r, count)];
    switch (field_random_below(r, 4)) {
    case 0: return nextafter(v, field_random_below(r, 2) ? (double)INFINITY : -(double)INFINITY);
    case 1: return v + 0.5 * (values[field_random_below(r, count)] - v);
    default: return v;
    }
}

static interest_interval random_interval(field_random *r, const double values[], int count) {
    const double a = random_end(r, values, count), b = random_end(r, values, count);
    const long kind = field_random_below(r, 8);
    interest_interval i = {fmin(a, b), fmax(a, b), field_random_below(r, 2),
                           field_random_below(r, 2)};
    if (kind < 3)
        return (interest_interval){a, a, false, kind < 2};
    if (kind == 3)
        i.lo = -(double)INFINITY;
    if (kind == 4)
        i.hi = (double)INFINITY;
    if (i.lo == i.hi)
        i.lo_open = false;
    return i;
}

void interests_random(interests *set, field_random *r, const double values[], int count) {
    const long few = field_random_below(r, 3);
    set->count = 1 + (int)field_random_below(r, few == 0 ? 1 : few == 1 ? 10 : INTEREST_MAX);
    for (int i = 0; i < set->count; i++)
        set->raw[i] = random_interval(r, values, count);
    set->in = interest_of_intervals(set->raw, set->count);
}

static bool meets(const interest_interval *a, double min, double max) {
    if (a->lo == a->hi && a->hi_open)
        return min < a->lo && a->lo <= max;
    const double lo = fmax(a->lo, min), hi = fmin(a->hi, max);
    if (lo < hi)
        return true;
    return lo == hi && !(a->lo_open && lo == a->lo) && !(a->hi_open && hi == a->hi);
}

bool interests_meet(const interests *set, double min, double max) {
    bool any = false;
    for (int i = 0; i < set->count; i++)
        any |= meets(&set->raw[i], min, max);
    return any;
}

const char *interests_name(const interests *set) {
    static char text[256];
    size_t n = 0;
    text[0] = '\0';
    for (int i = 0; i < set->count && n < sizeof text - 80; i++) {
        const interest_interval *a = &set->raw[i];
        n += (size_t)snprintf(text + n, sizeof text - n, "%c%.17g, %.17g%c ",
                              a->lo_open ? '(' : '[', a->lo, a->hi, a->hi_open ? ')' : ']');
    }
    if (n >= sizeof text - 80)
        snprintf(text + n, sizeof text - n, "... %d in all", set->count);
    return text;
}
