#include "prep/grid/pyramid_rows.h"

#include "prep/grid/pyramid_rows_template.h"

typedef const pyramid_rows *(*pyramid_rows_fn)(sample_type type);
CPU_KERNELS(pyramid_rows_fn, pyramid_rows_kernels, pyramid_rows_scalar, pyramid_rows);

const pyramid_rows *pyramid_rows_for(cpu_isa isa, sample_type type) {
    return pyramid_rows_kernels[isa](type);
}
