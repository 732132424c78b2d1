/* block_blending.h - what kinds with blocks of payloads (leaf_layout.h) share of leaf_blending.h:
 * which payload of a file between steps stands for what, and the boxes of its treelets.
 *
 * Where cells move, set 0 stands for no moment: as in any file, it has its places in the
 * topologies.
 */
#ifndef FORMATS_LEAF_BLOCK_BLENDING_H
#define FORMATS_LEAF_BLOCK_BLENDING_H

#include "formats/leaf/leaf_blending.h"

/* Of the table: first_set, fill, set_of, alike. */
uint32_t block_blending_first_set(const leaf_layout *l);
void block_blending_fill(leaf_file *f, uint32_t set, const uint32_t sets[2], double share);
uint32_t block_blending_set_of(const leaf_layout *l, uint32_t p);
uint32_t block_blending_alike(const leaf_layout *l, uint32_t p, const leaf_layout *of,
                              uint32_t set);

/* block_blending_mix() - blend `count` floats that lie `at` bytes from the start of their payloads.
 * first: those of the first step. */
void block_blending_mix(const leaf_mix *m, const void *first, uint32_t at, size_t count);

#endif
