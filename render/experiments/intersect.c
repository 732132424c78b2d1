#include "render/experiments/intersect.h"

#include <math.h>
#include <string.h>

enum { STEPS = 3 }; /* M08: "two to three iterations" */

/* f along a visit in power form, s from 0 at the entry to 1 at the exit. */
typedef struct polynomial {
    double c[4];
} polynomial;

static bool active(const float samples[8], double iso) {
    int inside = 0;
    for (int i = 0; i < 8; i++)
        inside += (double)samples[i] >= iso;
    return inside != 0 && inside != 8;
}

/* Returns f - iso at parameter s of the visit, by seven linear interpolations. */
static double trilinear(const cell_visit *v, const float samples[8], double iso, double s) {
    double at[3], x[4], y[2];
    for (int a = 0; a < 3; a++)
        at[a] = v->in[a] + s * (v->out[a] - v->in[a]);
    for (int i = 0; i < 4; i++) {
        const double f0 = (double)samples[2 * i] - iso, f1 = (double)samples[2 * i + 1] - iso;
        x[i] = f0 + at[0] * (f1 - f0);
    }
    for (int i = 0; i < 2; i++)
        y[i] = x[2 * i] + at[1] * (x[2 * i + 1] - x[2 * i]);
    return y[0] + at[2] * (y[1] - y[0]);
}

static polynomial polynomial_of(const double b[4]) {
    return (polynomial){{b[0], 3.0 * (b[1] - b[0]), 3.0 * (b[0] - 2.0 * b[1] + b[2]),
                         b[3] - b[0] + 3.0 * (b[1] - b[2])}};
}

static double polynomial_at(const polynomial *p, double s) {
    return p->c[0] + s * (p->c[1] + s * (p->c[2] + s * p->c[3]));
}

/* Report a root at s if it comes after `after`. Returns whether it does. */
static bool report(const cell_visit *v, double s, bool entering, int32_t iso, uint64_t cell,
                   const hit *after, hit *found) {
    const hit h = {cell_root_t(v, s), cell, iso, entering};
    if (!hit_less(after, &h))
        return false;
    *found = h;
    return true;
}

static bool midpoint(const ray *r, const cell_visit *v, const float samples[8], double iso,
                     int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    (void)r;
    return active(samples, iso) && report(v, 0.5, true, iso_index, cell, after, found);
}

/* M08's algorithms 6 (steps = 0) and 7. */
static bool interpolated(int steps, const cell_visit *v, const float samples[8], double iso,
                         int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    if (!active(samples, iso))
        return false;
    double s_in = 0.0, s_out = 1.0;
    double f_in = trilinear(v, samples, iso, 0.0), f_out = trilinear(v, samples, iso, 1.0);
    const bool inside = f_in >= 0.0;
    if (inside == (f_out >= 0.0))
        return false;
    for (int i = 0; i < steps; i++) {
        const double s = s_in - (s_out - s_in) * (f_in / (f_out - f_in));
        const double f = trilinear(v, samples, iso, s);
        if ((f >= 0.0) == inside) {
            s_in = s;
            f_in = f;
        } else {
            s_out = s;
            f_out = f;
        }
    }
    return report(v, s_in - (s_out - s_in) * (f_in / (f_out - f_in)), !inside, iso_index, cell,
                  after, found);
}

static bool linear(const ray *r, const cell_visit *v, const float samples[8], double iso,
                   int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    (void)r;
    return interpolated(0, v, samples, iso, iso_index, cell, after, found);
}

static bool neubauer(const ray *r, const cell_visit *v, const float samples[8], double iso,
                     int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    (void)r;
    return interpolated(STEPS, v, samples, iso, iso_index, cell, after, found);
}

/* Find the real roots of a s^2 + b s + c, a not tiny. Returns their number. */
static int solve_quadratic(double a, double b, double c, double roots[3]) {
    const double discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0)
        return 0;
    const double root = sqrt(discriminant);
    roots[0] = (-b - root) / (2.0 * a);
    roots[1] = (-b + root) / (2.0 * a);
    return 2;
}

/* Find all real roots, in no order. As Schwarze does, drop small leading coefficients, else use
 * Cardano's formula on the depressed cubic x^3 + 3 p x + 2 q. */
static int solve_cubic(const polynomial *f, double roots[3]) {
    const double tiny = 1e-12 * (fabs(f->c[0]) + fabs(f->c[1]) + fabs(f->c[2]) + fabs(f->c[3]));
    if (fabs(f->c[3]) <= tiny && fabs(f->c[2]) <= tiny) {
        roots[0] = -f->c[0] / f->c[1];
        return fabs(f->c[1]) > tiny;
    }
    if (fabs(f->c[3]) <= tiny)
        return solve_quadratic(f->c[2], f->c[1], f->c[0], roots);

    const double b = f->c[2] / f->c[3], c = f->c[1] / f->c[3], d = f->c[0] / f->c[3];
    const double p = (c - b * b / 3.0) / 3.0;
    const double q = 0.5 * (b * (2.0 * b * b - 9.0 * c) / 27.0 + d);
    const double discriminant = q * q + p * p * p, shift = b / 3.0;
    if (discriminant > 0.0) {
        const double root = sqrt(discriminant);
        roots[0] = cbrt(root - q) - cbrt(root + q) - shift;
        return 1;
    }
    /* Three real roots, by a third of an angle. */
    static const double THIRD = 2.0943951023931953; /* 2 pi / 3 */
    const double size = sqrt(-p), cosine = size > 0.0 ? -q / (size * size * size) : 0.0;
    const double angle = acos(fmax(-1.0, fmin(1.0, cosine))) / 3.0;
    for (int i = 0; i < 3; i++)
        roots[i] = 2.0 * size * cos(angle - i * THIRD) - shift;
    return 3;
}

