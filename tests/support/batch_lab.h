/* batch_lab.h - what the kernels that take sixteen ray-cells at a time say about one, among fifteen
 * others: with every ISA of this CPU, to the bit what cell_next_hit() says. */
#ifndef TESTS_SUPPORT_BATCH_LAB_H
#define TESTS_SUPPORT_BATCH_LAB_H

#include "render/grid/cell_batch.h"
#include "render/grid/cell_kernel.h"

/* The last sixteen ray-cells, each in a lane; begins as zeros. */
typedef struct batch_lab {
    cell_batch lanes;
    int next;
    bool full;
} batch_lab;

/* batch_lab_put() - put a ray-cell beside the fifteen before it (the first one into every lane).
 * False, and nothing done, for what batches do not take: a d of 0, samples that are not finite. */
bool batch_lab_put(batch_lab *b, const ray *r, const cell_box *box, const float samples[8]);

/* batch_lab_unlike() - bit i: with cpu_isa i the last ray-cell put has another first hit than
 * *first; NULL: none. */
unsigned batch_lab_unlike(const batch_lab *b, double iso, const hit *first);

#endif
