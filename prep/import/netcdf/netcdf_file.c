#include "prep/import/netcdf/netcdf_file.h"

#include <limits.h>
#include <stdio.h>

#include "prep/import/hdf5/hdf5_storage.h"
#include "prep/import/netcdf/netcdf_classic.h"

status netcdf_file_failed(const netcdf_file *f, const char *what, int error) {
    return status_describe(error == NC_ENOMEM ? ST_NOMEM : ST_CORRUPT, "%s: %s: libnetcdf: %s",
                           file_path(f->guard), what, nc_strerror(error));
}

status netcdf_file_open(mem *m, const import_request *q, netcdf_file *f) {
    *f = (netcdf_file){.m = m, .id = -1, .allow_missing = q->trust.allow_missing};
    status st = file_open(m, q->paths[0], &f->guard);
    if (st == ST_OK)
        st = netcdf_storage_look(m, q->paths[0], &q->trust, &f->storage);
    if (st != ST_OK)
        return st;
    const int error = nc_open(q->paths[0], NC_NOWRITE, &f->id);
    if (error == NC_NOERR)
        return ST_OK;
    f->id = -1;
    st = hdf5_storage_denied();
    return st == ST_OK ? netcdf_file_failed(f, "opening", error) : st;
}

void netcdf_file_close(netcdf_file *f) {
    if (f->id >= 0)
        nc_close(f->id);
    file_close(f->guard);
    netcdf_storage_release(&f->storage);
    *f = (netcdf_file){.id = -1};
}

status netcdf_file_check(const netcdf_file *f, const netcdf_variable *v, const size_t *start) {
    const status st = netcdf_classic_check(f->guard, v, start);
    if (st != ST_OK)
        return st;
    const absent_parts absent = netcdf_storage_absent(&f->storage, v->path);
    char name[NETCDF_PATH + PATH_MAX];
    snprintf(name, sizeof name, "%s: %s", file_path(f->guard), v->path);
    return absent_check(&absent, name, f->allow_missing);
}
