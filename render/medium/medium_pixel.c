#include "render/medium/medium_pixel.h"

#include <math.h>

double medium_pixel_error(const medium_stretch *seen, const float background[4]) {
    double brightest = 1.0;
    for (int c = 0; c < 3; c++)
        brightest = fmax(brightest, fabs((double)background[c]));
    /* The last term bounds the rounding of sums along the ray, which has fewer than 2^18 pieces. */
    return seen->rgb_error + (seen->through_error + 0x1p-33) * brightest;
}

double medium_pixel_most(double brightest, const float background[4], const double x[4]) {
    const double behind = (double)background[3];
    double most = 0.0;
    for (int c = 0; c < 4; c++) {
        const double all = c < 3 ? brightest * fmax(behind, 1.0) : fmax(behind, 1.0);
        const double none = c < 3 ? fmin((double)background[c] * behind, 0.0) : fmin(behind, 0.0);
        most = fmax(most, fmax(all - x[c], x[c] - none));
    }
    return most;
}
