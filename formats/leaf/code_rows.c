#include "formats/leaf/code_rows.h"

#include "formats/leaf/code_rows_template.h"

typedef const code_rows *(*code_rows_fn)(sample_type type);
CPU_KERNELS(code_rows_fn, code_rows_kernels, code_rows_scalar, code_rows);

const code_rows *code_rows_for(cpu_isa isa, sample_type type) {
    return code_rows_kernels[isa](type);
}
