#include "tests/support/mesh_truth.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

static bool is_sound(const mesh_case *c, const uint32_t id[4]) {
    for (int k = 0; k < 4; k++)
        for (int other = 0; other < k; other++)
            if (id[k] == id[other])
                return false;
    return id[0] < c->point_count && id[1] < c->point_count && id[2] < c->point_count &&
           id[3] < c->point_count;
}

static void add_truth(const mesh_case *c, const uint32_t id[4], mesh_truth *all) {
    long double e[3][3], df[3], n[3][3], volume = 0, terms = 0, g[3], size = 0;
    for (int i = 0; i < 3; i++) {
        df[i] = (long double)c->values[id[i + 1]] - (long double)c->values[id[0]];
        for (int a = 0; a < 3; a++)
            e[i][a] = (long double)c->points[id[i + 1]][a] - (long double)c->points[id[0]][a];
    }
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++) {
            const long double *u = e[(i + 1) % 3], *v = e[(i + 2) % 3];
            n[i][a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
            if (i == 0)
                terms += fabsl(e[0][a]) * (fabsl(u[(a + 1) % 3] * v[(a + 2) % 3]) +
                                           fabsl(u[(a + 2) % 3] * v[(a + 1) % 3]));
        }
    for (int a = 0; a < 3; a++)
        volume += e[0][a] * n[0][a];
    if (!(fabsl(volume) > 0x1p-36L * terms) || !isfinite(df[0] + df[1] + df[2]))
        return;
    for (int a = 0; a < 3; a++) {
        g[a] = df[0] * n[0][a] + df[1] * n[1][a] + df[2] * n[2][a];
        for (int i = 0; i < 3; i++)
            size += fabsl(df[i] * n[i][a]);
    }
    for (int k = 0; k < 4; k++) {
        mesh_truth *to = &all[id[k]];
        for (int a = 0; a < 3; a++)
            to->sum[a] += volume < 0 ? -g[a] : g[a];
        to->volume += fabsl(volume);
        to->moduli += size;
    }
}

mesh_truth *mesh_truth_gradients(const mesh_case *c) {
    mesh_truth *all = calloc(c->point_count, sizeof *all);
    assert_non_null(all);
    for (size_t t = 0; t < c->tet_count; t++)
        if (is_sound(c, c->tets[t]))
            add_truth(c, c->tets[t], all);
    return all;
}

void mesh_truth_check(const mesh_truth *t, const float got[3], size_t vertex) {
    for (int a = 0; a < 3; a++) {
        const long double want = t->volume > 0 ? t->sum[a] / t->volume : 0;
        const long double room = t->volume > 0 ? 0x1p-44L * t->moduli / t->volume : 0;
        if (!(fabsl((long double)got[a] - want) <= 0x1p-23L * fabsl(want) + room))
            fail_msg("vertex %zu: %.9g, not %.9Lg", vertex, (double)got[a], want);
    }
}
