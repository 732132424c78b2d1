/* code_rows.h - the inner loops of grid_codes.c, by type and for each ISA. All give the same
 * values; a zero may have either sign.
 */
#ifndef FORMATS_LEAF_CODE_ROWS_H
#define FORMATS_LEAF_CODE_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/cpu.h"
#include "formats/base/sample.h"
#include "formats/leaf/quantize.h"

/* The samples of a treelet without its halo. */
typedef struct code_samples {
    const void *first;
    size_t row, slice; /* samples from one to the next */
    uint32_t cells[3];
} code_samples;

typedef struct code_rows {
    /* Find the ranges of all 4^3 blocks that have cells, in Morton order; lo > hi: no finite
     * sample. Returns whether a sample is not finite. */
    bool (*ranges)(const code_samples *s, float *lo, float *hi);
    /* Find the range of so many ranges. */
    void (*whole)(const float *lo, const float *hi, uint32_t count, float whole[2]);
    /* Encode ranges; empty ones as 255, 0. */
    void (*encode)(const quantizer *q, const float *lo, const float *hi, uint32_t count,
                   uint8_t *lo_codes, uint8_t *hi_codes);
} code_rows;

/* code_rows_for() - the loops of an ISA for samples of sample_stored() types. */
const code_rows *code_rows_for(cpu_isa isa, sample_type type);

#endif
