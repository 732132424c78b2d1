#include "prep/import/netcdf/netcdf_storage.h"

#include <hdf5.h>
#include <string.h>

#include "prep/import/hdf5/hdf5_storage.h"
#include "prep/import/hdf5/hdf5_walk.h"

typedef struct look {
    hid_t file;
    netcdf_storage *s;
} look;

static status keep(netcdf_storage *s, const char *path, const absent_parts *parts) {
    status st = mem_grow(s->m, &s->lacks, sizeof *s->lacks, s->count, 16, &s->room);
    char *copy = st == ST_OK ? mem_copy_text(s->m, path) : NULL;
    if (!copy)
        return ST_NOMEM;
    s->lacks[s->count++] = (netcdf_lack){copy, *parts};
    return ST_OK;
}

/* Check a data set, and keep its path if parts of it are absent. This also keeps the scales of
 * dimensions without coordinates, which are never written. They do no harm: they are no variables.
 */
static status take(void *ctx, const char *path) {
    const look *l = ctx;
    absent_parts parts;
    hid_t access = hdf5_storage_access();
    hid_t set = H5Dopen2(l->file, path, access);
    H5Pclose(access);
    if (set < 0)
        return ST_OK; /* libnetcdf reports it */
    status st = hdf5_storage_check(set, l->s->file, path, &parts);
    H5Dclose(set);
    return st == ST_OK && parts.count ? keep(l->s, path, &parts) : st;
}

status netcdf_storage_look(mem *m, const char *file, const input_trust *trust,
                           netcdf_storage *out) {
    *out = (netcdf_storage){.m = m, .file = file};
    status st = hdf5_storage_begin(m, trust);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    if (st != ST_OK || H5Fis_hdf5(file) <= 0)
        return st;
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_file_locking(access, false, true);
    look l = {H5Fopen(file, H5F_ACC_RDONLY, access), out};
    H5Pclose(access);
    if (l.file < 0)
        return ST_OK; /* libnetcdf reports it */
    st = hdf5_walk(l.file, file, take, &l);
    H5Fclose(l.file);
    return st;
}

absent_parts netcdf_storage_absent(const netcdf_storage *s, const char *variable) {
    for (size_t i = 0; i < s->count; i++)
        if (strcmp(s->lacks[i].path + 1, variable) == 0)
            return s->lacks[i].parts;
    return (absent_parts){0};
}

void netcdf_storage_release(netcdf_storage *s) {
    for (size_t i = 0; i < s->count; i++)
        mem_free(s->m, s->lacks[i].path);
    mem_free(s->m, s->lacks);
    *s = (netcdf_storage){0};
}
