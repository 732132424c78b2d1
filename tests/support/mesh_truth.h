/* mesh_truth.h - the gradients at a mesh's vertices as plain sums in long double. */
#ifndef TESTS_SUPPORT_MESH_TRUTH_H
#define TESTS_SUPPORT_MESH_TRUTH_H

#include "tests/support/mesh_cases.h"

/* Of the tets around a vertex: gradients by volumes, what these are summed up from, volumes; all
 * times 6. */
typedef struct mesh_truth {
    long double sum[3], moduli, volume;
} mesh_truth;

/* mesh_truth_gradients() - of each point; to be freed. */
mesh_truth *mesh_truth_gradients(const mesh_case *c);

/* mesh_truth_check() - fails the test unless a gradient is right to a float's rounding, and to that
 * of sums in double; 0 0 0 where no tet has one. */
void mesh_truth_check(const mesh_truth *t, const float got[3], size_t vertex);

#endif
