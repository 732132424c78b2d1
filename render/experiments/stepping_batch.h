/* stepping_batch.h - what is seen of many pieces in equal steps: the way that certified pictures
 * (medium_batch.h) are compared with.
 *
 * A ray's way through a volume's box, from `from` to `to`, is cut into steps of one length, the
 * last one shorter. In the middle of each the transfer function is taken for the whole step: of
 * colour c and extinction k, c (1 - e^-kh) is seen, and e^-kh comes through. A step belongs to the
 * piece that its middle is in, to none where nothing is; so pieces need to know nothing of each
 * other. Nobody knows how far off this is.
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
    /* What is seen: the light, and the share that comes through. */
    double rgb[3][SEGMENT_COLUMNS], through[SEGMENT_COLUMNS];
} stepping_batch;

/* Of all pieces in the columns; columns behind the last one may be read, and written, too. */
typedef void (*stepping_batch_fn)(stepping_batch *m, const segment_columns *pieces);

/* By ISA (cpu.h). */
extern const stepping_batch_fn stepping_batch_kernels[CPU_ISAS];

#endif
