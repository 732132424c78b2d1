/* netcdf_classic.h - whether a classic netCDF file has the bytes that it says it has.
 *
 * Behind the end of such a file the library reads zeros, and says nothing. So where a variable
 * begins is looked up in the header, too (netcdf_header.h).
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_CLASSIC_H
#define PREP_IMPORT_NETCDF_NETCDF_CLASSIC_H

#include "formats/base/file.h"
#include "prep/import/netcdf/netcdf_variable.h"

/* netcdf_classic_check() - the samples of one step of a variable of the open file f lie inside of
 * it. start: of the step, an index for each dimension. ST_CORRUPT otherwise, with the byte; ST_OK
 * for files of other formats. */
CHECKED status netcdf_classic_check(file *f, const netcdf_variable *v, const size_t *start);

#endif
