#include "formats/leaf/live_rows.h"

#include "formats/leaf/live_rows_template.h"

typedef const live_rows *(*live_rows_fn)(sample_type type);
CPU_KERNELS(live_rows_fn, live_rows_kernels, live_rows_scalar, live_rows);

const live_rows *live_rows_for(cpu_isa isa, sample_type type) {
    return live_rows_kernels[isa](type);
}
