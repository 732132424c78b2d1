/* cell_lab.h - the laboratory of single cells: every intersector on the hostile ray-cells of
 * ray_cells.h, judged by the reference.
 *
 * A ray-cell is solved once by the reference, then by each intersector. Where it differs and the
 * ray lies in the grazing band of ref_judge.h, it is excused and counts for nothing else; outside,
 * an intersector is charged with:
 *
 *   missed    surfaces of the reference that it does not list
 *   false     surfaces that it alone lists
 *   too far   listed by both, more than REF_GRAZING_CHANGE of a cell and an ulp apart
 *   disorder  (marmitt alone) resumed from hit to hit it tells another story than at once, or
 *             names the wrong sides; (any) more than three surfaces in a cell
 *
 *   unlike    (marmitt alone) ray-cells of which the kernels for sixteen at a time
 *             (cell_batch.h), with any ISA of this CPU, give another first hit, by a single bit
 *   thin      pairs that one alone lists, no more than 1e-5 of a cell apart, between which f stays
 *             within 16 units of a double's last place (of the largest |sample - iso|): films of
 *             which doubles can tell nothing; counted apart, and allowed only as cell_lab_faults()
 *             says
 *
 * Lists of different lengths are matched in order, so that the errors add up to the least. A pair
 * within REF_GRAZING_CHANGE of a surface that both see makes no other picture: no fault.
 */
#ifndef TESTS_SUPPORT_CELL_LAB_H
#define TESTS_SUPPORT_CELL_LAB_H

#include <stdint.h>
#include <stdio.h>

#include "formats/base/pool.h"
#include "render/experiments/intersect.h"
#include "tests/support/holes.h"

typedef struct cell_lab_tally {
    uint64_t cells;    /* ray-cells */
    uint64_t grazing;  /* of these, those in the band; */
    uint64_t excused;  /* and of those, the ones that differ: they count for nothing below */
    uint64_t surfaces; /* that the reference sees */
    uint64_t missed, false_hits, too_far, disorder, unlike, thin;
    uint64_t matched; /* surfaces listed by both */
    double worst;     /* their error, in cells */
    double sum_squares;
} cell_lab_tally;

/* One case, intersector by intersector in the order of intersector_at(). */
typedef struct cell_lab_row {
    cell_lab_tally of[INTERSECTOR_COUNT];
} cell_lab_row;

enum { CELL_LAB_HOLES = -1 };

/* What is asked: `count` ray-cells of a case from index `first` on. */
typedef struct cell_lab_job {
    int which;      /* of ray_cells.h; or CELL_LAB_HOLES: */
    const holes *h; /* those of holes.h, with this seed */
    uint64_t seed, first, count;
    unsigned exact;    /* bit per intersector: its faults are printed on log */
    const char *rerun; /* how a printed line begins: the program */
    FILE *log;
} cell_lab_job;

/* cell_lab_name() - of a case; that of the holes is "nan-inf". */
const char *cell_lab_name(int which);

/* cell_lab_exact() - the intersectors that must make no fault: marmitt. */
unsigned cell_lab_exact(void);

/* cell_lab_run() - the result does not depend on the threads. At most three lines a call are
 * printed of each intersector's faults, each of which ends with what reruns it. */
CHECKED status cell_lab_run(pool *p, const cell_lab_job *job, cell_lab_row *row);

/* cell_lab_faults() - missed, false, too far, disorder; the thin ones where they are more than one
 * in 10000 ray-cells. */
uint64_t cell_lab_faults(const cell_lab_tally *tally);

double cell_lab_rms(const cell_lab_tally *tally);

/* A table, one line a case and intersector; the same as CSV. */
void cell_lab_heading(FILE *out);
void cell_lab_print(FILE *out, const char *name, const cell_lab_row *row);
void cell_lab_csv_heading(FILE *out);
void cell_lab_csv(FILE *out, const char *name, const cell_lab_row *row);

/* cell_lab_rerun() - PROGRAM cell CASE SEED INDEX [INTERSECTOR...]: one ray-cell with all answers
 * on stdout, judged as exact for the intersectors named (none: marmitt). Returns 0, 1 when a fault
 * is there, 2 when the arguments make no sense. argv[0] is CASE. */
int cell_lab_rerun(int argc, char **argv);

#endif
