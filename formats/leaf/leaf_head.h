/* leaf_head.h - what the header of a new treelet file says before its payloads are known; for
 * leaf_writer.c. */
#ifndef FORMATS_LEAF_LEAF_HEAD_H
#define FORMATS_LEAF_LEAF_HEAD_H

#include "formats/leaf/leaf_writer.h"

/* leaf_head_grid(), leaf_head_mesh() - into a header of zeros. */
void leaf_head_grid(leaf_header *h, const leaf_layout *l, const leaf_parameters *p, const grid *g,
                    const leaf_sets *sets);
void leaf_head_mesh(leaf_header *h, const leaf_layout *l, const leaf_parameters *p,
                    const leaf_mesh *mesh);

/* leaf_head_text() - a text of `size` bytes that are zero; cut if too long. */
void leaf_head_text(char *to, size_t size, const char *text);

#endif
