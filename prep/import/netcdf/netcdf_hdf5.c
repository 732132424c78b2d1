#include "prep/import/netcdf/netcdf_hdf5.h"

#include <hdf5.h>
#include <stdio.h>

#include "prep/import/hdf5/hdf5_chunks.h"
#include "prep/import/netcdf/netcdf_stay.h"

/* Take the last dimensions for x, y, z, and one in front for steps. Returns NULL, or why not. */
static const char *take_axes(const netcdf_variable *v, const size_t *start, hdf5_field *f,
                             uint32_t *step) {
    f->rank = v->rank;
    f->at[HDF5_C] = f->at[HDF5_T] = -1;
    for (int i = 0; i < v->rank; i++)
        f->dims[i] = v->count[i];
    for (int a = 0; a < 3; a++)
        f->at[HDF5_X + a] = v->rank - 1 - a;
    for (int i = 0; i < v->rank - 3; i++) {
        if (start[i] && f->at[HDF5_T] >= 0)
            return "several axes of steps";
        if (start[i])
            f->at[HDF5_T] = i;
    }
    *step = f->at[HDF5_T] < 0 ? 0 : (uint32_t)start[f->at[HDF5_T]];
    return NULL;
}

/* Whether numbers are stored as ours are, but for their order. */
static bool is_plain(hid_t type, const sample_place *at, bool *big) {
    const H5T_class_t kind = H5Tget_class(type);
    const size_t size = H5Tget_size(type);
    *big = H5Tget_order(type) == H5T_ORDER_BE;
    return (kind == H5T_INTEGER || kind == H5T_FLOAT) && size == sample_size(at->stored.type) &&
           H5Tget_precision(type) == 8 * size && (*big || H5Tget_order(type) == H5T_ORDER_LE);
}

/* The chunks that a step meets. */
static status find_table(netcdf_hdf5 *h, const char *path, const hdf5_field *f, sample_place *out) {
    uint32_t first[ORDER_AXES] = {0}, end[ORDER_AXES];
    chunk_shape shape;
    chunk_range range;
    for (int a = 0; a < 3; a++)
        end[a] = (uint32_t)f->dims[f->at[HDF5_X + a]];
    end[ORDER_COMPONENT] = 1;
    first[ORDER_STEP] = out->step;
    end[ORDER_STEP] = out->step + 1;
    if (!chunk_array_measure(&h->array, &shape))
        return ST_NOMEM;
    out->table_count = (uint32_t)chunk_array_range(&shape, first, end, &range);
    const status st = hdf5_chunks_find(h->m, f, path, &h->array, &range, &h->table);
    out->table = h->table;
    return st;
}

static const char *take_chunks(netcdf_hdf5 *h, const char *path, const hdf5_field *f,
                               sample_place *out) {
    const char *why = hdf5_chunks_describe(f, out->stored.type, out->big_endian, &h->array);
    out->chunks = &h->array;
    if (!why && h->tell_chunks && find_table(h, path, f, out) != ST_OK)
        why = "the library does not tell where they are";
    return why;
}

/* Where the step begins in a data set of one piece; false: it has none. */
static bool take_piece(const hdf5_field *f, hid_t plist, const size_t *start, sample_place *out) {
    const haddr_t at = H5Dget_offset(f->set);
    uint64_t number = 0;
    if (at == HADDR_UNDEF || H5Pget_external_count(plist) != 0)
        return false;
    for (int i = 0; i < f->rank; i++)
        number = number * f->dims[i] + (i < f->rank - 3 ? start[i] : 0);
    out->offset = at + number * sample_size(out->stored.type);
    return true;
}

/* Look at an open data set. */
static bool look(netcdf_hdf5 *h, const char *path, const netcdf_variable *v, const size_t *start,
                 hdf5_field *f, sample_place *out) {
    hid_t plist = H5Dget_create_plist(f->set), type = H5Dget_type(f->set);
    const H5D_layout_t layout = plist < 0 ? H5D_LAYOUT_ERROR : H5Pget_layout(plist);
    bool found = true;
    f->memory = H5Tget_native_type(type, H5T_DIR_ASCEND);
    f->chunk_bytes = v->chunk_bytes;
    for (int i = 0; i < v->rank; i++)
        f->chunk[i] = v->chunk[i];
    out->refused = netcdf_stay_numbers(v, out);
    const char *axes = take_axes(v, start, f, &out->step);
    if (!out->refused && !is_plain(type, out, &out->big_endian))
        out->refused = "numbers that HDF5 converts";
    if (!out->refused && layout == H5D_CHUNKED)
        out->refused = axes ? axes : take_chunks(h, path, f, out);
    else if (!out->refused)
        found = layout == H5D_CONTIGUOUS && take_piece(f, plist, start, out);
    if (!out->chunks)
        out->step = 0;
    H5Tclose(f->memory);
    H5Tclose(type);
    H5Pclose(plist);
    return found;
}

bool netcdf_hdf5_find(const char *path, const netcdf_variable *v, const size_t *start,
                      netcdf_hdf5 *keep, sample_place *out) {
    char name[NETCDF_PATH + 1];
    hdf5_field f = {.set = -1};
    bool found = false;
    *out = (sample_place){.path = NULL};
    netcdf_hdf5_release(keep);
    snprintf(name, sizeof name, "/%s", v->path);
    hid_t whole = -1; /* libnetcdf's, the only one: another might not be opened beside it */
    if (H5Fget_obj_ids((hid_t)H5F_OBJ_ALL, H5F_OBJ_FILE, 1, &whole) == 1)
        f.set = H5Dopen2(whole, name, H5P_DEFAULT);
    if (f.set >= 0) {
        found = look(keep, path, v, start, &f, out);
        H5Dclose(f.set);
    }
    return found;
}

void netcdf_hdf5_release(netcdf_hdf5 *h) {
    if (h->m)
        mem_free(h->m, h->table);
    h->table = NULL;
}
