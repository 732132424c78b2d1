#include "render/grid/cell_kernel.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "render/ray/cubic.h"

enum {
    START = -1,
    END = 3
}; /* "axes" of the events at t0 and t1: before and behind all plane crossings of equal t */

static double clamp01(double x) {
    return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
}

/* Compute cell coordinates at an event: exact on the axis that is crossed, from the event's own t
 * on the others. All is relative to the ray's origin, so that the grid's size costs no digits. */
static void coordinates_at(const ray *r, const cell_box *box, double t, int axis, double on_axis,
                           double at[3]) {
    for (int a = 0; a < 3; a++)
        at[a] = a == axis ? on_axis : clamp01((t * r->d[a] - (box->lo[a] - r->o[a])) * box->inv[a]);
}

bool cell_visit_of(const ray *r, const cell_box *box, cell_visit *visit) {
    double t_in = r->t0, t_out = r->t1;
    int axis_in = START, axis_out = END;
    for (int a = 0; a < 3; a++) {
        double o = r->o[a], d = r->d[a];
        if (d == 0.0) {
            /* The cell owns [lo, hi); nothing is ever crossed on this axis. */
            if (o < box->lo[a] || o > box->hi[a] || (o == box->hi[a] && !box->last[a]))
                return false;
            continue;
        }
        double near = ((d > 0.0 ? box->lo[a] : box->hi[a]) - o) / d;
        double far = ((d > 0.0 ? box->hi[a] : box->lo[a]) - o) / d;
        /* A start on the upper plane is in the next cell already when the ray goes up. */
        if (d > 0.0 ? far <= r->t0 : far < r->t0)
            return false;
        /* Last entry in (t, axis) order: a later axis wins a tie. */
        if (near >= t_in) {
            t_in = near;
            axis_in = a;
        }
        /* First exit in (t, axis) order: an earlier axis wins a tie. */
        if (far < t_out || (far == t_out && axis_out == END)) {
            t_out = far;
            axis_out = a;
        }
    }
    if (t_in > t_out || (t_in == t_out && axis_in >= axis_out))
        return false;
    visit->t_in = t_in;
    visit->t_out = t_out;
    double enter_at = axis_in != START && r->d[axis_in] < 0.0 ? 1.0 : 0.0;
    double leave_at = axis_out != END && r->d[axis_out] < 0.0 ? 0.0 : 1.0;
    coordinates_at(r, box, t_in, axis_in, enter_at, visit->in);
    coordinates_at(r, box, t_out, axis_out, leave_at, visit->out);
    return true;
}

/* (1 - s) a + s b: exactly a at 0, b at 1, and never beyond both. */
static inline double mix(double a, double b, double s) {
    return (1.0 - s) * a + s * b;
}

/* Compute the cubic's control values along a visit, from eight corner values. */
static void blossom(const cell_visit *visit, const double f[8], double b[4]) {
    /* The trilinear form at all corners of the box that entry and exit span; bit a of the index =
     * exit on axis a. Always x, then y, then z: with an exact 0 or 1 on the crossed axis what
     * remains is the face's bilinear form, alike from both cells. */
    double x[2][4], xy[4][2], m[8];
    for (int i = 0; i < 4; i++) {
        x[0][i] = mix(f[2 * i], f[2 * i + 1], visit->in[0]);
        x[1][i] = mix(f[2 * i], f[2 * i + 1], visit->out[0]);
    }
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            xy[i][k] = mix(x[i][2 * k], x[i][2 * k + 1], visit->in[1]);
            xy[i + 2][k] = mix(x[i][2 * k], x[i][2 * k + 1], visit->out[1]);
        }
    }
    for (int i = 0; i < 4; i++) {
        m[i] = mix(xy[i][0], xy[i][1], visit->in[2]);
        m[i + 4] = mix(xy[i][0], xy[i][1], visit->out[2]);
    }
    /* The blossom of the cubic: control values are means of the mixed corners. */
    b[0] = m[0];
    b[1] = (m[1] + m[2] + m[4]) * (1.0 / 3.0);
    b[2] = (m[3] + m[5] + m[6]) * (1.0 / 3.0);
    b[3] = m[7];
}

