/* vdb_node.h - a node of 128^3 voxels of an OpenVDB tree, as in its file: 16^3 slots, each a tile
 * of one value or a leaf of 8^3 voxels.
 *
 * Active are exactly the voxels that differ from the background, and the two corners of the
 * exported box. So the box of active voxels is the exported one. Inactive voxels have the
 * background, so files hold active values only (active-mask compression). Values are floats or
 * 32-bit integers, here as their bits. Slots and voxels are counted with z fastest.
 */
#ifndef PREP_EXPORT_VDB_NODE_H
#define PREP_EXPORT_VDB_NODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "prep/export/grid_box.h"

enum { VDB_LEAF_LOG2 = 3, VDB_NODE_LOG2 = 7, VDB_UPPER_LOG2 = 12 };
enum {
    VDB_SLOTS = 1 << 3 * (VDB_NODE_LOG2 - VDB_LEAF_LOG2),
    VDB_VOXELS = 1 << 3 * VDB_LEAF_LOG2,
    VDB_WIDTH = 4 /* bytes of a value */
};

/* Input for a node: its samples, and what counts as background. */
typedef struct vdb_node {
    grid_box box;          /* not empty, within the node */
    const bool *empty;     /* per slot, VDB_SLOTS of them: all is background; its samples are not
                              looked at */
    sample_type type;      /* of samples */
    uint32_t background;   /* bits of its value */
    uint32_t corner[2][3]; /* voxels that are active whatever their value */
} vdb_node;

/* vdb_node_bits() - a sample as the bits of a value. */
uint32_t vdb_node_bits(sample_type type, const void *sample);

/* vdb_node_topology(), vdb_node_values() - write the two parts of a node in a file to `out`. Return
 * the bytes written, at most .._max(). */
size_t vdb_node_topology(const vdb_node *n, unsigned char *out);
size_t vdb_node_topology_max(void);
size_t vdb_node_values(const vdb_node *n, unsigned char *out);
size_t vdb_node_values_max(void);

/* vdb_put() - write a number's four bytes. Returns the place behind. */
unsigned char *vdb_put(unsigned char *at, uint32_t bits);

#endif
