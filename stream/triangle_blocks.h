/* triangle_blocks.h - a treelet of triangles in memory: triangles in blocks, a tree over these, and
 * a mask of each block's active triangles.
 *
 * Triangles are in the order of a space-filling curve, so a block is a run of them, and eight
 * blocks in a row are neighbours (treelet_tree.h).
 */
#ifndef STREAM_TRIANGLE_BLOCKS_H
#define STREAM_TRIANGLE_BLOCKS_H

#include "formats/leaf/triangle_geometry.h"
#include "stream/interest.h"
#include "stream/treelet_tree.h"

enum { TRIANGLE_BLOCK = 8 };

typedef struct triangle_blocks {
    triangle_shape shape;
    uint64_t first;            /* number of its first triangle in the whole file */
    const uint32_t *numbers;   /* of all its triangles, where these do not follow from the first;
                                  else NULL */
    const float *p[3];         /* a coordinate of all vertices, at its step */
    const float *values;       /* of all vertices */
    const uint32_t *normals;   /* of all vertices, at its step (triangle_normal.h); NULL: none */
    const uint16_t (*rows)[3]; /* of the triangles */
    treelet_tree tree;         /* over the blocks; active: those with an active triangle */
    uint32_t blocks;
    uint8_t *active; /* per block: a bit for each triangle, the first one lowest */
    mem *m;
} triangle_blocks;

/* triangle_blocks_init() - make the tree of a treelet. rows and places must outlive it; rows have
 * vertices of the treelet. triangle_blocks_bytes() - the memory that takes from m.
 * triangle_blocks_move() - coordinates are there, finite, or other ones: set boxes. */
CHECKED status triangle_blocks_init(triangle_blocks *b, mem *m, const triangle_shape *s,
                                    const uint16_t (*rows)[3], const void *places);
size_t triangle_blocks_bytes(const triangle_shape *s);
void triangle_blocks_release(triangle_blocks *b);
void triangle_blocks_move(triangle_blocks *b);

/* triangle_blocks_fill() - give it the values of a set, kept by reference. Nothing is active then.
 */
void triangle_blocks_fill(triangle_blocks *b, const float *values);

/* triangle_blocks_select() - activate the triangles whose values meet an interest: all of them
 * finite (interest.h). */
void triangle_blocks_select(triangle_blocks *b, const interest *in);

/* triangle_blocks_number() - the number of a triangle in the whole file. */
static inline uint64_t triangle_blocks_number(const triangle_blocks *b, uint32_t i) {
    return b->numbers ? b->numbers[i] : b->first + i;
}

#endif
