/* minc.h - MINC's conventions for images, for both libraries: MINC 1 is netCDF, MINC 2 is HDF5.
 *
 * Dimensions are called xspace, yspace and zspace, in any order. The world is RAS, in millimetres.
 * Integers stand for values: their valid range maps to image-min .. image-max, per slice. Pure; any
 * thread.
 */
#ifndef PREP_IMPORT_MINC_H
#define PREP_IMPORT_MINC_H

#include "formats/grid/grid.h"

/* A dimension of the image. */
typedef struct minc_dimension {
    double start, step, cosines[3];
} minc_dimension;

/* minc_space() - 0, 1, 2 for xspace, yspace, zspace; -1 for another dimension. */
int minc_space(const char *name);

/* minc_usual() - the default for a dimension without attributes. */
minc_dimension minc_usual(int space);

/* minc_place() - set the world of a grid whose axes are these dimensions. */
void minc_place(const minc_dimension d[3], grid *g);

/* minc_range() - which stored integers stand for values. told: the file's two limits, in either
 * order; NaN: the file is silent, and the type's own holds. */
void minc_range(sample_type stored, const double told[2], double range[2]);

/* minc_scale() - compute scale and offset: value = stored * scale + offset. */
void minc_scale(const double valid[2], double least, double most, double *scale, double *offset);

#endif
