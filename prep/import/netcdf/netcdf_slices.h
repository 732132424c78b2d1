/* netcdf_slices.h - the variables of a netCDF file, listed or read as slices. */
#ifndef PREP_IMPORT_NETCDF_NETCDF_SLICES_H
#define PREP_IMPORT_NETCDF_NETCDF_SLICES_H

#include "prep/import/importer.h"

/* What the command line asks for beside an import_request. */
typedef struct netcdf_wish {
    bool indices;    /* coordinates are left aside */
    bool stack_time; /* times may be slices: a map that changes becomes a volume */
} netcdf_wish;

/* netcdf_slices_open() - q's variable, or the largest field (netcdf_roles.h) that can be read and
 * has the step that q asks for. As importer.open(). */
CHECKED status netcdf_slices_open(mem *m, const import_request *q, const netcdf_wish *wish,
                                  slice_source *out);

/* netcdf_slices_list() - all variables of all groups. As importer.list(). */
CHECKED status netcdf_slices_list(mem *m, const import_request *q, const netcdf_wish *wish,
                                  const import_list *to);

#endif
