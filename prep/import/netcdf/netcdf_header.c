#include "prep/import/netcdf/netcdf_header.h"

#include <string.h>

typedef struct cursor {
    file *f;
    uint64_t at;
    int version; /* 1, 2, 5 */
    status st;   /* the first failure; no more is read then */
} cursor;

/* Read a big-endian number of so many bytes. */
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

/* Skip padded bytes. Beyond the end of the file, the next take() fails. */
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

uint64_t netcdf_header_type_bytes(uint64_t type) {
    static const uint8_t bytes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    return type < sizeof bytes ? bytes[type] : 0;
}

static uint64_t begin_list(cursor *c) {
    take(c, 4); /* tag of the list */
    return take_count(c);
}

static void skip_attributes(cursor *c) {
    for (uint64_t n = begin_list(c); n > 0 && c->st == ST_OK; n--) {
        skip_name(c);
        const uint64_t type = take(c, 4), count = take_count(c);
        skip(c, count > file_size(c->f) ? count : count * netcdf_header_type_bytes(type));
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

status netcdf_header_begin(file *f, int id, uint64_t *begin) {
    uint8_t magic[4];
    *begin = 0;
    status st = file_read_at(f, 0, magic, sizeof magic);
    if (st != ST_OK || memcmp(magic, "CDF", 3) != 0)
        return st;
    return find_begin(f, magic[3], id, begin);
}
