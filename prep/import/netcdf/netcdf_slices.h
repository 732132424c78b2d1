/* netcdf_slices.h - lists the variables of a netCDF file, or reads one as slices. */
#ifndef PREP_IMPORT_NETCDF_NETCDF_SLICES_H
#define PREP_IMPORT_NETCDF_NETCDF_SLICES_H

#include "prep/import/importer.h"
#include "prep/import/netcdf/netcdf_choice.h"

/* netcdf_slices_open() - open q's variable, or the largest field (netcdf_roles.h) that can be read
 * and has q's step. As importer.open(). */
CHECKED status netcdf_slices_open(mem *m, const import_request *q, const netcdf_wish *wish,
                                  slice_source *out);

/* netcdf_slices_open_in() - the same of a file that is open, and stays so longer than *out. What it
 * lacks cannot be told while it is open again. */
CHECKED status netcdf_slices_open_in(const netcdf_file *f, const import_request *q,
                                     const netcdf_wish *wish, slice_source *out);

/* netcdf_slices_list() - list all variables of all groups. As importer.list(). */
CHECKED status netcdf_slices_list(mem *m, const import_request *q, const netcdf_wish *wish,
                                  const import_list *to);

#endif
