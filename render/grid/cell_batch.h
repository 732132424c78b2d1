/* cell_batch.h - sixteen ray-cells at a time: the first surface of each.
 *
 * A lane's answer equals, to the bit, cell_visit_of() followed by cell_next_hit() for every
 * isovalue, searching from before all hits. It does not depend on the other lanes. The scalar
 * version calls these functions and is the truth. One template makes the versions for newer
 * instructions (cell_batch_template.h).
 */
#ifndef RENDER_GRID_CELL_BATCH_H
#define RENDER_GRID_CELL_BATCH_H

#include <stdint.h>

#include "formats/base/cpu.h"

enum { CELL_BATCH = 16 };

/* Ray-cells, one a lane. Planes are relative to the ray's origin: plane - o, in double. */
typedef struct cell_batch {
    _Alignas(64) double d[3][CELL_BATCH];        /* none is 0: see CELL_ALONG */
    double t0[CELL_BATCH], t1[CELL_BATCH];       /* the ray's interval */
    double lo[3][CELL_BATCH], hi[3][CELL_BATCH]; /* planes, lo < hi */
    double inv[3][CELL_BATCH];                   /* 1 / (hi - lo), as in cell_box */
    float samples[8][CELL_BATCH];                /* corner x + 2y + 4z, finite */
} cell_batch;

/* CELL_ALONG replaces a direction component of 0, as of a ray parallel to the planes of an axis.
 * The ray then meets these planes so far away that they do not cut it, and rounding removes t *
 * CELL_ALONG beside plane - o. So the answer is the same as for 0, to the bit, if
 * |plane - o| >= CELL_ALONG_NEAR and |t| <= CELL_ALONG_T. */
#define CELL_ALONG      0x1p-960
#define CELL_ALONG_NEAR 0x1p-500
#define CELL_ALONG_T    0x1p400

/* Bit k of a mask is lane k. */
typedef struct cell_batch_hits {
    _Alignas(64) double t[CELL_BATCH]; /* set where found */
    int32_t iso[CELL_BATCH];           /* index into the isovalues, set where found */
    uint32_t found, entering;          /* entering: only where found */
    uint32_t at_exit; /* found, and t is where the ray leaves the cell: another cell may hold the
                         same t */
} cell_batch_hits;

/* Finds the first hits of lanes 0 .. lanes - 1 of *b, each the least in (t, iso). 1 <= lanes <=
 * CELL_BATCH; the other lanes may hold anything. */
typedef void (*cell_batch_fn)(const cell_batch *b, int lanes, const double *isovalues, int count,
                              cell_batch_hits *out);

/* All roots, which are changes of side. A lane's roots come in the order of t, t[0] first. Bit k of
 * a mask is lane k. */
enum { CELL_ROOTS_MAX = 3 };

typedef struct cell_batch_roots {
    _Alignas(64) double t[CELL_ROOTS_MAX][CELL_BATCH];
    uint32_t found[CELL_ROOTS_MAX], entering[CELL_ROOTS_MAX], at_exit[CELL_ROOTS_MAX];
} cell_batch_roots;

/* Finds all roots of these lanes for one isovalue: the hits that cell_next_hit() finds one after
 * the other. */
typedef void (*cell_roots_fn)(const cell_batch *b, int lanes, double isovalue,
                              cell_batch_roots *out);

/* By ISA (cpu.h). */
extern const cell_batch_fn cell_batch_kernels[CPU_ISAS];
extern const cell_roots_fn cell_roots_kernels[CPU_ISAS];

#endif