void cell_blossom(const cell_visit *visit, const double corners[8], double b[4]) {
    blossom(visit, corners, b);
}

bool cell_cubic(const cell_visit *visit, const float samples[8], double iso, double b[4]) {
    /* Subtract the isovalue first: what follows keeps its relative precision. */
    double f[8];
    int inside = 0;
    for (int i = 0; i < 8; i++) {
        f[i] = (double)samples[i] - iso;
        inside += f[i] >= 0.0;
    }
    if (inside == 0 || inside == 8)
        return false;
    blossom(visit, f, b);
    return true;
}

void cell_values(const cell_visit *visit, const float samples[8], double above, double b[4]) {
    double f[8];
    for (int i = 0; i < 8; i++)
        f[i] = (double)samples[i] - above;
    blossom(visit, f, b);
}

/* The cubic in power form about the entry, for fast evaluation. */
typedef struct cubic {
    double c[4];
} cubic;

static cubic cubic_of(const double b[4]) {
    return (cubic){{b[0], 3.0 * (b[1] - b[0]), 3.0 * ((b[2] - b[1]) - (b[1] - b[0])),
                    (b[3] - b[0]) - 3.0 * (b[2] - b[1])}};
}

static double cubic_at(const cubic *p, double s) {
    return p->c[0] + s * (p->c[1] + s * (p->c[2] + s * p->c[3]));
}

/* Returns the root in [lo, hi], where f(lo) and f(hi) lie on different sides. Starts at the
 * secant's zero, and takes steps of fourth order within a bracket: the series of the inverse
 * function about s, to its third term, with one division each. Let q and p be the relative sizes of
 * the second and third term, and z = q^2 + |p|.
 *   - The series is used only if z <= 1/8. Otherwise its terms may cancel, and it would stop where
 *     no root is; then only the first term is taken, Newton's step.
 *   - The search ends when z <= 2^-10 and the terms left out cannot change the last bit of [0, 1]:
 *     they are less than z (5 q + 48 z) of the first term.
 * If a step leaves the bracket, or is more than half as long as the one before, bisect instead.
 * There are two evaluations on average.
 *
 * All quantities that decide have no unit. So scaling the samples by a power of two changes
 * nothing. cell_batch_template.h relies on this, and repeats the sequence operation by operation.
 */
static double refine(const cubic *p, double lo, double hi, double f_lo, double f_hi) {
    const double c0 = p->c[0], c1 = p->c[1], c2 = p->c[2], c3 = p->c[3];
    const bool side_lo = f_lo >= 0.0;
    double reach = hi - lo, s = lo + reach * (f_lo / (f_lo - f_hi));
    if (s > hi)
        s = hi;
    for (int step = 0; step < CELL_STEPS_MAX; step++) {
        /* The polynomial, its slope, and half of its bend, by synthetic division. */
        const double c3_s = s * c3, h2 = c2 + c3_s, h1 = c1 + s * h2, f = c0 + s * h1;
        const double g2 = h2 + c3_s, slope = h1 + s * g2, bend = g2 + c3_s;
        if ((f >= 0.0) == side_lo)
            lo = s;
        else
            hi = s;
        const double per_slope = 1.0 / slope, newton = f * per_slope;
        const double q = bend * per_slope * newton, qq = q * q;
        const double third = c3 * per_slope * newton * newton;
        const double z = qq + fabs(third);
        const double move =
            z <= CELL_SERIES_USED ? newton * (1.0 + (q + ((qq + qq) - third))) : newton;
        const double next = s - move;
        if (next >= lo && next <= hi && fabs(move) <= reach) {
            s = next;
            reach = 0.5 * fabs(move);
            if (z <= CELL_SERIES_SURE &&
                fabs(newton) * (z * (5.0 * fabs(q) + 48.0 * z)) <= CELL_LAST_BIT)
                break;
            if (fabs(move) <= CELL_LAST_BIT)
                break;
        } else {
            s = 0.5 * (lo + hi);
            reach = 0.5 * (hi - lo);
            if (reach <= CELL_LAST_BIT)
                break;
        }
    }
    return s;
}

