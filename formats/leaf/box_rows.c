#include "formats/leaf/box_rows.h"

#include "formats/leaf/box_rows_template.h"

typedef const box_rows *(*box_rows_fn)(size_t sample_bytes);
CPU_KERNELS(box_rows_fn, box_rows_kernels, box_rows_scalar, box_rows);

const box_rows *box_rows_for(cpu_isa isa, size_t sample_bytes) {
    return box_rows_kernels[isa](sample_bytes);
}
