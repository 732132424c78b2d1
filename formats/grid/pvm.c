#include "formats/grid/pvm.h"

#include <string.h>

#include "formats/input/dds_stream.h"
#include "formats/input/text_tokens.h"

static bool known(const char *path, const uint8_t *start, size_t size) {
    (void)path;
    return dds_stream_known(start, size) ||
           (size >= 5 && (memcmp(start, "PVM\n", 4) == 0 || memcmp(start, "PVM2\n", 5) == 0 ||
                          memcmp(start, "PVM3\n", 5) == 0));
}

static status unpack(volume_layout *l) {
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(l->data, GRID_READER_PEEK, &start, &size);
    if (st != ST_OK || !dds_stream_known(start, size))
        return st;
    byte_stream *packed = l->data;
    l->data = NULL;
    return dds_stream_open(l->m, packed, &l->data);
}

static status read_version(text_tokens *t, int *version) {
    status st = text_tokens_next(t);
    if (st != ST_OK)
        return st;
    *version = strcmp(t->token, "PVM") == 0    ? 1
               : strcmp(t->token, "PVM2") == 0 ? 2
               : strcmp(t->token, "PVM3") == 0 ? 3
                                               : 0;
    return *version ? text_tokens_end_line(t) : text_tokens_fault(t, "expected PVM, PVM2 or PVM3");
}

static status read_line_of_sizes(text_tokens *t, uint32_t dims[3]) {
    status st = ST_OK;
    for (int a = 0; a < 3 && st == ST_OK; a++) {
        int64_t size = 0;
        st = text_tokens_int(t, "a number of voxels", 1, UINT32_MAX, &size);
        dims[a] = (uint32_t)size;
    }
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

static status read_line_of_spacings(text_tokens *t, double spacing[3]) {
    status st = ST_OK;
    for (int a = 0; a < 3 && st == ST_OK; a++)
        st = text_tokens_double(t, "the size of a voxel", &spacing[a]);
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

static status read_bytes(text_tokens *t, volume_layout *l) {
    int64_t bytes = 0;
    status st = text_tokens_int(t, "1 to 4 bytes a voxel", 1, 4, &bytes);
    if (st == ST_OK)
        st = text_tokens_end_line(t);
    l->stored.type = bytes == 2 ? SAMPLE_U16 : SAMPLE_U8;
    l->stored.components = bytes > 2 ? (uint32_t)bytes : 1;
    l->stored.colours = true;
    l->big_endian = true;
    return st;
}

static status open_layout(volume_layout *l, const volume_hints *hints) {
    double direction[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0};
    uint32_t dims[3] = {0, 0, 0};
    int version = 0;
    (void)hints;
    status st = unpack(l);
    if (st != ST_OK)
        return st;
    text_tokens t = {.s = l->data, .line = 1, .comment = '#'};
    st = read_version(&t, &version);
    if (st == ST_OK)
        st = read_line_of_sizes(&t, dims);
    if (st == ST_OK && version > 1)
        st = read_line_of_spacings(&t, spacing);
    if (st == ST_OK)
        st = read_bytes(&t, l);
    if (st != ST_OK)
        return st;
    grid_init(&l->g, dims, SAMPLE_U8);
    volume_layout_place(l, direction, spacing, origin);
    l->has_tail = version == 3;
    return ST_OK;
}

const grid_reader pvm_reader = {.format = "PVM", .known = known, .layout = open_layout};
