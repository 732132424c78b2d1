/* mesh_leaf.h - the payloads of a tetrahedral mesh's treelet (leaf.h, kind mesh).
 *
 *   topology   mesh_node[nodes]               the tree, breadth first; node 0 is the root
 *              uint16_t leaf_first[leaves+1]  first tet of each leaf; the last is `tets`
 *              uint16_t tets[tets][4]         vertices, strictly ascending
 *              float positions[vertices][3]   in ascending order of the mesh's vertex ids
 *   values     mesh_codes[nodes]              value ranges of each node's children
 *              float values[vertices]
 *   gradients  float gradients[vertices][3]   of a set: each vertex's mean of its tets' gradients
 *                                             in the whole mesh, weighted by volume (M08 6.3.4);
 *                                             finite; 0 0 0: no gradient
 *   positions  mesh_boxes[nodes]              at a later step: boxes of each node's children,
 *                                             which replace mesh_node's
 *              float positions[vertices][3]
 *
 * Each part ends with zeros up to a multiple of 64, so that every part is 64-byte aligned. Vertices
 * are numbered within the treelet, in the order of their ids in the whole mesh: a face that two
 * treelets share has its vertices in the same order, and with the same bits, in both.
 *
 * The tree has up to 8 children a node: inner nodes or leaves. Present children come first; all
 * children of a node are consecutive ranges of tets in ascending order, and leaves are numbered in
 * that order. Inner nodes are numbered as they are met, node by node and child by child. A node has
 * two children or more, unless the whole treelet is one leaf; a path from the root has at most
 * MESH_DEPTH_MAX nodes.
 *
 * A child's box is coded in 8 bits an axis and side, relative to the treelet's BOUNDS of the step.
 * Its range of values is coded relative to the treelet's own range (quantize.h, as f32). Both
 * contain the child by construction: mesh_leaf_plane() and quantizer_map() are monotone, and writer
 * and readers use no other functions.
 */
#ifndef FORMATS_MESH_MESH_LEAF_H
#define FORMATS_MESH_MESH_LEAF_H

#include <stdint.h>

#include "formats/leaf/quantize.h"

enum {
    MESH_NO_CHILD = 0xffff,
    MESH_LEAF = 0x8000, /* MESH_LEAF | leaf; else an inner node's index, above its parent's */
    MESH_DEPTH_MAX = 64,
    MESH_CHILDREN = 8
};

/* clang-format off */
typedef struct mesh_node {             /* offset size */
    uint8_t lo[3][MESH_CHILDREN];      /*  0  24  axis, child: code of the box's lower plane; absent: 255 */
    uint8_t hi[3][MESH_CHILDREN];      /* 24  24  of the upper plane; absent: 0 */
    uint16_t child[MESH_CHILDREN];     /* 48  16 */
} mesh_node;

typedef struct mesh_codes {            /* offset size */
    uint8_t lo[MESH_CHILDREN];         /*  0   8  quantizer_floor() of the smallest finite value */
    uint8_t hi[MESH_CHILDREN];         /*  8   8  quantizer_ceil() of the largest; absent, or no
                                                  finite value: lo = 255, hi = 0 */
} mesh_codes;

typedef struct mesh_boxes {            /* offset size */
    uint8_t lo[3][MESH_CHILDREN];      /*  0  24  as in mesh_node */
    uint8_t hi[3][MESH_CHILDREN];      /* 24  24 */
} mesh_boxes;
/* clang-format on */

_Static_assert(sizeof(mesh_node) == 64, "mesh_node is a cache line");
_Static_assert(sizeof(mesh_codes) == 16, "mesh_codes is 16 bytes");
_Static_assert(sizeof(mesh_boxes) == 48, "mesh_boxes is 48 bytes");

/* Sizes of a treelet's payloads, and where their parts begin, in bytes. */
typedef struct mesh_shape {
    uint32_t tets, vertices, nodes, leaves;
    uint32_t leaf_first_at, tets_at, positions_at; /* from the topology's start; nodes are at 0 */
    uint32_t topology_bytes;
    uint32_t values_at; /* from the values' start; codes are at 0 */
    uint32_t values_bytes;
    uint32_t gradients_bytes;
    uint32_t moved_at; /* positions, from the start of a step's payload; boxes are at 0 */
    uint32_t positions_bytes;
} mesh_shape;

/* mesh_leaf_shape() - returns the layout of a treelet's payloads. counts: an element of COUNTS
 * (tets, vertices, nodes, leaves), within the limits of mesh_leaf_counts_fault(). */
mesh_shape mesh_leaf_shape(const uint32_t counts[4]);

/* mesh_leaf_counts_fault() - returns which of a treelet's counts is impossible in a file of these
 * parameters; NULL if none is. Parameters in 1 .. LEAF_TREELET_TETS_MAX, LEAF_LEAF_TETS_MAX. */
const char *mesh_leaf_counts_fault(const uint32_t counts[4], uint32_t treelet_tets,
                                   uint32_t leaf_tets);

/* The parts of payloads in memory. */
static inline const mesh_node *mesh_leaf_nodes(const void *topology) {
    return topology;
}
static inline const uint16_t *mesh_leaf_first(const mesh_shape *s, const void *topology) {
    return (const uint16_t *)((const char *)topology + s->leaf_first_at);
}
static inline const uint16_t (*mesh_leaf_tets(const mesh_shape *s, const void *topology))[4] {
    return (const uint16_t(*)[4])((const char *)topology + s->tets_at);
}
static inline const float (*mesh_leaf_positions(const mesh_shape *s, const void *topology))[3] {
    return (const float(*)[3])((const char *)topology + s->positions_at);
}
static inline const mesh_codes *mesh_leaf_codes(const void *values) {
    return values;
}
static inline const float *mesh_leaf_values(const mesh_shape *s, const void *values) {
    return (const float *)((const char *)values + s->values_at);
}
static inline const float (*mesh_leaf_gradients(const void *gradients))[3] {
    return (const float(*)[3])gradients;
}
static inline const mesh_boxes *mesh_leaf_moved_boxes(const void *positions) {
    return positions;
}
static inline const float (*mesh_leaf_moved(const mesh_shape *s, const void *positions))[3] {
    return (const float(*)[3])((const char *)positions + s->moved_at);
}

/* ---- planes ---- */

/* Turns codes into planes. Made once per treelet. */
typedef struct mesh_frame {
    float lo[3], step[3];
} mesh_frame;

/* mesh_leaf_frame() - returns the frame of a treelet's BOUNDS at a time step. step: the smallest
 * float >= 0 with 16 significant bits (the last 8 of its 32 are zero) whose plane 255 is not below
 * hi. */
mesh_frame mesh_leaf_frame(const float bounds[6]);

/* mesh_leaf_plane() - returns the coordinate of a code's plane. Monotone: plane 0 is lo, plane 255
 * is at or beyond hi; +inf in boxes of nearly the whole range of floats. The product is exact, so
 * that the sum is the only rounding: the same bits with and without FMA, scalar or vector. */
static inline float mesh_leaf_plane(const mesh_frame *f, int axis, int code) {
    return f->lo[axis] + (float)code * f->step[axis];
}

/* mesh_leaf_code_lo() - returns the smallest code of the highest plane that is <= at (codes may
 * share a plane).
 * mesh_leaf_code_hi() - returns the smallest code whose plane is >= at. So a box's lo codes are
 * never above its hi codes. at: within the bounds. */
uint8_t mesh_leaf_code_lo(const mesh_frame *f, int axis, float at);
uint8_t mesh_leaf_code_hi(const mesh_frame *f, int axis, float at);

#endif
