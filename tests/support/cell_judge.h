/* cell_judge.h - whether what can be asked of a volume of cells, surfaces apart, is right at every
 * step: pieces, media, projections, slices, points and their gradients, under any budget, and in
 * previews. For kinds of records, whose test says by brute force what a ray and a point meet.
 * Surfaces and shadows are that test's own. Trouble fails the running test.
 *
 * The volume: some hundred cells in four treelets or more, so dense that a random ray passes one,
 * and so rough that a preview without a treelet is off.
 */
#ifndef TESTS_SUPPORT_CELL_JUDGE_H
#define TESTS_SUPPORT_CELL_JUDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "tests/support/leaf_image.h"

/* The part of a line in a cell. */
typedef struct cell_chord {
    long double t0, t1;
    long double least, most, mean; /* of the value */
    uint64_t number;               /* of the cell */
} cell_chord;

enum { CELL_CHORDS_MAX = 256 };

/* What is true, in long double, sharing no code with the kind. */
typedef struct cell_truth {
    const void *ctx;
    uint32_t steps;
    double most; /* no value is greater; none is below 0 */
    /* Write what the line passes, in any order. Returns how many. *grazing: rounding may decide
     * whether something is passed. */
    int (*chords)(const void *ctx, uint32_t step, const double origin[3], const double direction[3],
                  cell_chord out[CELL_CHORDS_MAX], bool *grazing);
    /* The value at a point; false: no cell is there. *grazing as above. */
    bool (*value)(const void *ctx, uint32_t step, const double point[3], long double *value,
                  bool *grazing);
} cell_truth;

/* cell_judge() - judge a file. Its cells do not overlap. */
void cell_judge(const leaf_image *image, const cell_truth *truth);

#endif
