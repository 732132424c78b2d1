/* netcdf_hdf5.h - where the samples of a step of a variable of netCDF-4 lie, which is HDF5: in one
 * piece, or in chunks.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_HDF5_H
#define PREP_IMPORT_NETCDF_NETCDF_HDF5_H

#include "formats/base/mem.h"
#include "formats/grid/chunk_array.h"
#include "formats/grid/sample_place.h"
#include "prep/import/netcdf/netcdf_variable.h"

/* What a place refers to. Zeros: nothing. */
typedef struct netcdf_hdf5 {
    mem *m;
    bool tell_chunks; /* where each lies, too; else only that there are some */
    chunk_array array;
    chunk_entry *table;
} netcdf_hdf5;

/* netcdf_hdf5_find() - as netcdf_stay_find(), of a file that is open with libnetcdf. *out refers to
 * *keep, whose m and tell_chunks are set. Release it in any case. Returns false for what is no
 * HDF5, or neither chunks nor one piece. */
bool netcdf_hdf5_find(const char *path, const netcdf_variable *v, const size_t *start,
                      netcdf_hdf5 *keep, sample_place *out);
void netcdf_hdf5_release(netcdf_hdf5 *h);

#endif
