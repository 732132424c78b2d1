/* tet_hit.h - a ray against a whole tet, as the walk through a mesh asks the kernel. */
#ifndef TESTS_SUPPORT_TET_HIT_H
#define TESTS_SUPPORT_TET_HIT_H

#include "render/mesh/tet_kernel.h"

/* tet_hit() - isopolygon_of() and flat_polygon_hit() for every isovalue: the least hit. */
static inline bool tet_hit(const tet *x, const ray *r, const double *isovalues, int count,
                           uint64_t cell, const hit *after, hit *found) {
    bool any = false;
    for (int32_t i = 0; i < count; i++) {
        isopolygon g;
        hit h;
        if (isopolygon_of(x, isovalues[i], &g) && flat_polygon_hit(&g, r, cell, i, after, &h) &&
            (!any || hit_less(&h, found))) {
            *found = h;
            any = true;
        }
    }
    return any;
}

#endif
