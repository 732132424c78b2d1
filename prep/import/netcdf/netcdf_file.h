/* netcdf_file.h - an open netCDF file. */
#ifndef PREP_IMPORT_NETCDF_NETCDF_FILE_H
#define PREP_IMPORT_NETCDF_NETCDF_FILE_H

#include "formats/base/file.h"
#include "prep/import/importer.h"
#include "prep/import/netcdf/netcdf_storage.h"
#include "prep/import/netcdf/netcdf_variable.h"

typedef struct netcdf_file {
    mem *m;
    file *guard; /* the same file, opened so that the guard knows it as an input */
    int id;      /* -1: not open */
    netcdf_storage storage;
    bool allow_missing;
} netcdf_file;

/* netcdf_file_open() - open q's first path. Close it in any case. */
CHECKED status netcdf_file_open(mem *m, const import_request *q, netcdf_file *f);
void netcdf_file_close(netcdf_file *f);

/* netcdf_file_check() - see that all bytes of a variable's step are there: a classic file is not
 * cut, no chunk was never written. start: of the step, an index per dimension. */
CHECKED status netcdf_file_check(const netcdf_file *f, const netcdf_variable *v,
                                 const size_t *start);

/* netcdf_file_failed() - describe an error of libnetcdf. */
status netcdf_file_failed(const netcdf_file *f, const char *what, int error);

#endif
