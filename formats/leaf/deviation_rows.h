/* deviation_rows.h - the inner loops of deviation_band.c, by type and for each ISA. All give the
 * same bits. */
#ifndef FORMATS_LEAF_DEVIATION_ROWS_H
#define FORMATS_LEAF_DEVIATION_ROWS_H

#include "formats/base/cpu.h"
#include "formats/base/sample.h"
#include "formats/leaf/deviation_band.h"

enum { DEVIATION_COARSE_ROWS = DEVIATION_BRICK + 1 };

/* Of integers on a regular grid, a node between coarse ones is the mean of 2, 4 or 8 of them. So
 * all differences are whole eighths: 12 bits for samples of one byte, 20 for two. Others are
 * doubles. */
typedef enum deviation_numbers { DEVIATION_I16, DEVIATION_I32, DEVIATION_F64 } deviation_numbers;

/* The greatest differences at the nodes of two rows of bricks, over all their rows of nodes and all
 * slices. Each row of bricks has `row` numbers for even places on x, then `row` for odd ones. */
struct deviation_band {
    uint32_t nodes, row;
    deviation_numbers numbers;
    _Alignas(64) char most[];
};

static inline deviation_numbers deviation_numbers_of(sample_type type, bool weighted) {
    return type == SAMPLE_F32 || weighted ? DEVIATION_F64
           : sample_size(type) == 1       ? DEVIATION_I16
                                          : DEVIATION_I32;
}

typedef void (*deviation_rows)(const deviation_slice *s, void *scratch, deviation_band *band);

/* deviation_rows_for() - the loops of an ISA; numbers: deviation_numbers_of(). */
deviation_rows deviation_rows_for(cpu_isa isa, sample_type type, deviation_numbers numbers);

#endif
