/* hdf5_slices.h - lists the data sets of an HDF5 file, or reads one as slices. */
#ifndef PREP_IMPORT_HDF5_HDF5_SLICES_H
#define PREP_IMPORT_HDF5_HDF5_SLICES_H

#include "prep/import/importer.h"

/* hdf5_slices_open() - open q's data set, or the first that can be read: of three axes, else with
 * time steps or components. axes: their order, from --axes; NULL: as in hdf5_field.h. As
 * importer.open(). */
CHECKED status hdf5_slices_open(mem *m, const import_request *q, const char *axes,
                                slice_source *out);

/* hdf5_slices_list() - list all data sets of all groups. As importer.list(). */
CHECKED status hdf5_slices_list(mem *m, const import_request *q, const char *axes,
                                const import_list *to);

#endif
