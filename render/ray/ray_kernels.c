#include "render/ray/ray_kernels.h"

#include "render/ray/kind.h"

ray_kernels ray_kernels_of(const kind *k, cpu_isa isa) {
    static const kind_batches none;
    const kind_batches *b = k->batches ? k->batches : &none;
    return (ray_kernels){.isa = isa,
                         .tile = k->tiles ? k->tiles->kernels[isa] : NULL,
                         .batch = b->hits ? b->hits[isa] : NULL,
                         .segment_batch = b->pieces ? b->pieces[isa] : NULL,
                         .extreme_batch = b->extremes ? b->extremes[isa] : NULL};
}

const ray_kernels ray_kernels_none = {.isa = CPU_SCALAR};
