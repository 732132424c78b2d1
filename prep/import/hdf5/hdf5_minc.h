/* hdf5_minc.h - MINC 2: HDF5 whose data set /minc-2.0/image/0/image lies along xspace, yspace and
 * zspace, as its attribute dimorder has them. */
#ifndef PREP_IMPORT_HDF5_HDF5_MINC_H
#define PREP_IMPORT_HDF5_HDF5_MINC_H

#include "prep/import/hdf5/hdf5_field.h"

/* hdf5_minc_find() - whether a data set that has been described is MINC's: its axes and its valid
 * range are set then, or why it is refused. */
void hdf5_minc_find(const char *path, hdf5_field *f);

/* hdf5_minc_place() - into to_world and frame. ST_UNSUPPORTED for irregular distances. */
CHECKED status hdf5_minc_place(hid_t file, const char *name, const hdf5_field *f, grid *g);

/* hdf5_minc_scales() - of an image of integers, scale and offset of each slice of a step; *out is
 * of m, 2 * slices numbers. path: of the image. */
CHECKED status hdf5_minc_scales(mem *m, hid_t file, const char *name, const char *path,
                                const hdf5_field *f, uint32_t step, double **out);

#endif
