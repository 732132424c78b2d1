/* triangle_truth.h - where a ray meets a surface, by brute force in long double: each triangle by
 * itself, by the signs of three determinants. It shares no code with the renderer.
 *
 * A ray is in doubt, and is not judged, where rays moved by a millionth of a mean edge disagree
 * about whether there is a surface, or about its distance by more than 1e-4 of an edge.
 */
#ifndef TESTS_SUPPORT_TRIANGLE_TRUTH_H
#define TESTS_SUPPORT_TRIANGLE_TRUTH_H

#include "tests/support/triangle_lab.h"

typedef struct triangle_tally {
    uint64_t rays, doubtful, surfaces, missed, invented, wrong;
    double worst; /* mean edges, of distances that are right */
} triangle_tally;

/* triangle_truth_first() - the first t > t0; INFINITY: there is none. nearest, not NULL: the number
 * of its triangle. */
long double triangle_truth_first(const triangle_lab *s, const double o[3], const double d[3],
                                 double t0, uint32_t *nearest);

/* triangle_truth_expect() - the first t > 0, INFINITY: there is none; NaN: the ray is in doubt. */
long double triangle_truth_expect(const triangle_lab *s, const double o[3], const double d[3]);

/* triangle_truth_judge() - judge t of a ray, +inf: no hit. False: it is wrong. */
bool triangle_truth_judge(const triangle_lab *s, const double o[3], const double d[3], double t,
                          triangle_tally *tally);

#endif
