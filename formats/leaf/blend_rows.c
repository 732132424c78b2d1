#include "formats/leaf/blend_rows.h"

#include "formats/leaf/blend_rows_template.h"

typedef blend_fn *(*blend_rows_fn)(sample_type type);
CPU_KERNELS(blend_rows_fn, blend_rows_kernels, blend_rows_scalar, blend_rows);

blend_fn *blend_rows_for(cpu_isa isa, sample_type type) {
    return blend_rows_kernels[isa](type);
}