static void sort(double *x, int n) {
    for (int i = 1; i < n; i++)
        for (int j = i; j > 0 && x[j] < x[j - 1]; j--) {
            const double swap = x[j];
            x[j] = x[j - 1];
            x[j - 1] = swap;
        }
}

typedef struct crossing {
    double s;
    bool entering;
} crossing;

/* Find the roots in [0, 1], ascending. Returns their number. */
static int schwarze_crossings(const double b[4], crossing out[3]) {
    double roots[3];
    const polynomial f = polynomial_of(b);
    const int n = solve_cubic(&f, roots);
    int count = 0;
    sort(roots, n);
    for (int i = 0; i < n; i++) {
        const double s = roots[i];
        if (s >= 0.0 && s <= 1.0)
            out[count++] = (crossing){s, f.c[1] + s * (2.0 * f.c[2] + s * 3.0 * f.c[3]) > 0.0};
    }
    return count;
}

static bool schwarze(const ray *r, const cell_visit *v, const float samples[8], double iso,
                     int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    (void)r;
    double b[4];
    crossing at[3];
    if (!cell_cubic(v, samples, iso, b))
        return false;
    const int n = schwarze_crossings(b, at);
    for (int i = 0; i < n; i++)
        if (report(v, at[i].s, at[i].entering, iso_index, cell, after, found))
            return true;
    return false;
}

/* Split [0, 1] at the extrema into at most three parts. Sets their ends; returns their number. The
 * quadratic formula is the stable one: the printed one loses the extrema of flat cubics, and with
 * them roots. */
static int monotone_parts(const polynomial *f, double ends[4]) {
    const double a = 3.0 * f->c[3], half = f->c[2], c = f->c[1];
    const double discriminant = half * half - a * c;
    int parts = 0;
    ends[0] = 0.0;
    if (discriminant > 0.0) {
        const double w = -(half + (half >= 0.0 ? sqrt(discriminant) : -sqrt(discriminant)));
        double extrema[2] = {a != 0.0 ? w / a : -1.0, c / w};
        sort(extrema, 2);
        for (int i = 0; i < 2; i++)
            if (extrema[i] > 0.0 && extrema[i] < 1.0)
                ends[++parts] = extrema[i];
    }
    ends[++parts] = 1.0;
    return parts;
}

/* M08's algorithm 8. */
static bool marmitt_3(const ray *r, const cell_visit *v, const float samples[8], double iso,
                      int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    (void)r;
    double b[4], ends[4];
    if (!cell_cubic(v, samples, iso, b))
        return false;
    const polynomial f = polynomial_of(b);
    const int parts = monotone_parts(&f, ends);
    double f_end = b[0];
    for (int part = 0; part < parts; part++) {
        double s_in = ends[part], s_out = ends[part + 1];
        double f_in = f_end, f_out = part + 1 < parts ? polynomial_at(&f, s_out) : b[3];
        f_end = f_out;
        const bool inside = f_in >= 0.0;
        if (inside == (f_out >= 0.0))
            continue;
        for (int i = 0; i < STEPS; i++) {
            const double s = s_in - (s_out - s_in) * (f_in / (f_out - f_in));
            const double value = polynomial_at(&f, s);
            if ((value >= 0.0) == inside) {
                s_in = s;
                f_in = value;
            } else {
                s_out = s;
                f_out = value;
            }
        }
        const double s = s_in - (s_out - s_in) * (f_in / (f_out - f_in));
        if (report(v, s, !inside, iso_index, cell, after, found))
            return true;
    }
    return false;
}

static const intersector TABLE[INTERSECTOR_COUNT] = {
    {LEAFCAST_MIDPOINT, "midpoint", midpoint},    {LEAFCAST_LINEAR, "linear", linear},
    {LEAFCAST_NEUBAUER, "neubauer", neubauer},    {LEAFCAST_SCHWARZE, "schwarze", schwarze},
    {LEAFCAST_MARMITT_3, "marmitt-3", marmitt_3}, {LEAFCAST_MARMITT, "marmitt", cell_next_hit},
};

const intersector *intersector_at(int index) {
    return &TABLE[index];
}

const intersector *intersector_find(leafcast_intersector id) {
    for (int i = 0; i < INTERSECTOR_COUNT; i++)
        if (TABLE[i].id == id)
            return &TABLE[i];
    return NULL;
}

const intersector *intersector_named(const char *name) {
    for (int i = 0; i < INTERSECTOR_COUNT; i++)
        if (strcmp(TABLE[i].name, name) == 0)
            return &TABLE[i];
    return NULL;
}
