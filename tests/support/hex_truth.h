/* hex_truth.h - where rays meet isosurfaces of hexahedra: brute force in long double, which shares
 * nothing with render/curved/.
 *
 * Three trilinear equations in the cell's parameters: the point is on the ray, by two planes
 * through it, and has the isovalue. The cube is cut into eight again and again, until in each part
 * one of the equations, or of three combinations of them, has one sign at all corners, or the three
 * are so nearly linear that there is one solution at most.
 */
#ifndef TESTS_SUPPORT_HEX_TRUTH_H
#define TESTS_SUPPORT_HEX_TRUTH_H

#include <stdbool.h>

enum { HEX_TRUTH_ROOTS = 32 };

typedef struct hex_truth {
    int count;
    long double t[HEX_TRUTH_ROOTS]; /* in order */
    bool entering[HEX_TRUTH_ROOTS];
    bool doubtful; /* a root within 1e-9 of a face, in parameters, or a ray that nearly touches */
} hex_truth;

/* hex_truth_of() - corner c is where the parameters are the bits of c. */
void hex_truth_of(const double p[8][3], const double value[8], double isovalue, const double o[3],
                  const double d[3], hex_truth *out);

/* hex_truth_value() - the value at t of the ray, in the cell; at: parameters near there, in; those
 * there, out. False: not found. */
bool hex_truth_value(const double p[8][3], const double value[8], const double o[3],
                     const double d[3], double t, long double at[3], long double *out);

#endif
