#include "render/flat/flat_rays.h"

void flat_rays_clear(flat_rays *rays, int lane) {
    const ray none = {.d = {0.0, 0.0, 1.0}, .t0 = INFINITY, .t1 = -INFINITY};
    const hit before = hit_before_all();
    flat_rays_put(rays, lane, &none, &before);
}

bool flat_rays_one(const flat_polygon *g, uint64_t cell, int32_t iso_index, flat_rays *rays,
                   int lane) {
    ray r = {.t0 = rays->from[lane], .t1 = rays->to[lane]};
    for (int a = 0; a < 3; a++) {
        r.o[a] = rays->o[a][lane];
        r.d[a] = rays->d[a][lane];
    }
    hit last = hit_before_all(), h;
    bool taken = false;
    while (flat_polygon_hit(g, &r, cell, iso_index, &last, &h)) {
        taken |= flat_rays_offer(rays, lane, &h);
        last = h;
    }
    return taken;
}
