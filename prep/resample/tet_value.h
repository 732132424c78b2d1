/* tet_value.h - interpolates linearly in a tet at a point, and decides whether the point is inside.
 *
 * Exact signs decide which tets hold a point, so there is no gap between tets that share faces. A
 * point on a face, an edge or a vertex is held by all tets there. Its value comes from that face,
 * edge or vertex alone: each tet gives the same bits. Weights are exact to a fraction of a float's
 * last bit, however flat or long the tet is. The bits are the same on every CPU.
 */
#ifndef PREP_RESAMPLE_TET_VALUE_H
#define PREP_RESAMPLE_TET_VALUE_H

#include <stdbool.h>

typedef struct tet_value {
    double at[4][3]; /* vertices in ascending order of the mesh's ids */
    float value[4];
    int sign; /* of its volume; 0: flat, holds nothing */
} tet_value;

/* tet_value_init() - xyz and values of four vertices in ascending order of the mesh's ids. */
void tet_value_init(tet_value *t, const float *const xyz[4], const float values[4]);

/* tet_value_at() - returns whether the point is in t or on its boundary, and then sets *out. Needs
 * t->sign != 0. Only vertices with a weight count: *out is NaN if one of them is NaN or inf, else
 * between their smallest and largest value. */
bool tet_value_at(const tet_value *t, const double point[3], float *out);

#endif
