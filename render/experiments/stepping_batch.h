/* stepping_batch.h - what is seen of many pieces in equal steps: for comparison with certified
 * pictures (medium_batch.h).
 *
 * A ray's way through a volume's box, from `from` to `to`, is cut into steps of one length; the
 * last one is shorter. The transfer function at a step's middle is taken for the whole step: with
 * colour c and extinction k, c (1 - e^-kh) is seen, and e^-kh comes through. A step belongs to the
 * piece that holds its middle, or to none in a gap; so pieces are independent. The error is
 * unknown.
 *
 * Versions for newer instructions come from one template (stepping_batch_template.h) and give the
 * same bits as the scalar one.
 */
#ifndef RENDER_EXPERIMENTS_STEPPING_BATCH_H
#define RENDER_EXPERIMENTS_STEPPING_BATCH_H

#include "formats/base/cpu.h"
#include "render/look/transfer.h"
#include "render/ray/segment_batch.h"

typedef struct stepping_batch {
    const transfer *transfer;
    double step, inverse;                                           /* world length, and 1 / that */
    _Alignas(64) double from[SEGMENT_COLUMNS], to[SEGMENT_COLUMNS]; /* of each piece's ray */
    /* The result for each piece: its light, and the share that comes through. */
    double rgb[3][SEGMENT_COLUMNS], through[SEGMENT_COLUMNS];
} stepping_batch;

/* Does all pieces in the columns. May also read and write columns behind the last one. */
typedef void (*stepping_batch_fn)(stepping_batch *m, const segment_columns *pieces);

/* By ISA (cpu.h). */
extern const stepping_batch_fn stepping_batch_kernels[CPU_ISAS];

#endif
