/* box_rows.h - predicts the rows of boxes: the inner loops of box_coder.c, for unsigned integers of
 * each width and for each ISA. All give the same bits. */
#ifndef FORMATS_LEAF_BOX_ROWS_H
#define FORMATS_LEAF_BOX_ROWS_H

#include "formats/base/cpu.h"
#include "formats/leaf/box_coder.h"

/* What a coder works with. T: an unsigned integer as wide as a sample. BOX_SPARE more bytes than
 * said may be read and written behind residuals and rows. */
enum { BOX_SPARE = 64 };
typedef struct box_work {
    void *values;    /* T of all samples, one box behind the other, rows in the order x, y, z */
    void *residuals; /* T, at most one of each sample */
    void *predicted; /* T of a row */
    void *zeros;     /* T of a row */
    void *row;       /* T of two rows */
    uint8_t *map;    /* which samples are not the background: a bit each, rows in whole bytes */
} box_work;

typedef struct box_rows {
    /* Make the residuals of every `step`-th row. how: box_prediction, without BOX_BACKGROUND;
     * background: only of samples in the map. Returns how many there are. */
    size_t (*residuals)(const box_work *w, const coded_box *boxes, uint32_t count, int how,
                        bool background, uint32_t step);
    /* Make the values of all boxes from code->coded residuals. False: these are more or fewer than
     * the map says. */
    bool (*values)(const box_work *w, const coded_box *boxes, uint32_t count, const box_code *code);
    /* Make the map. */
    void (*mark)(const box_work *w, const coded_box *boxes, uint32_t count, uint32_t background);
} box_rows;

/* box_rows_for() - the loops of an ISA for samples of 1, 2 or 4 bytes. */
const box_rows *box_rows_for(cpu_isa isa, size_t sample_bytes);

/* box_map_row_bytes() - bytes of a row in the map. box_map_bytes() - of a box. */
static inline uint32_t box_map_row_bytes(uint32_t samples) {
    return (samples + 7) / 8;
}
static inline size_t box_map_bytes(const uint32_t size[3]) {
    return (size_t)box_map_row_bytes(size[0]) * size[1] * size[2];
}

#endif
