#include "tests/support/naive_codes.h"

#include <math.h>

bool naive_finite_range(const naive_window *w, const long from[3], const long to[3], float *lo,
                        float *hi) {
    bool all = true;
    *lo = INFINITY;
    *hi = -INFINITY;
    for (long k = from[2]; k <= to[2]; k++)
        for (long j = from[1]; j <= to[1]; j++)
            for (long i = from[0]; i <= to[0]; i++) {
                float value = w->samples[i + w->size[0] * (j + w->size[1] * k)];
                if (!isfinite(value)) {
                    all = false;
                    continue;
                }
                *lo = value < *lo ? value : *lo;
                *hi = value > *hi ? value : *hi;
            }
    return all;
}

static double code_of(const naive_leaf *leaf, const naive_treelet *t, double value) {
    double lo = t->own[0], hi = t->own[1];
    bool exact = leaf->sample_type != 5 && hi - lo <= 255;
    double scale = hi <= lo ? 0 : exact ? 1 : 255 / (hi - lo);
    double g = (value - lo) * scale;
    return g < 0 ? 0 : g > 255 ? 255 : g;
}

/* The codes of one block of level K. */
static void block_codes(const naive_leaf *leaf, const naive_treelet *t, const naive_window *w,
                        const long block[3], unsigned char *lo, unsigned char *hi) {
    long from[3], to[3];
    float least, most;
    *lo = 255;
    *hi = 0;
    for (int a = 0; a < 3; a++) {
        from[a] = 4 * block[a] + leaf->halo;
        to[a] = (4 * block[a] + 4 < t->cells[a] ? 4 * block[a] + 4 : t->cells[a]) + leaf->halo;
        if (4 * block[a] >= t->cells[a])
            return;
    }
    naive_finite_range(w, from, to, &least, &most);
    if (least > most)
        return;
    *lo = (unsigned char)floor(code_of(leaf, t, (double)least));
    *hi = (unsigned char)ceil(code_of(leaf, t, (double)most));
}

/* The codes of node m at level k, recomputed from the samples. */
static void node_codes(const naive_leaf *leaf, const naive_treelet *t, const naive_window *w, int k,
                       long m, unsigned char *lo, unsigned char *hi) {
    int last = leaf->cells_log2 - 2;
    if (k == last) {
        long block[3] = {0, 0, 0};
        for (int bit = 0; bit < 3 * k; bit++)
            block[bit % 3] |= (m >> bit & 1) << (bit / 3);
        block_codes(leaf, t, w, block, lo, hi);
        return;
    }
    *lo = 255;
    *hi = 0;
    for (int child = 0; child < 8; child++) {
        unsigned char l, h;
        node_codes(leaf, t, w, k + 1, 8 * m + child, &l, &h);
        *lo = l < *lo ? l : *lo;
        *hi = h > *hi ? h : *hi;
    }
}

uint64_t naive_codes_size(const naive_leaf *leaf) {
    return 2 * ((UINT64_C(1) << (3 * (leaf->cells_log2 - 1))) - 8) / 7;
}

void naive_codes_make(const naive_leaf *leaf, const naive_treelet *t, const naive_window *w,
                      unsigned char *codes) {
    for (int k = 1; k <= leaf->cells_log2 - 2; k++) {
        const long nodes = 1L << (3 * k);
        for (long m = 0; m < nodes; m++)
            node_codes(leaf, t, w, k, m, &codes[m], &codes[nodes + m]);
        codes += 2 * nodes;
    }
}
