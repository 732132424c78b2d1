/* netcdf_header.h - finds the variables' data in a classic netCDF file: CDF-1, CDF-2 (64-bit
 * offset) and CDF-5. It does not use the library.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_HEADER_H
#define PREP_IMPORT_NETCDF_NETCDF_HEADER_H

#include <stdint.h>

#include "formats/base/file.h"

/* netcdf_header_begin() - offset of the data of variable id (from 0); 0 for files of other formats.
 * ST_CORRUPT: the header ends early. */
CHECKED status netcdf_header_begin(file *f, int id, uint64_t *begin);

/* netcdf_header_type_bytes() - bytes of a number of a type, as numbered in the header and by the
 * library; 0: there is no such type. */
uint64_t netcdf_header_type_bytes(uint64_t type);

#endif
