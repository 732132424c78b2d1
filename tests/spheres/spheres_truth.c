#include "tests/spheres/spheres_truth.h"

#include <math.h>
#include <stdlib.h>

static int by_t(const void *a, const void *b) {
    const truth_hit *x = a, *y = b;
    if (x->t != y->t)
        return x->t < y->t ? -1 : 1;
    if (x->number != y->number)
        return x->number < y->number ? -1 : 1;
    return x->iso - y->iso;
}

/* A t^2 - 2 B t + C = 0. */
static void meet(const sphere *x, long double iso, const double origin[3],
                 const double direction[3], long double t[2], long double *share) {
    long double a = 0.0L, b = 0.0L, c = 0.0L;
    const long double peak = x->peak, radius = x->radius;
    const long double square = radius * radius * (1.0L - iso / peak);
    for (int k = 0; k < 3; k++) {
        const long double to = (long double)x->centre[k] - (long double)origin[k];
        a += (long double)direction[k] * (long double)direction[k];
        b += (long double)direction[k] * to;
        c += to * to;
    }
    c -= square;
    const long double left = b * b - a * c;
    *share = left / (a * radius * radius);
    if (left <= 0.0L)
        return;
    const long double q = b < 0.0L ? b - sqrtl(left) : b + sqrtl(left);
    t[0] = fminl(q / a, c / q);
    t[1] = fmaxl(q / a, c / q);
}

int spheres_truth_hits(const spheres_truth *s, const double origin[3], const double direction[3],
                       double t0, double t1, truth_hit hits[TRUTH_HITS_MAX], bool *grazing) {
    int count = 0;
    for (uint32_t n = 0; n < s->count; n++) {
        for (int i = 0; i < s->isos; i++) {
            long double t[2] = {0.0L, 0.0L}, share;
            if (!(s->isovalues[i] > 0.0 && s->isovalues[i] <= s->spheres[n].peak))
                continue;
            meet(&s->spheres[n], (long double)s->isovalues[i], origin, direction, t, &share);
            *grazing |= fabsl(share) < 1e-5L;
            for (int k = 0; k < 2 && share > 0.0L; k++)
                if (t[k] >= (long double)t0 && t[k] <= (long double)t1) {
                    if (count == TRUTH_HITS_MAX)
                        abort();
                    hits[count++] = (truth_hit){t[k], n, i, k == 0};
                }
        }
    }
    qsort(hits, (size_t)count, sizeof *hits, by_t);
    return count;
}

int spheres_truth_chords(const spheres_truth *s, const double origin[3], const double direction[3],
                         cell_chord out[CELL_CHORDS_MAX], bool *grazing) {
    int count = 0;
    for (uint32_t n = 0; n < s->count; n++) {
        long double t[2] = {0.0L, 0.0L}, share;
        meet(&s->spheres[n], 0.0L, origin, direction, t, &share);
        *grazing |= fabsl(share) < 1e-5L;
        if (share <= 0.0L)
            continue;
        /* share: of the square of the radius, what the line's distance from the centre leaves. */
        const long double most = (long double)s->spheres[n].peak * share;
        if (count == CELL_CHORDS_MAX)
            abort();
        out[count++] = (cell_chord){t[0], t[1], 0.0L, most, most * 2.0L / 3.0L, n};
    }
    return count;
}

bool spheres_truth_at(const spheres_truth *s, const double point[3], uint64_t *number,
                      long double *value) {
    for (uint32_t n = 0; n < s->count; n++) {
        const sphere *x = &s->spheres[n];
        long double square = 0.0L;
        for (int k = 0; k < 3; k++) {
            const long double away = (long double)point[k] - (long double)x->centre[k];
            square += away * away;
        }
        const long double share = square / ((long double)x->radius * (long double)x->radius);
        if (share > 1.0L)
            continue;
        *number = n;
        *value = (long double)x->peak * (1.0L - share);
        return true;
    }
    return false;
}
