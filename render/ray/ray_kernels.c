#include "render/ray/ray_kernels.h"

#include "render/ray/kind.h"

ray_kernels ray_kernels_of(const kind *k, cpu_isa isa) {
    return (ray_kernels){.isa = isa,
                         .tile = k->tile ? k->tile[isa] : NULL,
                         .batch = k->batch ? k->batch[isa] : NULL,
                         .segment_batch = k->segment_batch ? k->segment_batch[isa] : NULL,
                         .extreme_batch = k->extreme_batch ? k->extreme_batch[isa] : NULL};
}
