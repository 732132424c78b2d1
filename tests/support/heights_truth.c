#include "tests/support/heights_truth.h"

#include <math.h>
#include <stdlib.h>

/* The line in node coordinates, the third being the height. */
typedef struct line {
    long double o[3], d[3];
} line;

static line line_of(const heights_truth *h, const double origin[3], const double direction[3],
                    const double shift[3]) {
    line l;
    for (int a = 0; a < 3; a++) {
        const long double unit = a < 2 ? (long double)h->spacing[a] : (long double)h->scale;
        const long double from = a < 2 ? (long double)h->origin[a] : 0.0L;
        l.o[a] = ((long double)origin[a] + (long double)shift[a] - from) / unit;
        l.d[a] = (long double)direction[a] / unit;
    }
    return l;
}

/* Cut [t0, t1] to lo <= o + t d < hi, the last one to hi included where the line stays in it. */
static bool cut(long double o, long double d, long double lo, long double hi, bool last,
                long double *t0, long double *t1) {
    if (d == 0.0L)
        return lo <= o && (o < hi || (last && o == hi));
    const long double a = (lo - o) / d, b = (hi - o) / d;
    *t0 = fmaxl(*t0, fminl(a, b));
    *t1 = fminl(*t1, fmaxl(a, b));
    return *t0 <= *t1;
}

/* f(s) = c + b s + a s^2: how far the line, t = from + s, is below the patch. */
typedef struct square {
    long double a, b, c;
} square;

static square square_of(const heights_truth *h, int i, int j, const line *l, long double from) {
    const float *p = h->heights + i + h->nx * j;
    const long double z = (long double)p[0], zx = (long double)p[1] - z,
                      zy = (long double)p[h->nx] - z,
                      twist = (long double)p[h->nx + 1] - (long double)p[h->nx] - zx;
    const long double u = l->o[0] + from * l->d[0] - i, v = l->o[1] + from * l->d[1] - j;
    return (square){.a = twist * l->d[0] * l->d[1],
                    .b =
                        zx * l->d[0] + zy * l->d[1] + twist * (u * l->d[1] + v * l->d[0]) - l->d[2],
                    .c = z + zx * u + zy * v + twist * u * v - (l->o[2] + from * l->d[2])};
}

static long double value(const square *f, long double s) {
    return f->c + s * (f->b + s * f->a);
}

/* On [s0, s1] f is monotone. */
static int bisect(const square *f, long double s0, long double s1, long double *root,
                  bool *entering) {
    const bool in0 = value(f, s0) >= 0.0L, in1 = value(f, s1) >= 0.0L;
    if (in0 == in1)
        return 0;
    for (int k = 0; k < 200 && s0 < s1; k++) {
        const long double middle = s0 + (s1 - s0) / 2;
        if (middle <= s0 || middle >= s1)
            break;
        if ((value(f, middle) >= 0.0L) == in0)
            s0 = middle;
        else
            s1 = middle;
    }
    *root = s1;
    *entering = in1;
    return 1;
}

static int meet_cell(const heights_truth *h, int i, int j, const line *l, long double t0,
                     long double t1, heights_meeting out[2]) {
    const float *p = h->heights + i + h->nx * j;
    if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[h->nx]) || !isfinite(p[h->nx + 1]))
        return 0;
    if (!cut(l->o[0], l->d[0], i, i + 1, i + 2 == h->nx, &t0, &t1) ||
        !cut(l->o[1], l->d[1], j, j + 1, j + 2 == h->ny, &t0, &t1))
        return 0;
    /* Steep lines: only where the height may be. */
    const float lo = fminf(fminf(p[0], p[1]), fminf(p[h->nx], p[h->nx + 1]));
    const float hi = fmaxf(fmaxf(p[0], p[1]), fmaxf(p[h->nx], p[h->nx + 1]));
    const long double pad = (long double)hi - (long double)lo +
                            fabsl((long double)h->spacing[0] / (long double)h->scale);
    if (!cut(l->o[2], l->d[2], (long double)lo - pad, (long double)hi + pad, true, &t0, &t1))
        return 0;
    const square f = square_of(h, i, j, l, t0);
    const long double length = t1 - t0, bend = f.a != 0.0L ? -f.b / (2 * f.a) : -1.0L;
    const bool turns = bend > 0.0L && bend < length;
    int count = 0;
    for (int part = 0; part < 1 + turns; part++) {
        long double root;
        bool entering;
        if (bisect(&f, part ? bend : 0.0L, turns && !part ? bend : length, &root, &entering))
            out[count++] = (heights_meeting){t0 + root, entering, i + (h->nx - 1) * j};
    }
    return count;
}

static int by_t(const void *a, const void *b) {
    const heights_meeting *x = a, *y = b;
    return x->t < y->t ? -1 : x->t > y->t;
}

int heights_truth_meetings(const heights_truth *h, const double origin[3],
                           const double direction[3], const double shift[3], long double t0,
                           long double t1, heights_meeting out[HEIGHTS_MEETINGS_MAX]) {
    const line l = line_of(h, origin, direction, shift);
    int count = 0;
    for (int j = 0; j + 1 < h->ny; j++)
        for (int i = 0; i + 1 < h->nx; i++) {
            if (count + 2 > HEIGHTS_MEETINGS_MAX)
                abort();
            count += meet_cell(h, i, j, &l, t0, t1, out + count);
        }
    qsort(out, (size_t)count, sizeof *out, by_t);
    return count;
}
