/* hdf5_minc.h - MINC 2: HDF5 files with a data set /minc-2.0/image/0/image along xspace, yspace and
 * zspace, by its attribute dimorder. */
#ifndef PREP_IMPORT_HDF5_HDF5_MINC_H
#define PREP_IMPORT_HDF5_HDF5_MINC_H

#include "prep/import/hdf5/hdf5_field.h"

/* hdf5_minc_find() - if a described data set is MINC's, set its axes and valid range, or why it is
 * refused. */
void hdf5_minc_find(const char *path, hdf5_field *f);

/* hdf5_minc_place() - set to_world and frame. ST_UNSUPPORTED: irregular distances. */
CHECKED status hdf5_minc_place(hid_t file, const char *name, const hdf5_field *f, grid *g);

/* hdf5_minc_scales() - for an image of integers: scale and offset of each slice of a step. *out is
 * allocated from m, 2 * slices numbers. path: of the image. */
CHECKED status hdf5_minc_scales(mem *m, hid_t file, const char *name, const char *path,
                                const hdf5_field *f, uint32_t step, double **out);

#endif
