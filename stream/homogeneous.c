#include "stream/homogeneous.h"

#include <math.h>

#include "stream/interest.h"

void homogeneous_except(homogeneous *h, double value) {
    const float below = nextafterf(value_limits_threshold(value), -INFINITY);
    for (int i = 0; i < h->bins; i++)
        if (homogeneous_begin(h, i) - 1e-6 * h->width < value)
            h->until[i] = fminf(h->until[i], below);
}

bool homogeneous_same(const homogeneous *a, const homogeneous *b) {
    bool same = a->bins == b->bins && a->first == b->first && a->width == b->width;
    for (int i = 0; same && i < a->bins; i++)
        same = a->until[i] == b->until[i];
    return same;
}
