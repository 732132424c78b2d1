#include "prep/import/netcdf/netcdf_variable.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "formats/base/text.h"
#include "prep/import/netcdf/netcdf_minc.h"
#include "prep/import/netcdf/netcdf_roles.h"

/* ---- attributes ---- */

void netcdf_text(int group, int id, const char *name, char *to, size_t room) {
    nc_type type;
    size_t size;
    to[0] = 0;
    if (nc_inq_att(group, id, name, &type, &size) != NC_NOERR || size == 0)
        return;
    if (type == NC_CHAR && size < 65536) {
        char *text = calloc(size + 1, 1);
        if (text && nc_get_att_text(group, id, name, text) == NC_NOERR)
            text_name(to, room, text);
        free(text);
    } else if (type == NC_STRING && size == 1) {
        char *text = NULL;
        if (nc_get_att_string(group, id, name, &text) == NC_NOERR && text)
            text_name(to, room, text);
        nc_free_string(1, &text);
    }
}

/* Read 64-bit integers exactly: fill values are often the largest ones. */
static bool wide_number(int group, int id, const char *name, nc_type type, size_t i,
                        long double *out) {
    union {
        long long s[PACKED_FILLS];
        unsigned long long u[PACKED_FILLS];
    } v;
    const bool read = type == NC_INT64 ? nc_get_att_longlong(group, id, name, v.s) == NC_NOERR
                                       : nc_get_att_ulonglong(group, id, name, v.u) == NC_NOERR;
    *out = type == NC_INT64 ? (long double)v.s[i] : (long double)v.u[i];
    return read;
}

bool netcdf_number(int group, int id, const char *name, size_t i, long double *out) {
    nc_type type;
    size_t count;
    double v[PACKED_FILLS];
    if (nc_inq_att(group, id, name, &type, &count) != NC_NOERR || count > PACKED_FILLS ||
        i >= count || type == NC_CHAR || type > NC_UINT64)
        return false;
    if (type == NC_INT64 || type == NC_UINT64)
        return wide_number(group, id, name, type, i, out);
    if (nc_get_att_double(group, id, name, v) != NC_NOERR)
        return false;
    *out = v[i];
    return true;
}

/* ---- its type ---- */

typedef struct kind {
    const char *name;
    sample_type type, unsigned_type; /* 0: cannot be read */
    packed_wide wide;
} kind;

/* Indexed by the library's type numbers. */
static kind kind_of(nc_type type) {
    static const kind kinds[] = {
        [NC_BYTE] = {"i8", SAMPLE_I8, SAMPLE_U8, PACKED_NARROW},
        [NC_CHAR] = {"characters", 0, 0, PACKED_NARROW},
        [NC_SHORT] = {"i16", SAMPLE_I16, SAMPLE_U16, PACKED_NARROW},
        [NC_INT] = {"i32", SAMPLE_I32, SAMPLE_U32, PACKED_NARROW},
        [NC_FLOAT] = {"f32", SAMPLE_F32, 0, PACKED_NARROW},
        [NC_DOUBLE] = {"f64", SAMPLE_F64, 0, PACKED_NARROW},
        [NC_UBYTE] = {"u8", SAMPLE_U8, 0, PACKED_NARROW},
        [NC_USHORT] = {"u16", SAMPLE_U16, 0, PACKED_NARROW},
        [NC_UINT] = {"u32", SAMPLE_U32, 0, PACKED_NARROW},
        [NC_INT64] = {"i64", SAMPLE_F64, 0, PACKED_I64},
        [NC_UINT64] = {"u64", SAMPLE_F64, 0, PACKED_U64},
        [NC_STRING] = {"texts", 0, 0, PACKED_NARROW},
    };
    if (type > 0 && type < (int)(sizeof kinds / sizeof kinds[0]))
        return kinds[type];
    return (kind){"elements of a type of its own", 0, 0, PACKED_NARROW};
}

/* Classic files have no unsigned types. An attribute marks them. */
static bool says_unsigned(const netcdf_variable *v) {
    char text[8];
    netcdf_text(v->group, v->id, "_Unsigned", text, sizeof text);
    return strcasecmp(text, "true") == 0;
}

