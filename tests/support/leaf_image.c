#include "tests/support/leaf_image.h"

#include <string.h>

#include "formats/base/hash.h"
#include "formats/leaf/leaf_check.h"

leaf_image leaf_image_of(char *bytes, size_t size) {
    leaf_image i = {.bytes = bytes, .size = size};
    i.header = (leaf_header *)bytes;
    i.table = (leaf_section *)(bytes + LEAF_HEADER_BYTES);
    const leaf_section *last = &i.table[i.header->sections - 1];
    i.sections_end = last->offset + last->bytes;
    return i;
}

/* Sections whose entries lie in the file. */
static uint32_t sections_of(const leaf_image *i) {
    const uint32_t count = i->header->sections;
    const size_t room = (i->size - LEAF_HEADER_BYTES) / sizeof *i->table;
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
