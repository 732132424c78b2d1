/* block_lab.h - the laboratory of blocks of cells: what one cell leaves, the next one takes up.
 *
 * Rays through small blocks, at random, aimed at grid points, and along exact lines in planes,
 * along edges and through vertices, from outside and from inside. The kernel must visit the very
 * cells that the reference walks through, see the same value, to the bit, from both sides of a
 * face, and list the reference's surfaces.
 */
#ifndef TESTS_SUPPORT_BLOCK_LAB_H
#define TESTS_SUPPORT_BLOCK_LAB_H

#include "formats/base/pool.h"
#include "tests/support/ref_judge.h"

typedef struct block_lab_job {
    int which;
    uint64_t seed, count; /* rays */
    const char *rerun;    /* how a printed line begins: the program */
    FILE *log;
} block_lab_job;

/* block_lab_count(), block_lab_name() - the blocks there are. */
int block_lab_count(void);
const char *block_lab_name(int which);

/* block_lab_run() - the rays of one block. The tally does not depend on the threads; broken counts
 * rays of which the cells visited, or the values at their faces, are wrong. */
CHECKED status block_lab_run(pool *p, const block_lab_job *job, ref_tally *tally, uint64_t *broken);

/* block_lab_rerun() - PROGRAM block NAME SEED INDEX; argv[0] is NAME. Returns 0, 1 when a fault is
 * there, 2 when the arguments make no sense. */
int block_lab_rerun(int argc, char **argv);

#endif
