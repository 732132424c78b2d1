#include "render/mesh/tet_batch.h"

void tet_rays_clear(tet_rays *rays, int lane) {
    const ray none = {.d = {0.0, 0.0, 1.0}, .t0 = INFINITY, .t1 = -INFINITY};
    const hit before = hit_before_all();
    tet_rays_put(rays, lane, &none, &before);
}

bool tet_batch_one(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_rays *rays,
                   int lane) {
    ray r = {.t0 = rays->from[lane], .t1 = rays->to[lane]};
    for (int a = 0; a < 3; a++) {
        r.o[a] = rays->o[a][lane];
        r.d[a] = rays->d[a][lane];
    }
    hit last = hit_before_all(), h;
    bool taken = false;
    while (flat_polygon_hit(g, &r, cell, iso_index, &last, &h)) {
        taken |= tet_batch_offer(rays, lane, &h);
        last = h;
    }
    return taken;
}

static void tet_batch_scalar(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                             tet_rays *rays, int first, int end) {
    (void)known;
    for (int i = first; i < end; i++)
        if (rays->from[i] <= rays->to[i])
            (void)tet_batch_one(g, cell, iso_index, rays, i);
}

CPU_KERNELS(tet_batch_fn, tet_batch_kernels, tet_batch_scalar, tet_batch);
