#include "formats/curvilinear/curvilinear_cell.h"

#include <math.h>

#include "formats/base/vec3.h"

histogram_cell curvilinear_cell_none(float value) {
    return (histogram_cell){
        .value = isfinite(value) ? value : NAN, .lo = INFINITY, .hi = -INFINITY};
}

/* The derivative along an axis at the middle: the mean of the four edges along it. */
static void middle(const float *const corners[8], const float values[8], int axis, double edge[3],
                   double *rise) {
    *rise = edge[0] = edge[1] = edge[2] = 0;
    for (int c = 0; c < 8; c++) {
        const double sign = c >> axis & 1 ? 0.25 : -0.25;
        *rise += sign * (double)values[c];
        for (int a = 0; a < 3; a++)
            edge[a] += sign * (double)corners[c][a];
    }
}

histogram_cell curvilinear_cell_measure(const float *const corners[8], const float values[8]) {
    histogram_cell cell = curvilinear_cell_none(values[0]);
    float lo = INFINITY, hi = -INFINITY;
    for (int c = 0; c < 8; c++) {
        if (!isfinite(values[c]))
            return cell;
        lo = fminf(lo, values[c]);
        hi = fmaxf(hi, values[c]);
    }
    cell.lo = lo;
    cell.hi = hi;
    double edge[3][3], rise[3], normal[3], sum[3] = {0, 0, 0}, det = 0;
    for (int e = 0; e < 3; e++)
        middle(corners, values, e, edge[e], &rise[e]);
    for (int e = 0; e < 3; e++) {
        vec3_cross(edge[(e + 1) % 3], edge[(e + 2) % 3], normal);
        for (int a = 0; a < 3; a++) {
            sum[a] += rise[e] * normal[a];
            det += e == 0 ? edge[0][a] * normal[a] : 0;
        }
    }
    /* The gradient is sum / det, and the volume is |det|. */
    const double length = vec3_length(sum), span = (double)hi - (double)lo;
    if (det == 0 || span == 0)
        return cell;
    cell.slope = histogram_limited(length / fabs(det));
    cell.area = histogram_limited(length / span);
    return cell;
}
