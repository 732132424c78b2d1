#include "prep/mesh/mesh_fetch.h"

#include <math.h>
#include <string.h>

status mesh_fetch(const mesh_vertices *v, mesh_pages *from, void *to, size_t size) {
    for (uint32_t i = 0; i < v->count; i++) {
        const void *element = mesh_pages_at(from, mesh_vertices_id(v, i));
        if (!element)
            return from->st;
        memcpy((char *)to + mesh_vertices_local(v, i) * size, element, size);
    }
    return ST_OK;
}

void mesh_fetch_bounds(const float (*position)[3], uint32_t count, float bounds[6]) {
    float *lo = bounds, *hi = bounds + 3;
    for (int a = 0; a < 3; a++)
        lo[a] = hi[a] = position[0][a];
    for (uint32_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            const float x = position[i][a];
            lo[a] = x < lo[a] ? x : lo[a];
            hi[a] = x > hi[a] ? x : hi[a];
        }
    /* Turn -0 into +0: otherwise it would be chance which of the two comes out. */
    for (int a = 0; a < 6; a++)
        bounds[a] += 0.0F;
}

leaf_entry mesh_fetch_range(const float *value, uint32_t count) {
    leaf_entry e = {.own = {INFINITY, -INFINITY}};
    for (uint32_t i = 0; i < count; i++) {
        if (!isfinite(value[i])) {
            e.flags |= LEAF_FLAG_NON_FINITE;
            continue;
        }
        e.own[0] = fminf(e.own[0], value[i]);
        e.own[1] = fmaxf(e.own[1], value[i]);
    }
    e.own[0] += 0.0F;
    e.own[1] += 0.0F;
    return e;
}
