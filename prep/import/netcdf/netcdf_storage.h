/* netcdf_storage.h - what the HDF5 file below a netCDF-4 file names and lacks.
 *
 * libnetcdf says nothing of either. So all data sets are looked at before it opens the file
 * (prep/import/hdf5/hdf5_storage.h), and what is absent is kept for the one that is read.
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

/* Zeros: nothing is known to be missing. */
typedef struct netcdf_storage {
    mem *m;
    const char *file;
    netcdf_lack *lacks;
    size_t count, room;
} netcdf_storage;

/* netcdf_storage_look() - before nc_open(). ST_CORRUPT, ST_UNSUPPORTED as hdf5_storage_check();
 * files that are no HDF5 name and lack nothing here. Release it in any case. */
CHECKED status netcdf_storage_look(mem *m, const char *file, const input_trust *trust,
                                   netcdf_storage *out);

/* netcdf_storage_absent() - of a variable, "group/variable". */
absent_parts netcdf_storage_absent(const netcdf_storage *s, const char *variable);
void netcdf_storage_release(netcdf_storage *s);

#endif
