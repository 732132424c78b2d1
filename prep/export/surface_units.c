#include "prep/export/surface_units.h"

status surface_units_find(surface_units *u, const leaf_file *f, uint32_t set,
                          const double *isovalues, uint32_t count) {
    const uint32_t n = f->layout.treelets;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t t = 0; t < n; t++) {
            const float *own = f->own[leaf_layout_samples(&f->layout, set, t)];
            if (!((double)own[0] < isovalues[i] && isovalues[i] <= (double)own[1]))
                continue;
            status st = mem_grow(u->m, &u->list, sizeof *u->list, u->count, 64, &u->room);
            if (st != ST_OK)
                return st;
            u->list[u->count++] = (surface_unit){t, i};
        }
    return ST_OK;
}

void surface_units_release(surface_units *u) {
    mem_free(u->m, u->list);
    *u = (surface_units){.m = u->m};
}
