/* curvilinear_lattice.h - a treelet of a curvilinear grid in memory: nodes in rows, a tree over
 * blocks of 4^3 cells, and a mask of each block's active cells.
 *
 * Cell (i, j, k) is the hexahedron between nodes (i, j, k) and (i + 1, j + 1, k + 1), trilinear in
 * position and value. Nothing is stored for a cell but two bits. Blocks are in Morton order, so
 * that eight in a row are neighbours (treelet_tree.h).
 */
#ifndef STREAM_CURVILINEAR_LATTICE_H
#define STREAM_CURVILINEAR_LATTICE_H

#include "formats/leaf/curvilinear_zones.h"
#include "stream/interest.h"
#include "stream/treelet_tree.h"

enum {
    CURVILINEAR_BLOCK_LOG2 = 2,
    CURVILINEAR_BLOCK = 1 << CURVILINEAR_BLOCK_LOG2,
    CURVILINEAR_READ = 8 /* floats that are read from any node on (hex_block.h) */
};

typedef struct curvilinear_place {
    uint8_t first[3]; /* the block's first cell, in blocks */
    uint8_t cells[3]; /* of the block along each axis, 1 to CURVILINEAR_BLOCK */
} curvilinear_place;

/* A linear function of space that is near the value in a block: gradient . (p - from). The rest is
 * trilinear in each cell, as well, so it is between what it is at nodes. */
typedef struct curvilinear_plane {
    double from[3], gradient[3];
    double rest[2]; /* least and greatest; infinite where a value is */
} curvilinear_plane;

typedef struct curvilinear_lattice {
    uint32_t cells[3], nodes[3];
    uint64_t first;       /* number of its cell (0, 0, 0) in the whole file */
    const float *p[3];    /* a coordinate of all nodes, i fastest, with room for CURVILINEAR_READ */
    const float *values;  /* of all nodes */
    const uint8_t *codes; /* of four cells a byte, the first one lowest; i fastest */
    treelet_tree tree;    /* over the blocks; active: those with an active cell */
    uint32_t blocks;
    curvilinear_place *places; /* per block */
    float (*ranges)[2];        /* of a block's finite values; inf, -inf: it has none */
    uint64_t *active;          /* per block: of its cell (i, j, k), bit i + 4 j + 16 k */
    curvilinear_plane *planes; /* per block with active cells */
    mem *m;
} curvilinear_lattice;

/* curvilinear_lattice_init() - make the tree of a treelet of cells[0] x cells[1] x cells[2] cells,
 * 1 to CURVILINEAR_SIDE each. p and codes must outlive it. curvilinear_lattice_bytes() - the memory
 * that takes from m. curvilinear_lattice_move() - coordinates are there, finite, or other ones: set
 * boxes. */
CHECKED status curvilinear_lattice_init(curvilinear_lattice *l, mem *m, const uint32_t cells[3],
                                        const float *const p[3], const uint8_t *codes);
size_t curvilinear_lattice_bytes(const uint32_t cells[3]);
void curvilinear_lattice_move(curvilinear_lattice *l);
void curvilinear_lattice_release(curvilinear_lattice *l);

/* curvilinear_lattice_fill() - give it the values of a set, kept by reference. No cell is active
 * then. */
void curvilinear_lattice_fill(curvilinear_lattice *l, const float *values);

/* curvilinear_lattice_select() - activate the cells whose values meet an interest: all eight finite
 * (interest.h), and the cell is not blanked. */
void curvilinear_lattice_select(curvilinear_lattice *l, const interest *in);

/* curvilinear_lattice_node() - the number of a block's first node. */
static inline uint32_t curvilinear_lattice_node(const curvilinear_lattice *l,
                                                const curvilinear_place *b) {
    const uint32_t i = (uint32_t)b->first[0] * CURVILINEAR_BLOCK,
                   j = (uint32_t)b->first[1] * CURVILINEAR_BLOCK,
                   k = (uint32_t)b->first[2] * CURVILINEAR_BLOCK;
    return i + l->nodes[0] * (j + l->nodes[1] * k);
}

/* curvilinear_lattice_cell() - the number, in the treelet, of cell `bit` of a block's mask. */
static inline uint32_t curvilinear_lattice_cell(const curvilinear_lattice *l,
                                                const curvilinear_place *b, unsigned bit) {
    const uint32_t i = (uint32_t)b->first[0] * CURVILINEAR_BLOCK + (bit & 3),
                   j = (uint32_t)b->first[1] * CURVILINEAR_BLOCK + (bit >> 2 & 3),
                   k = (uint32_t)b->first[2] * CURVILINEAR_BLOCK + (bit >> 4);
    return i + l->cells[0] * (j + l->cells[1] * k);
}

static inline hex_code curvilinear_lattice_code(const curvilinear_lattice *l, uint32_t index) {
    return (hex_code)(l->codes[index / 4] >> 2 * (index % 4) & 3);
}

#endif
