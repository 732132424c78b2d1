#include "prep/export/vdb_node.h"

#include <endian.h>
#include <string.h>

enum {
    LEAF_SIDE = 1 << VDB_LEAF_LOG2,
    NODE_SIDE = 1 << VDB_NODE_LOG2,
    LEAF_MASK_BYTES = VDB_VOXELS / 8,
    NODE_MASK_BYTES = VDB_SLOTS / 8,
    INACTIVE_IS_BACKGROUND = 0 /* OpenVDB's NO_MASK_OR_INACTIVE_VALS */
};

unsigned char *vdb_put(unsigned char *at, uint32_t bits) {
    const uint32_t little = htole32(bits);
    memcpy(at, &little, sizeof little);
    return at + sizeof little;
}

static unsigned char *put_mask(unsigned char *at, const uint64_t *mask, int words) {
    for (int i = 0; i < words; i++, at += sizeof *mask) {
        const uint64_t little = htole64(mask[i]);
        memcpy(at, &little, sizeof little);
    }
    return at;
}

/* ---- a leaf ---- */

typedef struct leaf {
    uint32_t bits[VDB_VOXELS];
    uint64_t active[VDB_VOXELS / 64]; /* a word for each x */
    int count;                        /* active voxels */
} leaf;

/* Copy consecutive samples to values that are `apart` values apart. */
#define SPREAD(stored, number)                                 \
    for (size_t i = 0; i < count; i++) {                       \
        stored s;                                              \
        memcpy(&s, (const char *)in + i * sizeof s, sizeof s); \
        const number v = (number)s;                            \
        memcpy(out + i * apart, &v, sizeof v);                 \
    }

__attribute__((noinline)) static void spread(sample_type type, const void *in, size_t count,
                                             uint32_t *out, size_t apart) {
    switch (type) {
    case SAMPLE_U8: SPREAD(uint8_t, int32_t) break;
    case SAMPLE_I8: SPREAD(int8_t, int32_t) break;
    case SAMPLE_U16: SPREAD(uint16_t, int32_t) break;
    case SAMPLE_I16: SPREAD(int16_t, int32_t) break;
    default: SPREAD(float, float) break;
    }
}

uint32_t vdb_node_bits(sample_type type, const void *sample) {
    uint32_t bits;
    spread(type, sample, 1, &bits, 1);
    return bits;
}

/* Range of the leaf's voxels that are in the box, counted within the leaf. */
static void clip(const grid_box *b, const uint32_t origin[3], uint32_t lo[3], uint32_t end[3]) {
    for (int a = 0; a < 3; a++) {
        lo[a] = b->lo[a] > origin[a] ? b->lo[a] - origin[a] : 0;
        end[a] = b->end[a] < origin[a] + LEAF_SIDE ? b->end[a] - origin[a] : LEAF_SIDE;
    }
}

/* Copy the box's rows along x. Neighbours in x are a plane of the leaf apart. */
static void gather(const vdb_node *n, const uint32_t origin[3], uint32_t *bits) {
    const grid_box *b = &n->box;
    const size_t width = sample_size(n->type), nx = b->end[0] - b->lo[0], ny = b->end[1] - b->lo[1];
    uint32_t lo[3], end[3];
    clip(b, origin, lo, end);
    for (uint32_t z = lo[2]; z < end[2]; z++)
        for (uint32_t y = lo[1]; y < end[1]; y++) {
            const char *row =
                b->samples + (((origin[2] + z - b->lo[2]) * ny + origin[1] + y - b->lo[1]) * nx +
                              origin[0] - b->lo[0] + lo[0]) *
                                 width;
            spread(n->type, row, end[0] - lo[0], bits + (lo[0] * LEAF_SIDE + y) * LEAF_SIDE + z,
                   LEAF_SIDE * LEAF_SIDE);
        }
}

static void activate_corners(const vdb_node *n, const uint32_t origin[3], leaf *l) {
    for (int c = 0; c < 2; c++) {
        const uint32_t *at = n->corner[c];
        if (at[0] - origin[0] < LEAF_SIDE && at[1] - origin[1] < LEAF_SIDE &&
            at[2] - origin[2] < LEAF_SIDE)
            l->active[at[0] - origin[0]] |=
                UINT64_C(1) << ((at[1] - origin[1]) * LEAF_SIDE + at[2] - origin[2]);
    }
}

