#include "render/mesh/tet_batch.h"

static void tet_batch_scalar(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                             flat_rays *rays, int first, int end) {
    (void)known;
    for (int i = first; i < end; i++)
        if (rays->from[i] <= rays->to[i])
            (void)flat_rays_one(g, cell, iso_index, rays, i);
}

CPU_KERNELS(tet_batch_fn, tet_batch_kernels, tet_batch_scalar, tet_batch);
