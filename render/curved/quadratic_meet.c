#include "render/curved/quadratic_meet.h"

#include <math.h>

#include "formats/base/vec3.h"

#define MARGIN 0x1p-20 /* of shares: a root so close to a face is left to it */
#define SLANT  0x1p-26 /* slopes that are flatter than this have no inverse to rely on */

/* By how much at most three forms' bent rests, and what rounding took from them, may move a share.
 * column k of the inverse: what changes form k by 1. The last is of corner 0. */
static void find_stray(const double *const form[3], const double column[3][3],
                       double stray[QUADRATIC_CORNERS]) {
    const double reach = 0.75; /* of a share from the middle's */
    double bend[3][6], rounding[3];
    for (int k = 0; k < 3; k++) {
        double most = 0.0;
        quadratic_twist(form[k], bend[k], bend[k] + 3);
        for (int n = 0; n < QUADRATIC_NODES; n++)
            most = real_max(most, fabs(form[k][n]));
        rounding[k] = 0x1p-48 * most;
    }
    for (int i = 0; i < QUADRATIC_CORNERS; i++) {
        stray[i] = MARGIN;
        double row[3];
        for (int k = 0; k < 3; k++) {
            row[k] = i < 3 ? column[k][i] : column[k][0] + column[k][1] + column[k][2];
            stray[i] += fabs(row[k]) * rounding[k];
        }
        for (int n = 0; n < 6; n++)
            stray[i] += reach * reach *
                        fabs(row[0] * bend[0][n] + row[1] * bend[1][n] + row[2] * bend[2][n]);
    }
}

/* Whether the ray surely has no point of the isosurface in the tet. */
static bool is_off(const curved_map *m, double isovalue) {
    static const double middle[3] = {0.25, 0.25, 0.25};
    double value[QUADRATIC_NODES], slope[3][3], column[3][3], stray[QUADRATIC_CORNERS], sum = 0.0;
    const double *const form[3] = {m->q[0], m->q[1], value};
    for (int n = 0; n < QUADRATIC_NODES; n++)
        value[n] = m->value[n] - isovalue;
    for (int k = 0; k < 3; k++)
        quadratic_slope(form[k], middle, slope[k]);
    for (int k = 0; k < 3; k++)
        vec3_cross(slope[(k + 1) % 3], slope[(k + 2) % 3], column[k]);
    const double det = vec3_dot(slope[0], column[0]);
    if (!(fabs(det) > SLANT * vec3_size(slope[0]) * vec3_size(slope[1]) * vec3_size(slope[2])))
        return false;
    double share[QUADRATIC_CORNERS] = {0.25, 0.25, 0.25, 0.25};
    for (int k = 0; k < 3; k++) {
        const double off = quadratic_at(form[k], middle);
        for (int i = 0; i < 3; i++) {
            column[k][i] /= det;
            share[i] -= column[k][i] * off;
        }
    }
    for (int i = 0; i < 3; i++)
        sum += share[i];
    share[3] = 1.0 - sum;
    find_stray(form, (const double(*)[3])column, stray);
    for (int i = 0; i < QUADRATIC_CORNERS; i++)
        if (share[i] < -stray[i] || share[i] > 1.0 + stray[i])
            return true;
    return false;
}

int quadratic_meet_roots(const quadratic_tet *c, int sense, const sheared_ray *r, double isovalue,
                         path_root out[PATH_ROOTS], path_counts *counts) {
    quadratic_path path;
    if (!quadratic_path_place(c, r, &path) || (sense != 0 && is_off(&path.map, isovalue)) ||
        quadratic_path_cross(c, sense, r, &path) == 0)
        return 0;
    return path_roots(&path.map, path.part, path.count, sense == 0, isovalue, out, counts);
}