static void fill(const vdb_node *n, const uint32_t origin[3], leaf *l) {
    for (int i = 0; i < VDB_VOXELS; i++)
        l->bits[i] = n->background;
    gather(n, origin, l->bits);
    for (int x = 0; x < LEAF_SIDE; x++) {
        l->active[x] = 0;
        for (int i = 0; i < 64; i++)
            l->active[x] |= (uint64_t)(l->bits[64 * x + i] != n->background) << i;
    }
    activate_corners(n, origin, l);
    l->count = 0;
    for (int x = 0; x < LEAF_SIDE; x++)
        l->count += __builtin_popcountll(l->active[x]);
}

/* Returns whether all voxels are active and have one value. */
static bool is_tile(const leaf *l) {
    return l->count == VDB_VOXELS &&
           memcmp(l->bits, l->bits + 1, (VDB_VOXELS - 1) * sizeof *l->bits) == 0;
}

/* ---- a node ---- */

/* Origin of a slot. Returns false if it is empty. */
static bool slot_origin(const vdb_node *n, int slot, uint32_t origin[3]) {
    const int log2 = VDB_NODE_LOG2 - VDB_LEAF_LOG2, most = (1 << log2) - 1;
    bool meets = !n->empty[slot];
    for (int a = 0; a < 3; a++) {
        const uint32_t place = (uint32_t)(slot >> (2 - a) * log2 & most);
        origin[a] = (n->box.lo[a] & ~(uint32_t)(NODE_SIDE - 1)) + place * LEAF_SIDE;
        meets &= origin[a] < n->box.end[a] && origin[a] + LEAF_SIDE > n->box.lo[a];
    }
    return meets;
}

size_t vdb_node_topology_max(void) {
    return 2 * NODE_MASK_BYTES + 1 + (size_t)VDB_SLOTS * (VDB_WIDTH + LEAF_MASK_BYTES);
}

/* Write masks, then the tiles' values, then the leaves' masks. The latter are first put behind the
 * room for the most tiles possible. */
size_t vdb_node_topology(const vdb_node *n, unsigned char *out) {
    uint64_t children[VDB_SLOTS / 64] = {0}, tiles[VDB_SLOTS / 64] = {0};
    unsigned char *value = out + 2 * NODE_MASK_BYTES + 1;
    unsigned char *const masks = value + (size_t)VDB_SLOTS * VDB_WIDTH, *mask = masks;
    for (int slot = 0; slot < VDB_SLOTS; slot++) {
        uint32_t origin[3];
        leaf l;
        if (!slot_origin(n, slot, origin))
            continue;
        fill(n, origin, &l);
        if (l.count == 0)
            continue;
        if (is_tile(&l)) {
            tiles[slot / 64] |= UINT64_C(1) << slot % 64;
            value = vdb_put(value, l.bits[0]);
        } else {
            children[slot / 64] |= UINT64_C(1) << slot % 64;
            mask = put_mask(mask, l.active, VDB_VOXELS / 64);
        }
    }
    put_mask(out, children, VDB_SLOTS / 64);
    put_mask(out + NODE_MASK_BYTES, tiles, VDB_SLOTS / 64);
    out[2 * NODE_MASK_BYTES] = INACTIVE_IS_BACKGROUND;
    memmove(value, masks, (size_t)(mask - masks));
    return (size_t)(value - out) + (size_t)(mask - masks);
}

size_t vdb_node_values_max(void) {
    return (size_t)VDB_SLOTS * (LEAF_MASK_BYTES + 1 + VDB_VOXELS * VDB_WIDTH);
}

static unsigned char *put_leaf(unsigned char *at, const leaf *l) {
    at = put_mask(at, l->active, VDB_VOXELS / 64);
    *at++ = INACTIVE_IS_BACKGROUND;
    for (int i = 0; i < VDB_VOXELS; i++)
        if (l->active[i / 64] >> i % 64 & 1)
            at = vdb_put(at, l->bits[i]);
    return at;
}

size_t vdb_node_values(const vdb_node *n, unsigned char *out) {
    unsigned char *at = out;
    for (int slot = 0; slot < VDB_SLOTS; slot++) {
        uint32_t origin[3];
        leaf l;
        if (!slot_origin(n, slot, origin))
            continue;
        fill(n, origin, &l);
        if (l.count > 0 && !is_tile(&l))
            at = put_leaf(at, &l);
    }
    return (size_t)(at - out);
}
