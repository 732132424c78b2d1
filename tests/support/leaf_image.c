#include "tests/support/leaf_image.h"

#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "formats/base/hash.h"
#include "formats/leaf/leaf_check.h"

leaf_image leaf_image_as_is(char *bytes, size_t size) {
    leaf_image i = {.bytes = bytes, .size = size};
    i.header = (leaf_header *)bytes;
    i.table = (leaf_section *)(bytes + leaf_table_at(i.header));
    const leaf_section *last = &i.table[i.header->sections - 1];
    i.sections_end = last->offset + last->bytes;
    return i;
}

bool leaf_image_is_directory(const leaf_image *i, uint64_t at) {
    const uint64_t table = leaf_table_at(i->header);
    return at < LEAF_HEADER_BYTES || (at >= table && at < i->sections_end);
}

static void unpack(const char *frame, const leaf_section *from, char *to, const leaf_section *s) {
    if (from->version == LEAF_SECTION_PLAIN)
        memcpy(to, frame, s->bytes);
    else if (ZSTD_decompress(to, s->bytes, frame, from->bytes) != s->bytes)
        abort();
}

/* A file of which the directory lies behind the payloads, with plain sections. */
static leaf_image unpacked(const leaf_image *packed) {
    leaf_section table[LEAF_SECTIONS_MAX];
    const uint32_t count = packed->header->sections;
    const uint64_t run = packed->header->run_align_log2;
    uint64_t end = packed->header->directory + count * sizeof *table;
    for (uint32_t n = 0; n < count; n++) {
        const leaf_section *s = &packed->table[n];
        const uint64_t bytes = s->version == LEAF_SECTION_PLAIN
                                   ? s->bytes
                                   : leaf_section_bytes(packed->header, s->kind);
        table[n] =
            (leaf_section){s->kind, LEAF_SECTION_PLAIN, leaf_layout_aligned(end, 6), bytes, 0};
        end = table[n].offset + bytes;
    }
    const size_t size = (size_t)leaf_layout_aligned(end, (uint32_t)run);
    char *bytes = calloc(1, size);
    if (!bytes)
        abort();
    memcpy(bytes, packed->bytes, (size_t)packed->header->directory);
    memcpy(bytes + packed->header->directory, table, count * sizeof *table);
    for (uint32_t n = 0; n < count; n++)
        unpack(packed->bytes + packed->table[n].offset, &packed->table[n], bytes + table[n].offset,
               &table[n]);
    leaf_image i = leaf_image_as_is(bytes, size);
    i.header->file_bytes = size;
    leaf_image_seal(&i);
    return i;
}

leaf_image leaf_image_of(char *bytes, size_t size) {
    const leaf_image i = leaf_image_as_is(bytes, size);
    if (!i.header->directory)
        return i;
    const leaf_image plain = unpacked(&i);
    free(bytes);
    return plain;
}

/* Sections whose entries lie in the file. */
static uint32_t sections_of(const leaf_image *i) {
    const uint64_t at = leaf_table_at(i->header);
    const uint32_t count = i->header->sections;
    const size_t room = at < i->size ? (i->size - (size_t)at) / sizeof *i->table : 0;
    return count <= LEAF_SECTIONS_MAX && count <= room ? count : 0;
}

static bool is_inside(const leaf_image *i, uint64_t offset, uint64_t bytes) {
    return offset <= i->size && bytes <= i->size - offset;
}

static const leaf_section *find(const leaf_image *i, uint32_t kind) {
    for (uint32_t n = 0; n < sections_of(i); n++)
        if (i->table[n].kind == kind && is_inside(i, i->table[n].offset, i->table[n].bytes))
            return &i->table[n];
    return NULL;
}

void *leaf_image_section(const leaf_image *i, uint32_t kind) {
    const leaf_section *s = find(i, kind);
    return s ? i->bytes + s->offset : NULL;
}

void leaf_image_seal(const leaf_image *i) {
    for (uint32_t n = 0; n < sections_of(i); n++) {
        leaf_section *s = &i->table[n];
        if (is_inside(i, s->offset, s->bytes))
            s->checksum = hash_bytes(i->bytes + s->offset, (size_t)s->bytes);
    }
    if (sections_of(i) == i->header->sections) {
        hash_id id = leaf_header_id(i->header, i->table);
        i->header->id[0] = id.lo;
        i->header->id[1] = id.hi;
    }
    i->header->checksum = leaf_header_checksum(i->header);
}

/* Entries are copied: in a hostile file the checksums may lie over the section table. */
void leaf_image_seal_payloads(const leaf_image *i) {
    const leaf_section *found[] = {find(i, LEAF_SECTION_CHECKSUMS), find(i, LEAF_SECTION_OFFSETS),
                                   find(i, LEAF_SECTION_SIZES)};
    if (!found[0] || !found[1] || !found[2])
        return;
    const leaf_section sums = *found[0], at = *found[1], sizes = *found[2];
    for (uint64_t p = 0;
         (p + 1) * 8 <= sums.bytes && (p + 1) * 8 <= at.bytes && (p + 1) * 8 <= sizes.bytes; p++) {
        uint64_t offset, size;
        memcpy(&offset, i->bytes + at.offset + 8 * p, 8);
        memcpy(&size, i->bytes + sizes.offset + 8 * p, 8);
        if (!is_inside(i, offset, size))
            continue;
        const uint64_t sum = size ? hash_bytes(i->bytes + offset, (size_t)size) : 0;
        memcpy(i->bytes + sums.offset + 8 * p, &sum, 8);
    }
}
