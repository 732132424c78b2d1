#include "formats/leaf/deviation_rows.h"

#include "formats/leaf/deviation_rows_template.h"

typedef deviation_rows (*deviation_rows_fn)(sample_type type, deviation_numbers numbers);
CPU_KERNELS(deviation_rows_fn, deviation_rows_kernels, deviation_rows_scalar, deviation_rows);

deviation_rows deviation_rows_for(cpu_isa isa, sample_type type, deviation_numbers numbers) {
    return deviation_rows_kernels[isa](type, numbers);
}
