#include "formats/leaf/leaf_place.h"

#include <math.h>
#include <stdio.h>

/* The length of a column, and its unit vector, without over- or underflow; 0 if it is zero or not
 * finite. */
static double length_of(const double *w, int a, double unit[3]) {
    const double x = w[a], y = w[4 + a], z = w[8 + a];
    const double largest = fmax(fabs(x), fmax(fabs(y), fabs(z)));
    if (!(largest > 0) || !isfinite(largest))
        return 0;
    const double s[3] = {x / largest, y / largest, z / largest};
    const double length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
    for (int i = 0; i < 3; i++)
        unit[i] = s[i] / length;
    return length * largest;
}

/* The volume of the box of three columns, each scaled to unit length: 1 if all are at right angles,
 * near 0 if they nearly lie in a plane. */
static double spread(const double c[3][3]) {
    return fabs(c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) -
                c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0]) +
                c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0]));
}

static bool check_step(double step, int a, char *why) {
    if (step >= LEAF_STEP_MIN && step <= LEAF_STEP_MAX)
        return true;
    snprintf(why, LEAF_PLACE_TEXT,
             "its samples are %g apart along %c; %.2g to %.2g is possible: scale it", step,
             "xyz"[a], LEAF_STEP_MIN, LEAF_STEP_MAX);
    return false;
}

static bool check_far(double far, double step, char *why) {
    if (far <= LEAF_FAR_MAX && far <= LEAF_FAR_STEPS * step)
        return true;
    snprintf(
        why, LEAF_PLACE_TEXT,
        "it lies %g from the origin, with samples %g apart: too far for its samples to be told "
        "from each other",
        far, step);
    return false;
}

bool leaf_place_grid(const double *w, char why[LEAF_PLACE_TEXT]) {
    double unit[3][3] = {{0}}, length[3];
    for (int i = 0; i < 12; i++)
        if (!isfinite(w[i])) {
            snprintf(why, LEAF_PLACE_TEXT, "spacing, directions or origin not finite");
            return false;
        }
    for (int a = 0; a < 3; a++)
        length[a] = length_of(w, a, unit[a]);
    if (!(spread((const double(*)[3])unit) > LEAF_SPREAD_MIN)) {
        snprintf(why, LEAF_PLACE_TEXT,
                 "the axes do not span space (a zero spacing, or directions that lie in a plane)");
        return false;
    }
    for (int a = 0; a < 3; a++)
        if (!check_step(length[a], a, why))
            return false;
    const double far = fmax(fabs(w[3]), fmax(fabs(w[7]), fabs(w[11])));
    return check_far(far, fmax(length[0], fmax(length[1], length[2])), why);
}

bool leaf_place_axis(const double *w, int a, const double *x, uint32_t count,
                     char why[LEAF_PLACE_TEXT]) {
    double unit[3];
    const double length = length_of(w, a, unit);
    double least = HUGE_VAL, most = 0;
    for (uint32_t i = 1; i < count; i++) {
        least = fmin(least, x[i] - x[i - 1]);
        most = fmax(most, x[i] - x[i - 1]);
    }
    return check_step(length * least, a, why) && check_step(length * most, a, why) &&
           check_far(length * fmax(fabs(x[0]), fabs(x[count - 1])), length * most, why);
}

bool leaf_place_mesh(const float b[6], char why[LEAF_PLACE_TEXT]) {
    double extent = 0;
    for (int a = 0; a < 3; a++)
        extent = fmax(extent, (double)b[a + 3] - (double)b[a]);
    if (extent == 0 || extent >= LEAF_EXTENT_MIN)
        return true;
    snprintf(why, LEAF_PLACE_TEXT,
             "its points lie within %g of each other; %.2g or more is possible: scale it", extent,
             LEAF_EXTENT_MIN);
    return false;
}