static void find_type(netcdf_variable *v, nc_type type) {
    const kind k = kind_of(type);
    const bool plus = k.unsigned_type && says_unsigned(v);
    snprintf(v->type, sizeof v->type, "%s", plus ? sample_name(k.unsigned_type) : k.name);
    if (!k.type)
        snprintf(v->refuse, sizeof v->refuse, "%s are not read", k.name);
    packed_init(&v->packed, plus ? k.unsigned_type : k.type, k.wide);
}

/* ---- how its values are packed ---- */

/* Convert an attribute's number to the variable's type: -1 for an unsigned byte is 255. */
static long double as_stored(const netcdf_variable *v, long double number) {
    const sample_type type = v->packed.type;
    const bool plus = type == SAMPLE_U8 || type == SAMPLE_U16 || type == SAMPLE_U32;
    return plus && number < 0 ? number + (long double)(1ull << (8 * sample_size(type))) : number;
}

static bool has(const netcdf_variable *v, const char *name, size_t i, long double *out) {
    return netcdf_number(v->group, v->id, name, i, out);
}

/* Floats without their own fill value have the library's. CF 2.5.1: missing_value may be a vector.
 */
static void find_fills(netcdf_variable *v, nc_type type) {
    long double number;
    size_t count = 0;
    nc_type told;
    bool all = true;
    if (has(v, "_FillValue", 0, &number))
        all = packed_fill(&v->packed, as_stored(v, number));
    else if (type == NC_FLOAT)
        all = packed_fill(&v->packed, (long double)NC_FILL_FLOAT);
    else if (type == NC_DOUBLE)
        all = packed_fill(&v->packed, (long double)NC_FILL_DOUBLE);
    if (nc_inq_att(v->group, v->id, "missing_value", &told, &count) != NC_NOERR ||
        told == NC_CHAR || told > NC_UINT64)
        return;
    for (size_t i = 0; i < count && has(v, "missing_value", i, &number); i++)
        all = packed_fill(&v->packed, as_stored(v, number)) && all;
    if (!all || count > PACKED_FILLS)
        snprintf(v->refuse, sizeof v->refuse, "more than %d values for missing data", PACKED_FILLS);
}

/* The range is of packed numbers, unless a variable of integers has it in floats. */
static void find_range(netcdf_variable *v) {
    long double least = 0, most = 0;
    nc_type type = NC_NAT;
    const bool both = has(v, "valid_range", 0, &least) && has(v, "valid_range", 1, &most);
    const bool low = both || has(v, "valid_min", 0, &least);
    const bool high = both || has(v, "valid_max", 0, &most);
    packed_samples *p = &v->packed;
    if (!low && !high)
        return;
    nc_inq_atttype(v->group, v->id, both ? "valid_range" : low ? "valid_min" : "valid_max", &type);
    p->has_range = true;
    p->valid_values =
        (type == NC_FLOAT || type == NC_DOUBLE) && (sample_is_integer(p->type) || p->wide);
    if (!p->valid_values) {
        least = as_stored(v, least);
        most = as_stored(v, most);
    }
    p->least = low ? (double)least : -INFINITY;
    p->most = high ? (double)most : INFINITY;
}

static void find_packing(netcdf_variable *v, nc_type type) {
    long double number;
    find_fills(v, type);
    find_range(v);
    if (has(v, "scale_factor", 0, &number))
        v->packed.scale = (double)number;
    if (has(v, "add_offset", 0, &number))
        v->packed.offset = (double)number;
    if (v->packed.scale != 1 || v->packed.offset != 0)
        text_add(v->type, sizeof v->type, ", packed");
}

/* ---- its dimensions ---- */

static void find_grown(netcdf_variable *v) {
    int ids[64], count = 0;
    if (v->rank == 0 || nc_inq_unlimdims(v->group, &count, NULL) != NC_NOERR || count > 64 ||
        nc_inq_unlimdims(v->group, &count, ids) != NC_NOERR)
        return;
    for (int i = 0; i < count; i++)
        v->grows = v->grows || ids[i] == v->dim[0];
}

