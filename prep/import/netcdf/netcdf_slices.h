/* netcdf_slices.h - the variables of a netCDF file, listed or read as slices. */
#ifndef PREP_IMPORT_NETCDF_NETCDF_SLICES_H
#define PREP_IMPORT_NETCDF_NETCDF_SLICES_H

#include "prep/import/importer.h"

/* netcdf_slices_open() - q's variable, or the first that can be read: of three dimensions, else of
 * time steps. indices: coordinates are left aside. As importer.open(). */
CHECKED status netcdf_slices_open(mem *m, const import_request *q, bool indices, slice_source *out);

/* netcdf_slices_list() - all variables of all groups. As importer.list(). */
CHECKED status netcdf_slices_list(mem *m, const import_request *q, const import_list *to);

#endif
