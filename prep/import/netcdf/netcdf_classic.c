#include "prep/import/netcdf/netcdf_classic.h"

#include "prep/import/netcdf/netcdf_header.h"

/* ---- sizes ---- */

/* Bytes of a variable; if it grows, of one record. */
static uint64_t bytes_of(const netcdf_variable *v) {
    nc_type type = NC_NAT;
    nc_inq_vartype(v->group, v->id, &type);
    uint64_t bytes = netcdf_header_type_bytes((uint64_t)type);
    for (int i = v->grows; i < v->rank; i++)
        bytes = v->count[i] && bytes > UINT64_MAX / 2 / v->count[i] ? UINT64_MAX / 2
                                                                    : bytes * v->count[i];
    return bytes;
}

/* Bytes of a record: all growing variables, each padded to four bytes. A single one is not
 * padded. */
static uint64_t record_bytes(int group) {
    int count = 0, growing = 0;
    uint64_t all = 0, last = 0;
    nc_inq_nvars(group, &count);
    for (int i = 0; i < count; i++) {
        netcdf_variable v;
        netcdf_variable_find(group, i, "", &v);
        if (!v.grows)
            continue;
        last = bytes_of(&v);
        all += last + (4 - last % 4) % 4;
        growing++;
    }
    return growing == 1 ? last : all;
}

static status check_end(file *f, const netcdf_variable *v, const size_t *start, uint64_t begin) {
    uint64_t end = begin, bytes = bytes_of(v);
    if (v->grows && v->rank > 3)
        end += start[0] * record_bytes(v->group);
    else if (v->grows)
        end += (v->count[0] ? v->count[0] - 1 : 0) * record_bytes(v->group);
    end += bytes;
    if (end <= file_size(f))
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: ends at byte %llu, but %s needs all up to byte %llu",
                           file_path(f), (unsigned long long)file_size(f), v->path,
                           (unsigned long long)end);
}

status netcdf_classic_check(file *f, const netcdf_variable *v, const size_t *start) {
    uint64_t begin = 0;
    const status st = netcdf_header_begin(f, v->id, &begin);
    return st == ST_OK && begin > 0 ? check_end(f, v, start, begin) : st;
}

status netcdf_classic_step(file *f, const netcdf_variable *v, const size_t *start, uint64_t *begin,
                           bool *apart) {
    nc_type type = NC_NAT;
    const status st = netcdf_header_begin(f, v->id, begin);
    if (st != ST_OK || *begin == 0)
        return st;
    nc_inq_vartype(v->group, v->id, &type);
    uint64_t stride = netcdf_header_type_bytes((uint64_t)type);
    for (int i = v->rank - 1; i >= v->grows; i--) {
        *begin += i < v->rank - 3 ? start[i] * stride : 0;
        stride *= v->count[i];
    }
    const uint64_t record = v->grows ? record_bytes(v->group) : 0;
    *begin += v->grows && v->rank > 3 ? start[0] * record : 0;
    *apart = v->grows && v->rank == 3 && record != stride;
    return ST_OK;
}
