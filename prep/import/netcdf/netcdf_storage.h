/* netcdf_storage.h - finds what a netCDF-4 file, which is HDF5, names and lacks.
 *
 * libnetcdf reports neither. So all data sets are checked before it opens the file
 * (prep/import/hdf5/hdf5_storage.h). What is missing is remembered for the variable that is read.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_STORAGE_H
#define PREP_IMPORT_NETCDF_NETCDF_STORAGE_H

#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/absent.h"
#include "formats/input/input_trust.h"

typedef struct netcdf_lack {
    char *path; /* "/group/variable" */
    absent_parts parts;
} netcdf_lack;

/* Zeros: nothing is missing. */
typedef struct netcdf_storage {
    mem *m;
    const char *file;
    netcdf_lack *lacks;
    size_t count, room;
} netcdf_storage;

/* netcdf_storage_look() - call it before nc_open(). ST_CORRUPT, ST_UNSUPPORTED as
 * hdf5_storage_check(). Files that are not HDF5 name and lack nothing here. Release it in any
 * case. */
CHECKED status netcdf_storage_look(mem *m, const char *file, const input_trust *trust,
                                   netcdf_storage *out);

/* netcdf_storage_absent() - missing parts of a variable, "group/variable". */
absent_parts netcdf_storage_absent(const netcdf_storage *s, const char *variable);
void netcdf_storage_release(netcdf_storage *s);

#endif
