/* hdf5_slices.h - the data sets of an HDF5 file, listed or read as slices. */
#ifndef PREP_IMPORT_HDF5_HDF5_SLICES_H
#define PREP_IMPORT_HDF5_HDF5_SLICES_H

#include "prep/import/importer.h"

/* hdf5_slices_open() - q's data set, or the first that can be read: of three axes, else of time
 * steps or components. axes: their order, of --axes; NULL: as hdf5_field.h has it. As
 * importer.open(). */
CHECKED status hdf5_slices_open(mem *m, const import_request *q, const char *axes,
                                slice_source *out);

/* hdf5_slices_list() - all data sets of all groups. As importer.list(). */
CHECKED status hdf5_slices_list(mem *m, const import_request *q, const char *axes,
                                const import_list *to);

#endif
