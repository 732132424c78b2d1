/* netcdf_minc.h - MINC 1: netCDF whose variable "image" lies along xspace, yspace and zspace. */
#ifndef PREP_IMPORT_NETCDF_NETCDF_MINC_H
#define PREP_IMPORT_NETCDF_NETCDF_MINC_H

#include "prep/import/netcdf/netcdf_variable.h"

/* netcdf_minc_find() - whether a variable that has been described is MINC's: its sign and its valid
 * range are set then, or why it is refused. */
void netcdf_minc_find(netcdf_variable *v);

/* netcdf_minc_place() - into to_world and frame. ST_UNSUPPORTED for irregular distances. */
CHECKED status netcdf_minc_place(const char *file, const netcdf_variable *v, grid *g);

/* netcdf_minc_scales() - of an image of integers, scale and offset of each of the step's slices;
 * *out is of m, 2 * slices numbers. start: of the step, an index for each dimension. */
CHECKED status netcdf_minc_scales(mem *m, const char *file, const netcdf_variable *v,
                                  const size_t *start, double **out);

#endif
