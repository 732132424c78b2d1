#include "tests/prisms/prisms_truth.h"

#include <math.h>
#include <stdlib.h>

/* Barycentric coordinate k of a point of the plane, times the whole area's sign and size. */
static long double weight(const prism *x, int k, long double px, long double py) {
    const float *a = x->base[(k + 1) % 3], *b = x->base[(k + 2) % 3];
    return ((long double)a[0] - px) * ((long double)b[1] - py) -
           ((long double)b[0] - px) * ((long double)a[1] - py);
}

/* The five functions that are above 0 inside, at a point. Three sum to 1, two are relative to the
 * height. */
static void inside_of(const prism *x, const long double p[3], long double out[5]) {
    const long double area = weight(x, 0, x->base[0][0], x->base[0][1]);
    const long double height = (long double)x->z[1] - (long double)x->z[0];
    for (int k = 0; k < 3; k++)
        out[k] = weight(x, k, p[0], p[1]) / area;
    out[3] = (p[2] - (long double)x->z[0]) / height;
    out[4] = ((long double)x->z[1] - p[2]) / height;
}

/* The functions are linear along a line: where all are above 0. */
static bool meet(const prism *x, const double origin[3], const double direction[3],
                 long double t[2], bool *grazing) {
    const long double narrow = 1e-6L;
    long double o[3], to[3], at[5], then[5];
    for (int a = 0; a < 3; a++) {
        o[a] = origin[a];
        to[a] = (long double)origin[a] + (long double)direction[a];
    }
    inside_of(x, o, at);
    inside_of(x, to, then);
    t[0] = -INFINITY;
    t[1] = INFINITY;
    for (int k = 0; k < 5; k++) {
        const long double speed = then[k] - at[k], zero = -at[k] / speed;
        if (fabsl(speed) < 1e-15L) {
            *grazing |= fabsl(at[k]) < narrow;
            if (at[k] < 0.0L)
                return false;
        } else if (speed > 0.0L) {
            t[0] = fmaxl(t[0], zero);
        } else {
            t[1] = fminl(t[1], zero);
        }
    }
    *grazing |= fabsl(t[1] - t[0]) < narrow * (1.0L + fabsl(t[0]));
    return t[0] < t[1];
}

int prisms_truth_chords(const prisms_truth *s, const double origin[3], const double direction[3],
                        cell_chord out[CELL_CHORDS_MAX], bool *grazing) {
    int count = 0;
    for (uint32_t n = 0; n < s->count; n++) {
        const long double value = (long double)s->prisms[n].value;
        long double t[2];
        if (!meet(&s->prisms[n], origin, direction, t, grazing))
            continue;
        if (count == CELL_CHORDS_MAX)
            abort();
        out[count++] = (cell_chord){t[0], t[1], value, value, value, n};
    }
    return count;
}

bool prisms_truth_at(const prisms_truth *s, const double point[3], long double *value,
                     bool *grazing) {
    const long double p[3] = {point[0], point[1], point[2]};
    for (uint32_t n = 0; n < s->count; n++) {
        long double at[5], least = INFINITY;
        inside_of(&s->prisms[n], p, at);
        for (int k = 0; k < 5; k++)
            least = fminl(least, at[k]);
        *grazing |= fabsl(least) < 1e-6L;
        if (least <= 0.0L)
            continue;
        *value = (long double)s->prisms[n].value;
        return true;
    }
    return false;
}
