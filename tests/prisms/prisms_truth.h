/* prisms_truth.h - what a line and a point meet in prisms, by brute force in long double. Shares no
 * code with the kind.
 */
#ifndef TESTS_PRISMS_PRISMS_TRUTH_H
#define TESTS_PRISMS_PRISMS_TRUTH_H

#include "tests/prisms/prisms.h"
#include "tests/support/cell_judge.h"

typedef struct prisms_truth {
    const prism *prisms;
    uint32_t count;
} prisms_truth;

/* prisms_truth_chords() - the parts of the line in each prism, in the file's order; how many.
 * *grazing: one is passed so near to an edge that rounding may decide. */
int prisms_truth_chords(const prisms_truth *s, const double origin[3], const double direction[3],
                        cell_chord out[CELL_CHORDS_MAX], bool *grazing);

/* prisms_truth_at() - the value at a point; false: no prism is there. */
bool prisms_truth_at(const prisms_truth *s, const double point[3], long double *value,
                     bool *grazing);

#endif
