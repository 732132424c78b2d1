/* heights_truth.h - where a line meets terrain, by brute force in long double: every cell on its
 * own, each monotone stretch of its quadratic bisected. Shares no code with the renderer.
 */
#ifndef TESTS_SUPPORT_HEIGHTS_TRUTH_H
#define TESTS_SUPPORT_HEIGHTS_TRUTH_H

#include <stdbool.h>

typedef struct heights_truth {
    int nx, ny;
    const float *heights;         /* x fastest; NaN: none */
    double spacing[2], origin[2]; /* world place of node (0, 0) */
    double scale;                 /* world z of a height of 1 */
} heights_truth;

typedef struct heights_meeting {
    long double t;
    bool entering; /* from above */
    int cell;      /* i + (nx - 1) * j */
} heights_meeting;

enum { HEIGHTS_MEETINGS_MAX = 4096 };

/* heights_truth_meetings() - all of a line for t from t0 to t1, in order, as the line moved by
 * `shift` in world space has them; returns how many. */
int heights_truth_meetings(const heights_truth *h, const double origin[3],
                           const double direction[3], const double shift[3], long double t0,
                           long double t1, heights_meeting out[HEIGHTS_MEETINGS_MAX]);

#endif
