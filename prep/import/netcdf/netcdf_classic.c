#include "prep/import/netcdf/netcdf_classic.h"

#include <string.h>

/* ---- the header ---- */

typedef struct cursor {
    file *f;
    uint64_t at;
    int version; /* 1, 2, 5 */
    status st;   /* the first failure ends it */
} cursor;

/* A big-endian number of so many bytes. */
static uint64_t take(cursor *c, size_t bytes) {
    uint8_t b[8];
    uint64_t number = 0;
    if (c->st == ST_OK)
        c->st = file_read_at(c->f, c->at, b, bytes);
    c->at += bytes;
    for (size_t i = 0; c->st == ST_OK && i < bytes; i++)
        number = number << 8 | b[i];
    return number;
}

/* Lists, names and values; what lies behind the end fails in the next take(). */
static void skip(cursor *c, uint64_t bytes) {
    const uint64_t padded = bytes + (4 - bytes % 4) % 4;
    const uint64_t size = file_size(c->f);
    c->at = padded > size || c->at + padded > size ? size : c->at + padded;
}

static uint64_t take_count(cursor *c) {
    return take(c, c->version == 5 ? 8 : 4);
}

static void skip_name(cursor *c) {
    skip(c, take_count(c));
}

static uint64_t type_bytes(uint64_t type) {
    static const uint8_t bytes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    return type < sizeof bytes ? bytes[type] : 0;
}

static uint64_t begin_list(cursor *c) {
    take(c, 4); /* what it is of */
    return take_count(c);
}

static void skip_attributes(cursor *c) {
    for (uint64_t n = begin_list(c); n > 0 && c->st == ST_OK; n--) {
        skip_name(c);
        const uint64_t type = take(c, 4), count = take_count(c);
        skip(c, count > file_size(c->f) ? count : count * type_bytes(type));
    }
}

static uint64_t take_variable(cursor *c) {
    skip_name(c);
    for (uint64_t n = take_count(c); n > 0 && c->st == ST_OK; n--)
        take_count(c);
    skip_attributes(c);
    take(c, 4);
    take_count(c);
    return take(c, c->version == 1 ? 4 : 8);
}

/* The byte where the data of a variable begin. */
static status find_begin(file *f, int version, int id, uint64_t *begin) {
    cursor c = {.f = f, .at = 4, .version = version};
    take_count(&c);
    for (uint64_t n = begin_list(&c); n > 0 && c.st == ST_OK; n--) {
        skip_name(&c);
        take_count(&c);
    }
    skip_attributes(&c);
    begin_list(&c);
    for (int i = 0; i <= id && c.st == ST_OK; i++)
        *begin = take_variable(&c);
    return c.st;
}

/* ---- sizes ---- */

/* Bytes of a variable, or where it grows of one record. */
static uint64_t bytes_of(const netcdf_variable *v) {
    nc_type type = NC_NAT;
    nc_inq_vartype(v->group, v->id, &type);
    uint64_t bytes = type_bytes((uint64_t)type);
    for (int i = v->grows; i < v->rank; i++)
        bytes = v->count[i] && bytes > UINT64_MAX / 2 / v->count[i] ? UINT64_MAX / 2
                                                                    : bytes * v->count[i];
    return bytes;
}

/* Of all variables that grow, one after the other, each to a bound of four bytes; of one alone
 * without. */
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
    uint8_t magic[4];
    uint64_t begin = 0;
    status st = file_read_at(f, 0, magic, sizeof magic);
    if (st != ST_OK || memcmp(magic, "CDF", 3) != 0)
        return st;
    st = find_begin(f, magic[3], v->id, &begin);
    return st == ST_OK ? check_end(f, v, start, begin) : st;
}