static void find_time(netcdf_variable *v) {
    v->time = -1;
    for (int i = 0; i < v->rank && v->time < 0; i++)
        if (netcdf_is_time(v->group, v->dim[i]))
            v->time = i;
}

static bool find_shape(netcdf_variable *v) {
    v->steps = 1;
    for (int i = 0; i < v->rank; i++) {
        if (nc_inq_dimlen(v->group, v->dim[i], &v->count[i]) != NC_NOERR)
            return false;
        if (i < v->rank - 3 && v->count[i] && v->steps > UINT32_MAX / v->count[i])
            return false;
        if (i < v->rank - 3)
            v->steps *= v->count[i];
    }
    find_grown(v);
    find_time(v);
    if (v->rank < 3)
        snprintf(v->refuse, sizeof v->refuse, "%d dimension%s", v->rank, v->rank == 1 ? "" : "s");
    return true;
}

/* Find the chunks; classic and contiguous variables have none. */
static void find_chunks(netcdf_variable *v) {
    int storage = NC_CONTIGUOUS;
    if (nc_inq_var_chunking(v->group, v->id, &storage, v->chunk) != NC_NOERR ||
        storage != NC_CHUNKED) {
        memset(v->chunk, 0, sizeof v->chunk);
        return;
    }
    v->chunk_bytes = packed_bytes(&v->packed);
    text_add(v->type, sizeof v->type, ", chunks ");
    for (int i = 0; i < v->rank; i++) {
        v->chunk_bytes *= v->chunk[i];
        if (i < 5)
            text_add(v->type, sizeof v->type, i ? "x%zu" : "%zu", v->chunk[i]);
    }
}

/* ---- all of it ---- */

static void find_units(netcdf_variable *v) {
    netcdf_text(v->group, v->id, "units", v->units, 48);
    if (v->units[0])
        text_add(v->type, sizeof v->type, ", %s", v->units);
    if (v->grows && v->rank > 3)
        text_add(v->type, sizeof v->type, ", steps unlimited");
}

bool netcdf_variable_prefix(int group, char *to, size_t room) {
    int parent;
    size_t length = 0;
    to[0] = 0;
    if (nc_inq_grp_parent(group, &parent) != NC_NOERR)
        return true;
    char *path = NULL;
    bool fits = nc_inq_grpname_full(group, &length, NULL) == NC_NOERR && length + 1 < room;
    path = fits ? calloc(length + 1, 1) : NULL;
    fits = path && nc_inq_grpname_full(group, &length, path) == NC_NOERR;
    if (fits)
        snprintf(to, room, "%s/", path + 1);
    free(path);
    return fits;
}

bool netcdf_variable_stacked(const netcdf_variable *v) {
    return v->rank >= 3 && v->time >= v->rank - 3;
}

void netcdf_variable_find(int group, int id, const char *prefix, netcdf_variable *v) {
    char name[NC_MAX_NAME + 1] = "";
    nc_type type = NC_NAT;
    *v = (netcdf_variable){.group = group, .id = id, .time = -1};
    bool sound = nc_inq_varname(group, id, name) == NC_NOERR &&
                 nc_inq_vartype(group, id, &type) == NC_NOERR &&
                 nc_inq_varndims(group, id, &v->rank) == NC_NOERR;
    snprintf(v->path, sizeof v->path, "%s%s", prefix, name);
    find_type(v, type);
    if (sound && v->rank > NETCDF_RANK) {
        snprintf(v->refuse, sizeof v->refuse, "%d dimensions", v->rank);
        sound = false;
    }
    if (!sound)
        v->rank = 0;
    sound = sound && nc_inq_vardimid(group, id, v->dim) == NC_NOERR && find_shape(v);
    if (!sound && !v->refuse[0])
        snprintf(v->refuse, sizeof v->refuse, "its dimensions cannot be told");
    if (!sound || !kind_of(type).type)
        return;
    netcdf_minc_find(v);
    if (!v->minc)
        find_packing(v, type);
    if (v->refuse[0])
        return;
    find_chunks(v);
    find_units(v);
}
