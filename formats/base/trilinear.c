#include "formats/base/trilinear.h"

#include <math.h>

#include "formats/base/vec3.h"

double trilinear_size(const double f[TRILINEAR]) {
    return ((fabs(f[0]) + fabs(f[1])) + (fabs(f[2]) + fabs(f[3]))) +
           ((fabs(f[4]) + fabs(f[5])) + (fabs(f[6]) + fabs(f[7])));
}

void trilinear_restrict(double f[TRILINEAR], const double middle[3], const double half[3]) {
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < TRILINEAR; c++)
            if (!(c & 1 << a)) {
                f[c] += middle[a] * f[c | 1 << a];
                f[c | 1 << a] *= half[a];
            }
}

/* What the inverse makes of one coefficient of each form. */
static void straighten(const double inverse[3][3], const double f[3][TRILINEAR], int c,
                       double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = (inverse[0][i] * f[0][c] + inverse[1][i] * f[1][c]) + inverse[2][i] * f[2][c];
}

/* At this share of its rows' sizes the determinant has 2^-33 of rounding at most, and so has the
 * inverse times the Jacobian. */
#define FLATTEST 0x1p-16
/* Of what the coefficients' rounding makes in a parameter. */
#define MOST (0.5 * TRILINEAR_ROOM)

bool trilinear_bend_of(const double form[3][TRILINEAR], const double rounding[3],
                       trilinear_bend *out) {
    double slope[3][3], inverse[3][3];
    for (int k = 0; k < 3; k++) {
        slope[k][0] = form[k][1];
        slope[k][1] = form[k][2];
        slope[k][2] = form[k][4];
    }
    out->det = trilinear_invert(slope, inverse);
    if (!(fabs(out->det) >
          FLATTEST * (vec3_size(slope[0]) * vec3_size(slope[1]) * vec3_size(slope[2]))))
        return false;
    straighten(inverse, form, 0, out->at);
    straighten(inverse, form, 6, out->two[0]);
    straighten(inverse, form, 5, out->two[1]);
    straighten(inverse, form, 3, out->two[2]);
    straighten(inverse, form, 7, out->all);
    for (int i = 0; i < 3; i++) {
        const double off = fabs(inverse[0][i]) * rounding[0] + fabs(inverse[1][i]) * rounding[1] +
                           fabs(inverse[2][i]) * rounding[2];
        if (!(off <= MOST))
            return false;
        for (int n = 0; n < 3; n++)
            out->two[n][i] = fabs(out->two[n][i]);
        out->all[i] = fabs(out->all[i]);
        out->at[i] = -out->at[i];
    }
    return true;
}

/* What a power of the bounds of the rest's slopes, a matrix, may be. */
#define SHARE 0.75

/* Two places with one value would differ by what the rest changes between them: by no more than
 * that matrix times their difference. Where a power of the matrix is small there is no such
 * difference. Likewise for what a singular matrix makes 0. How far two places can be apart whose
 * values are near follows from the sum of all powers, a geometric series. */
bool trilinear_is_single(const trilinear_bend *b, double larger) {
    enum { POWERS = 4 };
    double size[3] = {1.0, 1.0, 1.0}, lower[3] = {0.0, 0.0, 0.0};
    bool single = true;
    for (int power = 0; power < POWERS; power++) {
        const double sum[3] = {size[1] + size[2], size[2] + size[0], size[0] + size[1]};
        const double every = size[0] + sum[0];
        for (int i = 0; i < 3; i++) {
            lower[i] += size[i];
            size[i] =
                larger * ((b->two[0][i] * sum[0] + b->two[1][i] * sum[1]) + b->two[2][i] * sum[2]) +
                larger * larger * (b->all[i] * every);
        }
    }
    for (int i = 0; i < 3; i++)
        single = single && size[i] <= SHARE && lower[i] <= (1.0 - SHARE) * TRILINEAR_STRETCH;
    return single;
}
