/* quadratic_truth.h - where rays meet isosurfaces of quadratic tets: brute force in long double,
 * which shares nothing with render/curved/.
 *
 * Three quadratic equations in the tet's parameters: the point is on the ray, by two planes through
 * it, and has the isovalue. The cube about the tet is cut into eight again and again, until in each
 * part one of the equations, or of three combinations of them, cannot be met, or the three are so
 * nearly linear that there is one solution at most.
 */
#ifndef TESTS_SUPPORT_QUADRATIC_TRUTH_H
#define TESTS_SUPPORT_QUADRATIC_TRUTH_H

#include "formats/base/quadratic_tet.h"

enum { QUADRATIC_TRUTH_ROOTS = 32 };

typedef struct quadratic_truth {
    int count;
    long double t[QUADRATIC_TRUTH_ROOTS]; /* in order */
    bool entering[QUADRATIC_TRUTH_ROOTS];
    bool doubtful; /* a root within 1e-9 of a face, in parameters, or a ray that nearly touches */
} quadratic_truth;

/* quadratic_truth_of() - nodes as of a quadratic_tet. straight: edges whose node counts as the
 * middle, as bits. */
void quadratic_truth_of(const quadratic_tet *c, unsigned straight, double isovalue,
                        const double o[3], const double d[3], quadratic_truth *out);

/* quadratic_truth_value() - the value at t of the ray, in the cell; at: parameters near there, in;
 * those there, out. False: not found. */
bool quadratic_truth_value(const quadratic_tet *c, unsigned straight, const double o[3],
                           const double d[3], double t, long double at[3], long double *out);

#endif
