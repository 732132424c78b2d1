#include "stream/mixed_resident.h"

#include "formats/leaf/mixed_geometry.h"

static mixed_blocks *blocks_of(resident_hexes *tr) {
    return &((resident_mixed *)tr)->blocks;
}

static mixed_shape shape_of(const leaf_file *f, uint32_t t) {
    return mixed_shape_of(mixed_directory_of(f)->counts[t]);
}

static size_t bytes(const leaf_file *f, uint32_t t) {
    const mixed_shape shape = shape_of(f, t);
    return mixed_blocks_bytes(&shape);
}

static status make(resident_hexes *tr, mem *m, const hex_treelet *h) {
    const mixed_shape shape = shape_of(h->f, h->id);
    const status st = mixed_blocks_init(blocks_of(tr), m, &shape, h->topology, h->places);
    if (st == ST_OK)
        blocks_of(tr)->first = mixed_directory_of(h->f)->first[h->id];
    return st;
}

static void release(resident_hexes *tr) {
    mixed_blocks_release(blocks_of(tr));
}

static void move(resident_hexes *tr) {
    mixed_blocks_move(blocks_of(tr));
}

static void fill(resident_hexes *tr, const float *values) {
    mixed_blocks_fill(blocks_of(tr), values);
}

static void activate(resident_hexes *tr, const interest *in) {
    mixed_blocks_select(blocks_of(tr), in);
}

static const hex_blocks blocks = {
    sizeof(resident_mixed), bytes, make, release, move, fill, activate};

const resident_kind mixed_resident = {HEX_RESIDENT_FUNCTIONS, .hexes = &blocks};
