/* netcdf_header.h - where a classic netCDF file keeps its variables: CDF-1, CDF-2 (64-bit offset)
 * and CDF-5. Without the library.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_HEADER_H
#define PREP_IMPORT_NETCDF_NETCDF_HEADER_H

#include <stdint.h>

#include "formats/base/file.h"

/* netcdf_header_begin() - the byte where the data of variable id (from 0) begin; 0 for files of
 * other formats. ST_CORRUPT where the header ends early. */
CHECKED status netcdf_header_begin(file *f, int id, uint64_t *begin);

/* netcdf_header_type_bytes() - of a number of a type, as the header and the library number them; 0:
 * there is no such type. */
uint64_t netcdf_header_type_bytes(uint64_t type);

#endif
