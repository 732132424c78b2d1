/* trilinear.h - trilinear forms by their coefficients, and how far three of them are from linear.
 *
 * Coefficient c belongs to the product of those parameters that are the bits of c; parameters are
 * from -1 to 1, 0 in the middle. Three forms of three parameters are a map. Its inverse Jacobian in
 * the middle makes of the map the parameters themselves and a bent rest.
 */
#ifndef FORMATS_BASE_TRILINEAR_H
#define FORMATS_BASE_TRILINEAR_H

#include <stdbool.h>

#include "formats/base/vec3.h"

enum { TRILINEAR = 8 };

/* trilinear_of() - the form that has these values at the corners; corner c is where the parameters
 * that are bits of c are 1, the others -1. */
static inline void trilinear_of(const double v[TRILINEAR], double form[TRILINEAR]) {
    double pair[TRILINEAR], face[TRILINEAR];
    for (int c = 0; c < TRILINEAR; c += 2) {
        pair[c] = v[c + 1] + v[c];
        pair[c + 1] = v[c + 1] - v[c];
    }
    for (int c = 0; c < TRILINEAR; c += 4)
        for (int i = 0; i < 2; i++) {
            face[c + i] = pair[c + 2 + i] + pair[c + i];
            face[c + 2 + i] = pair[c + 2 + i] - pair[c + i];
        }
    for (int i = 0; i < 4; i++) {
        form[i] = 0.125 * (face[4 + i] + face[i]);
        form[4 + i] = 0.125 * (face[4 + i] - face[i]);
    }
}

/* trilinear_at() - its value; trilinear_slope() - its derivatives by the parameters;
 * trilinear_size() - the sum of its coefficients' sizes. */
static inline double trilinear_at(const double f[TRILINEAR], const double x[3]) {
    const double low = (f[0] + x[0] * f[1]) + x[1] * (f[2] + x[0] * f[3]);
    const double high = (f[4] + x[0] * f[5]) + x[1] * (f[6] + x[0] * f[7]);
    return low + x[2] * high;
}

static inline void trilinear_slope(const double f[TRILINEAR], const double x[3], double slope[3]) {
    slope[0] = (f[1] + x[1] * f[3]) + x[2] * (f[5] + x[1] * f[7]);
    slope[1] = (f[2] + x[0] * f[3]) + x[2] * (f[6] + x[0] * f[7]);
    slope[2] = (f[4] + x[0] * f[5]) + x[1] * (f[6] + x[0] * f[7]);
}

double trilinear_size(const double form[TRILINEAR]);

/* trilinear_restrict() - make it the same form of parameters that are -1 to 1 in a part of the box.
 */
void trilinear_restrict(double form[TRILINEAR], const double middle[3], const double half[3]);

/* trilinear_invert() - the inverse of a Jacobian: column k is inverse[k]. Returns the determinant;
 * where it is 0 or nearly, the inverse is not finite, or useless. */
static inline double trilinear_invert(const double slope[3][3], double inverse[3][3]) {
    for (int k = 0; k < 3; k++)
        vec3_cross(slope[(k + 1) % 3], slope[(k + 2) % 3], inverse[k]);
    const double det = vec3_dot(slope[0], inverse[0]), share = 1.0 / det;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            inverse[k][i] *= share;
    return det;
}

/* All of it errs by TRILINEAR_ROOM of itself and of 1 at most. */
typedef struct trilinear_bend {
    double at[3];     /* the parameters where all forms would be 0, without the rest */
    double two[3][3]; /* of the rest: [n][i]: in parameter i, the size of its coefficient of the
                         product of the two other than n; */
    double all[3];    /* and of the product of all three */
    double det;       /* the Jacobian's determinant in the middle */
} trilinear_bend;

#define TRILINEAR_ROOM 0x1p-20

/* trilinear_bend_of() - rounding: by how much a form's coefficients may err. False: the Jacobian is
 * too flat, or rounding too large. */
bool trilinear_bend_of(const double form[3][TRILINEAR], const double rounding[3],
                       trilinear_bend *out);

/* trilinear_is_single() - whether the map has no value twice in the box that is larger by a factor;
 * nor is any matrix singular whose columns are its derivatives, each at a place of its own. Then
 * two places are apart by TRILINEAR_STRETCH times what the parameters of their values are, at most.
 */
#define TRILINEAR_STRETCH 64.0
bool trilinear_is_single(const trilinear_bend *b, double larger);

#endif
