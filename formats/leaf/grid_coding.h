/* grid_coding.h - compressed payloads of grids (FORMAT.md 10): a treelet's own samples, and what
 * treelets of a family share. Codes of trees are not stored, but made anew. */
#ifndef FORMATS_LEAF_GRID_CODING_H
#define FORMATS_LEAF_GRID_CODING_H

#include "formats/leaf/grid_family.h"
#include "formats/leaf/leaf_layout.h"

/* grid_coding_pack() - code payload p into out, of leaf_layout_stored() bytes. from: a treelet's
 * payload, or a shell's samples. Returns the bytes it takes. */
size_t grid_coding_pack(const leaf_layout *l, uint32_t p, box_coder *c, const void *from,
                        void *out);

/* grid_coding_pack_from() - the same, as differences to earlier samples of that payload where that
 * is smaller (box_coder_encode_from()). earlier: like `from`. Returns 0 if they are all the same.
 * grid_coding_hash() - a hash of the samples that payload p codes. */
size_t grid_coding_pack_from(const leaf_layout *l, uint32_t p, box_coder *c, const void *from,
                             const void *earlier, void *out);
uint64_t grid_coding_hash(const leaf_layout *l, uint32_t p, box_coder *c, const void *from);

/* grid_coding_unpack() - decode a shell's samples; or a treelet's own samples into its payload, of
 * which the rest is left alone. difference: to the samples that are there. False: the bytes are no
 * code of it. */
CHECKED bool grid_coding_unpack(const leaf_layout *l, uint32_t p, box_coder *c, const void *in,
                                size_t bytes, bool difference, void *to);

#endif
