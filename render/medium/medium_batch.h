/* medium_batch.h - what is seen of many pieces at a time (medium_stretch.h).
 *
 * Results equal medium_of_piece() to the bit. The scalar version calls that function for each
 * piece, and is the reference. The versions for newer instructions come from one template
 * (medium_batch_template.h).
 */
#ifndef RENDER_MEDIUM_MEDIUM_BATCH_H
#define RENDER_MEDIUM_MEDIUM_BATCH_H

#include "formats/base/cpu.h"
#include "render/medium/medium_cuts.h"

typedef struct medium_batch {
    const transfer *transfer;
    double share, drop; /* of all rules; the rest is per piece: */
    _Alignas(64) double per_length[SEGMENT_COLUMNS];
    double t_error[SEGMENT_COLUMNS], value_error[SEGMENT_COLUMNS];
    /* What is seen: a medium_stretch for each piece. seen[i] is 0: nothing is seen, and the rest is
     * not set.
     */
    double rgb[3][SEGMENT_COLUMNS], through[SEGMENT_COLUMNS];
    double rgb_error[SEGMENT_COLUMNS], through_error[SEGMENT_COLUMNS];
    uint8_t seen[SEGMENT_COLUMNS];
    /* Between the two passes of a vector version: each piece's value error, and the pieces that are
     * cut. */
    double error[SEGMENT_COLUMNS];
    medium_cuts cuts;
    /* Counts for tests: pieces left to the scalar code, cuts, stretches, and stretches done in
     * steps. */
    unsigned long alone, cut, stretches, stepped;
} medium_batch;

/* Does all pieces in the columns. May also read columns behind the last one. */
typedef void (*medium_batch_fn)(medium_batch *m, const segment_columns *pieces);

/* By ISA (cpu.h). */
extern const medium_batch_fn medium_batch_kernels[CPU_ISAS];

/* medium_batch_put() - store what is seen of piece i. */
void medium_batch_put(medium_batch *m, unsigned i, const medium_stretch *seen);

/* ---- For versions ---- */

/* medium_batch_single() - compute piece i by the scalar code. */
void medium_batch_single(medium_batch *m, const segment_columns *pieces, unsigned i);

/* medium_batch_join() - join the stretches of cut pieces, and store what is seen of each piece. */
void medium_batch_join(medium_batch *m, const segment_columns *pieces);

#endif
