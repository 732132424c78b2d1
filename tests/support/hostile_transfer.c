#include "tests/support/hostile_transfer.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As far as leafcast.h allows. */
static const double VALUE_MOST = 1e300, EXTINCTION_MOST = 1e100, NARROWEST = 1e-290;

/* What is being made. */
typedef struct maker {
    const transfer_range *of;
    field_random *r;
    leafcast_transfer_point *points;
    int count;
} maker;

static double any_value(maker *m) {
    const double width = m->of->most - m->of->least;
    return field_random_in(m->r, m->of->least - 0.1 * width, m->of->most + 0.1 * width);
}

/* 10^from .. 10^to over the length of the way. */
static double extinction(maker *m, double from, double to) {
    return fmin(pow(10, field_random_in(m->r, from, to)) / m->of->length, EXTINCTION_MOST);
}

static void put(maker *m, double value, double e) {
    leafcast_transfer_point *p = &m->points[m->count++];
    *p = (leafcast_transfer_point){.value = value, .extinction = e};
    for (int c = 0; c < 3; c++)
        p->rgb[c] = field_random_unit(m->r);
}

/* Points at random values, a third of them without extinction. */
static void spread(maker *m, int count, double from, double to) {
    for (int i = 0; i < count; i++)
        put(m, any_value(m), field_random_below(m->r, 3) ? extinction(m, from, to) : 0);
}

static void smooth(maker *m) {
    spread(m, 3 + (int)field_random_below(m->r, 6), 0, 1);
}

static void opaque(maker *m) {
    spread(m, 3 + (int)field_random_below(m->r, 6), 2, 4);
}

static void thin(maker *m) {
    spread(m, 3 + (int)field_random_below(m->r, 6), -3, -1);
}

/* Windows that begin and end at once, at samples' values now and then. */
static void steps(maker *m) {
    for (int i = 0; i < 8; i++) {
        const double at = field_random_below(m->r, 2) ? any_value(m) : m->of->some[i % 4];
        put(m, at, extinction(m, -1, 1));
        put(m, at, field_random_below(m->r, 2) ? extinction(m, -1, 3) : 0);
    }
}

/* Peaks far narrower than a cell's range, as deep as wide ones. */
static void needles(maker *m) {
    for (int i = 0; i < 6; i++) {
        const double share = pow(10, field_random_in(m->r, -9, -1)),
                     half = share * (m->of->most - m->of->least), at = any_value(m);
        put(m, at - half, 0);
        put(m, at, extinction(m, 0, 2) / share);
        put(m, at + half, 0);
    }
}

/* The same where nothing can tell what is within them. */
static void splinters(maker *m) {
    for (int i = 0; i < 4; i++) {
        const double at = any_value(m);
        put(m, at, 0);
        put(m, nextafter(at, DBL_MAX), extinction(m, 3, 16));
        put(m, nextafter(nextafter(at, DBL_MAX), DBL_MAX), 0);
    }
}

static void huge(maker *m) {
    spread(m, 4, 6, 100);
}

static void denormal(maker *m) {
    for (int i = 0; i < 4; i++)
        put(m, any_value(m), field_random_in(m->r, 0, 1e-310));
}

/* One colour: what is wrong then is the light that comes through. */
static void grey(maker *m) {
    spread(m, 4, 0, 4);
    for (int i = 1; i < m->count; i++)
        memcpy(m->points[i].rgb, m->points[0].rgb, sizeof m->points[0].rgb);
}

static void nothing(maker *m) {
    spread(m, 2, -1, 1);
    for (int i = 0; i < m->count; i++)
        m->points[i].extinction = 0;
}

static void constant(maker *m) {
    put(m, any_value(m), extinction(m, -2, 2));
}

/* Some extinction everywhere, the same colour or not. */
static void positive(maker *m) {
    for (int i = 0; i < 12; i++)
        put(m, any_value(m), extinction(m, -2, 1.5));
}

static void many(maker *m) {
    while (m->count < HOSTILE_POINTS_MAX)
        put(m, any_value(m), extinction(m, -1, 2));
}

static void beyond(maker *m) {
    const double width = m->of->most - m->of->least + fabs(m->of->most) + 1;
    const double side =
        field_random_below(m->r, 2) ? m->of->most + width : m->of->least - 3 * width;
    put(m, side, extinction(m, -1, 1));
    put(m, side + width, extinction(m, -1, 1));
}

/* All between the smallest numbers and the largest. */
static void extremes(maker *m) {
    put(m, -VALUE_MOST, extinction(m, -1, 1));
    put(m, any_value(m), extinction(m, -1, 1));
    put(m, -NARROWEST, 0);
    put(m, 0.0, extinction(m, -1, 1));
    put(m, VALUE_MOST, extinction(m, -1, 1));
}

/* Down to nothing from far away, where it is as much more. */
static void leaning(maker *m) {
    const double width = m->of->most - m->of->least, at = any_value(m),
                 share = pow(10, field_random_in(m->r, 2, 14));
    put(m, at - fmin(share * width, VALUE_MOST), extinction(m, 0, 2) * share);
    put(m, at, 0);
    put(m, at + fmin(share * width, VALUE_MOST), extinction(m, 0, 2) * share);
}

static const struct {
    const char *name;
    void (*make)(maker *m);
} kinds[] = {
    {"smooth", smooth},     {"opaque", opaque},       {"thin", thin},       {"steps", steps},
    {"needles", needles},   {"splinters", splinters}, {"huge", huge},       {"denormal", denormal},
    {"constant", constant}, {"positive", positive},   {"many", many},       {"beyond", beyond},
    {"extremes", extremes}, {"leaning", leaning},     {"nothing", nothing}, {"grey", grey},
};

int hostile_transfer_kinds(void) {
    return (int)(sizeof kinds / sizeof kinds[0]);
}

const char *hostile_transfer_name(int kind) {
    return kinds[kind].name;
}

/* Insertion: points of one value keep their order. */
static void sort(leafcast_transfer_point *p, int count) {
    for (int i = 1; i < count; i++)
        for (int k = i; k > 0 && p[k].value < p[k - 1].value; k--) {
            const leafcast_transfer_point swap = p[k];
            p[k] = p[k - 1];
            p[k - 1] = swap;
        }
}

int hostile_transfer(int kind, const transfer_range *of, field_random *r,
                     leafcast_transfer_point points[HOSTILE_POINTS_MAX]) {
    maker m = {of, r, points, 0};
    kinds[kind].make(&m);
    sort(points, m.count);
    return m.count;
}

transfer_range transfer_range_of(const float *samples, size_t count, double length,
                                 field_random *r) {
    transfer_range of = {INFINITY, -INFINITY, length, {0}};
    for (size_t i = 0; i < count; i++)
        if (isfinite(samples[i])) {
            of.least = fmin(of.least, (double)samples[i]);
            of.most = fmax(of.most, (double)samples[i]);
        }
    /* Of one value alone, about it. */
    if (!(of.least < of.most)) {
        of.least -= 1.0;
        of.most += 1.0;
    }
    for (int i = 0; i < 4; i++)
        do
            of.some[i] = (double)samples[field_random_below(r, (long)count)];
        while (!isfinite(of.some[i]));
    return of;
}
