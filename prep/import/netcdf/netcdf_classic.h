/* netcdf_classic.h - checks that a classic netCDF file has all the bytes it declares.
 *
 * Behind the end of such a file the library silently reads zeros. So the start of a variable is
 * also looked up in the header (netcdf_header.h).
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_CLASSIC_H
#define PREP_IMPORT_NETCDF_NETCDF_CLASSIC_H

#include "formats/base/file.h"
#include "prep/import/netcdf/netcdf_variable.h"

/* netcdf_classic_check() - check that the samples of one step of a variable lie inside the open
 * file f. start: of the step, an index per dimension. ST_CORRUPT otherwise, with the byte. ST_OK
 * for files of other formats. */
CHECKED status netcdf_classic_check(file *f, const netcdf_variable *v, const size_t *start);

/* netcdf_classic_step() - find where a step of a variable that was checked begins; 0 for files of
 * other formats. *apart: its slices do not follow each other, as others' records lie between. */
CHECKED status netcdf_classic_step(file *f, const netcdf_variable *v, const size_t *start,
                                   uint64_t *begin, bool *apart);

#endif
