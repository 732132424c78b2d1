/* mesh_layout.h - the layout of a mesh file: all that follows from the numbers of its treelets,
 * fields and steps, and from its COUNTS.
 */
#ifndef FORMATS_LEAF_MESH_LAYOUT_H
#define FORMATS_LEAF_MESH_LAYOUT_H

#include "formats/leaf/leaf_layout.h"

/* The payloads of a mesh, in blocks of one payload per treelet (leaf.h). */
typedef struct mesh_layout_blocks {
    uint32_t treelets, fields, steps; /* 1 or more; fields * steps up to LEAF_SETS_MAX */
    bool gradients, moving;
} mesh_layout_blocks;

/* mesh_layout_payloads() - the number of payloads; 2^32 - 1 or more are too many for a file. */
uint64_t mesh_layout_payloads(const mesh_layout_blocks *b);

/* mesh_layout_of() - the layout, without allocating. mesh_layout_payloads() must be below 2^32 - 1.
 * mesh_layout_init() - the same, and make the per-treelet arrays.
 * mesh_layout_repeat() - give the layout of a mesh that does not move so many steps. False: that
 * makes 2^32 - 1 payloads or more. */
void mesh_layout_of(leaf_layout *l, const mesh_layout_blocks *b);
CHECKED status mesh_layout_init(leaf_layout *l, mem *m, const mesh_layout_blocks *b);
bool mesh_layout_repeat(leaf_layout *l, uint32_t steps);

/* mesh_layout_payload_bytes() - the bytes of payload p in memory.
 * mesh_layout_beside() - where payload p has those of two steps (leaf_layout_keep_blocks()); zeros
 * for a topology. */
uint32_t mesh_layout_payload_bytes(const leaf_layout *l, uint32_t p);
leaf_beside mesh_layout_beside(const leaf_layout *l, uint32_t p);

#endif
