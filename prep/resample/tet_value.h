/* tet_value.h - the linear interpolation in a tet at a point, and whether the point is in it.
 *
 * Which tets hold a point is decided by exact signs, so that tets that share faces leave no gap
 * between them. A point on a face, an edge or a vertex is held by all tets there, and its value
 * comes from that face, edge or vertex alone: the same bits from each of them. Weights are right to
 * a part of a float's last bit however flat or long the tet is. The same bits on every CPU.
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

/* tet_value_at() - whether the point is in t, its boundary included, and then *out: NaN where a
 * vertex that has a part in it is NaN or inf. t->sign != 0. Between the smallest and the largest
 * value of the vertices that have a part in it. */
bool tet_value_at(const tet_value *t, const double point[3], float *out);

#endif