/* Returns the greatest power of two that is not above x, which is positive and normal. */
static double power_below(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits &= CELL_EXPONENT_BITS;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Scale by a power of two to max |b| in [1, 2): squares neither vanish nor overflow, and no digit
 * changes. */
static void normalise(const double b[4], double scaled[4]) {
    const double largest = fmax(fmax(fabs(b[0]), fabs(b[1])), fmax(fabs(b[2]), fabs(b[3])));
    if (largest >= CELL_ORDINARY_MIN && largest <= CELL_ORDINARY_MAX) {
        const double scale = 1.0 / power_below(largest);
        for (int i = 0; i < 4; i++)
            scaled[i] = b[i] * scale;
    } else {
        const int exponent = ilogb(largest);
        for (int i = 0; i < 4; i++)
            scaled[i] = scalbn(b[i], -exponent);
    }
}

/* Returns whether, as far as rounding can tell, the cubic touches zero at an extremum: two roots in
 * one place. A false touch does no harm: the trilinear form has no extremum in space, so a ray
 * moved a little sideways does meet the surface there. The cubic must clearly bend there. Where it
 * is nearly level, as beside a triple root, its sign follows from other places. */
static bool touches(const cubic *p, double s, double f) {
    static const double NEAR = 64.0 * DBL_EPSILON, BEND = 0.25; /* of a cubic scaled to [1, 2) */
    return fabs(f) <= NEAR && fabs(2.0 * p->c[2] + 6.0 * p->c[3] * s) >= BEND;
}

/* Find the roots between neighbouring extrema, where the cubic is monotone. Returns their number.
 */
static int isolate(const cubic *p, const double b[4], double roots[3]) {
    double at[4] = {0.0}, f[4] = {b[0]};
    const int last = 1 + cubic_extrema(b, at + 1);
    int changes = 0;
    for (int i = 1; i <= last; i++) {
        at[i] = i < last ? at[i] : 1.0;
        f[i] = i < last ? cubic_at(p, at[i]) : b[3];
        changes += (f[i - 1] >= 0.0) != (f[i] >= 0.0);
    }
    int n = 0;
    for (int i = 1; i <= last; i++) {
        if ((f[i - 1] >= 0.0) != (f[i] >= 0.0)) {
            roots[n++] = refine(p, at[i - 1], at[i], f[i - 1], f[i]);
        } else if (i < last && changes < 2 && (f[i + 1] >= 0.0) == (f[i] >= 0.0) &&
                   touches(p, at[i], f[i])) {
            roots[n++] = at[i];
            roots[n++] = at[i];
            changes += 2;
        }
    }
    return n;
}

int cell_roots(const double control[4], double roots[3]) {
    const bool s0 = control[0] >= 0.0, s1 = control[1] >= 0.0, s2 = control[2] >= 0.0,
               s3 = control[3] >= 0.0;
    const int changes = (s0 != s1) + (s1 != s2) + (s2 != s3);
    /* Variation diminishing: no more roots than changes of side in the control polygon. */
    if (changes == 0)
        return 0;
    double b[4];
    normalise(control, b);
    const cubic p = cubic_of(b);
    /* One change of side: one root, and up to it f has the sign of its end. This fails if an end is
     * nearly zero: rounding hides the sign beside it, and the iteration would take the end for the
     * root. */
    if (changes == 1 && fabs(b[0]) > CELL_NEAR_END && fabs(b[3]) > CELL_NEAR_END) {
        roots[0] = refine(&p, 0.0, 1.0, b[0], b[3]);
        return 1;
    }
    return isolate(&p, b, roots);
}

bool cell_next_hit(const ray *r, const cell_visit *visit, const float samples[8], double iso,
                   int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    (void)r;
    double b[4], roots[3];
    if (!cell_cubic(visit, samples, iso, b))
        return false;
    const int n = cell_roots(b, roots);
    bool inside = b[0] >= 0.0;
    for (int i = 0; i < n; i++, inside = !inside) {
        hit h = {cell_root_t(visit, roots[i]), cell, iso_index, !inside};
        if (hit_less(after, &h)) {
            *found = h;
            return true;
        }
    }
    return false;
}
