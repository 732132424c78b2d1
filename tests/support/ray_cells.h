/* ray_cells.h - rays through single cells, random and hostile, by name: what a cell kernel must
 * survive.
 *
 * A ray-cell is a pure function of (case, seed, index): a failure is rerun by these three numbers.
 */
#ifndef TESTS_SUPPORT_RAY_CELLS_H
#define TESTS_SUPPORT_RAY_CELLS_H

#include <stdint.h>

typedef struct ray_cell {
    double o[3], d[3];   /* grid space, t >= 0 */
    double lo[3], hi[3]; /* the cell's planes */
    float samples[8];    /* x fastest */
    double iso;
} ray_cell;

/* ray_cell_case_count(), ray_cell_case_name() - double-root, triple-root, near-tangent, in-plane
 * ... */
int ray_cell_case_count(void);
const char *ray_cell_case_name(int which);

/* ray_cell_case() - the case of a name, -1 when unknown. */
int ray_cell_case(const char *name);

/* ray_cell_make() - the index-th ray-cell of a case. */
void ray_cell_make(int which, uint64_t seed, uint64_t index, ray_cell *out);

#endif
