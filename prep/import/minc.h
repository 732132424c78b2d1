/* minc.h - what MINC says of an image, whichever library reads it: MINC 1 is netCDF, MINC 2 HDF5.
 *
 * Dimensions are called xspace, yspace and zspace, in any order; the world is RAS, in millimetres.
 * Integers stand for values: their valid range becomes that from image-min to image-max, of each
 * slice. Pure; any thread.
 */
#ifndef PREP_IMPORT_MINC_H
#define PREP_IMPORT_MINC_H

#include "formats/grid/grid.h"

/* One of the dimensions. */
typedef struct minc_dimension {
    double start, step, cosines[3];
} minc_dimension;

/* minc_space() - 0, 1, 2 of xspace, yspace, zspace; -1 of another dimension. */
int minc_space(const char *name);

/* minc_usual() - a dimension that says nothing of itself. */
minc_dimension minc_usual(int space);

/* minc_place() - the world of a grid whose axes are these dimensions. */
void minc_place(const minc_dimension d[3], grid *g);

/* minc_scale() - value = stored * scale + offset. */
void minc_scale(const double valid[2], double least, double most, double *scale, double *offset);

#endif
