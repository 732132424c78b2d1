/* spheres_truth.h - what a ray through balls meets, by brute force in long double. Shares no code
 * with the kind.
 */
#ifndef TESTS_SPHERES_SPHERES_TRUTH_H
#define TESTS_SPHERES_SPHERES_TRUTH_H

#include <stdbool.h>
#include <stdint.h>

#include "tests/spheres/spheres.h"
#include "tests/support/cell_judge.h"

typedef struct truth_hit {
    long double t;
    uint64_t number; /* of the ball */
    int iso;
    bool entering;
} truth_hit;

typedef struct spheres_truth {
    const sphere *spheres;
    uint32_t count;
    const double *isovalues;
    int isos;
} spheres_truth;

enum { TRUTH_HITS_MAX = 256 };

/* spheres_truth_hits() - all with t in [t0, t1], in order; how many. *grazing: some sphere is
 * passed so closely that rounding may decide whether it is met, or how far away, to 1e-12. */
int spheres_truth_hits(const spheres_truth *s, const double origin[3], const double direction[3],
                       double t0, double t1, truth_hit hits[TRUTH_HITS_MAX], bool *grazing);

/* spheres_truth_chords() - the parts of the line in each ball, in the file's order; how many. */
int spheres_truth_chords(const spheres_truth *s, const double origin[3], const double direction[3],
                         cell_chord out[CELL_CHORDS_MAX], bool *grazing);

/* spheres_truth_at() - the first ball that holds a point, and the value there; false: none. */
bool spheres_truth_at(const spheres_truth *s, const double point[3], uint64_t *number,
                      long double *value);

#endif
