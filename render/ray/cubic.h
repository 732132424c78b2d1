/* cubic.h - monotony and extrema of a cubic, for the cell kernel and for pieces of rays. */
#ifndef RENDER_RAY_CUBIC_H
#define RENDER_RAY_CUBIC_H

#include <math.h>
#include <stdbool.h>

/* cubic_is_monotone() - whether the Bernstein coefficients b rise or fall throughout; then so does
 * the cubic. False does not mean that the cubic turns. */
static inline bool cubic_is_monotone(const double b[4]) {
    return (b[0] <= b[1] && b[1] <= b[2] && b[2] <= b[3]) ||
           (b[0] >= b[1] && b[1] >= b[2] && b[2] >= b[3]);
}

/* cubic_extrema() - find the extrema of a cubic in Bernstein form strictly inside (0, 1),
 * ascending. Returns their number, 0 to 2. */
static inline int cubic_extrema(const double b[4], double at[2]) {
    /* f' / 3 = q0 (1-s)^2 + 2 q1 s (1-s) + q2 s^2 */
    double q0 = b[1] - b[0], q1 = b[2] - b[1], q2 = b[3] - b[2];
    double half_b = q1 - q0, a = (q2 - q1) - half_b;
    double discriminant = q1 * q1 - q0 * q2;
    if (!(discriminant >= 0.0))
        return 0;
    /* The stable quadratic formula: no subtraction of nearly equal terms. */
    double w = -(half_b + (half_b >= 0.0 ? sqrt(discriminant) : -sqrt(discriminant)));
    double s0 = a != 0.0 ? w / a : -1.0;
    double s1 = w != 0.0 ? q0 / w : -1.0;
    if (s1 < s0) {
        double swap = s0;
        s0 = s1;
        s1 = swap;
    }
    int n = 0;
    if (s0 > 0.0 && s0 < 1.0)
        at[n++] = s0;
    if (s1 > 0.0 && s1 < 1.0 && (n == 0 || s1 > s0))
        at[n++] = s1;
    return n;
}

#endif
