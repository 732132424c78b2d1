/* medium_batch.h - what is seen of many pieces at a time (medium_stretch.h).
 *
 * The answer for a piece is, to the bit, that of medium_of_piece(). Versions for newer instructions
 * come from one template (medium_batch_template.h); the scalar one asks that function, and is the
 * truth.
 */
#ifndef RENDER_MEDIUM_MEDIUM_BATCH_H
#define RENDER_MEDIUM_MEDIUM_BATCH_H

#include "formats/base/cpu.h"
#include "render/medium/medium_cuts.h"

typedef struct medium_batch {
    const transfer *transfer;
    double share, drop; /* of all rules; the rest of each piece's: */
    _Alignas(64) double per_length[SEGMENT_COLUMNS];
    double t_error[SEGMENT_COLUMNS], value_error[SEGMENT_COLUMNS];
    /* What is seen: a medium_stretch a piece. Nothing where seen[i] is 0; then the rest is not set.
     */
    double rgb[3][SEGMENT_COLUMNS], through[SEGMENT_COLUMNS];
    double rgb_error[SEGMENT_COLUMNS], through_error[SEGMENT_COLUMNS];
    uint8_t seen[SEGMENT_COLUMNS];
    /* Between the two steps of a version for vectors: how far each piece's value is off, and those
     * that are cut. */
    double error[SEGMENT_COLUMNS];
    medium_cuts cuts;
    /* So far, for tests: pieces left to the scalar code; cuts, stretches, and those gone through in
     * steps. */
    unsigned long alone, cut, stretches, stepped;
} medium_batch;

/* Of all pieces in the columns; columns behind the last one may be read, too. */
typedef void (*medium_batch_fn)(medium_batch *m, const segment_columns *pieces);

/* By ISA (cpu.h). */
extern const medium_batch_fn medium_batch_kernels[CPU_ISAS];

/* medium_batch_put() - what is seen of piece i. */
void medium_batch_put(medium_batch *m, unsigned i, const medium_stretch *seen);

/* ---- For versions ---- */

/* medium_batch_single() - piece i alone. */
void medium_batch_single(medium_batch *m, const segment_columns *pieces, unsigned i);

/* medium_batch_join() - the stretches of cut pieces to what is seen of those. */
void medium_batch_join(medium_batch *m, const segment_columns *pieces);

#endif
