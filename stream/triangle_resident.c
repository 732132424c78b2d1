#include "stream/triangle_resident.h"

#include "formats/leaf/triangle_geometry.h"

static triangle_blocks *blocks_of(resident_hexes *tr) {
    return &((resident_triangles *)tr)->blocks;
}

static triangle_shape shape_of(const leaf_file *f, uint32_t t) {
    return triangle_shape_of(triangle_directory_of(f)->counts[t]);
}

static size_t bytes(const leaf_file *f, uint32_t t) {
    const triangle_shape shape = shape_of(f, t);
    return triangle_blocks_bytes(&shape);
}

static status make(resident_hexes *tr, mem *m, const hex_treelet *h) {
    const triangle_shape shape = shape_of(h->f, h->id);
    const status st = triangle_blocks_init(blocks_of(tr), m, &shape,
                                           triangle_rows(&shape, h->topology), h->places);
    if (st == ST_OK)
        blocks_of(tr)->first = triangle_directory_of(h->f)->first[h->id];
    return st;
}

static void release(resident_hexes *tr) {
    triangle_blocks_release(blocks_of(tr));
}

static void move(resident_hexes *tr) {
    triangle_blocks_move(blocks_of(tr));
}

static void fill(resident_hexes *tr, const float *values) {
    triangle_blocks_fill(blocks_of(tr), values);
}

static void activate(resident_hexes *tr, const interest *in) {
    triangle_blocks_select(blocks_of(tr), in);
}

static const hex_blocks blocks = {
    sizeof(resident_triangles), bytes, make, release, move, fill, activate};

const resident_kind triangle_resident = {HEX_RESIDENT_FUNCTIONS, .hexes = &blocks};
