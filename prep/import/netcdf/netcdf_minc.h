/* netcdf_minc.h - MINC 1: netCDF files whose variable "image" lies along xspace, yspace and
 * zspace. */
#ifndef PREP_IMPORT_NETCDF_NETCDF_MINC_H
#define PREP_IMPORT_NETCDF_NETCDF_MINC_H

#include "prep/import/netcdf/netcdf_variable.h"

/* netcdf_minc_find() - if a described variable is MINC's, set its sign and valid range, or why it
 * is refused. */
void netcdf_minc_find(netcdf_variable *v);

/* netcdf_minc_place() - set to_world and frame. ST_UNSUPPORTED: irregular distances. */
CHECKED status netcdf_minc_place(const char *file, const netcdf_variable *v, grid *g);

/* netcdf_minc_scales() - for an image of integers: scale and offset of each slice of the step. *out
 * is allocated from m, 2 * slices numbers. start: of the step, an index per dimension. */
CHECKED status netcdf_minc_scales(mem *m, const char *file, const netcdf_variable *v,
                                  const size_t *start, double **out);

#endif
