/* leaf_head.h - fill the header of a new treelet file as far as it is known before the payloads;
 * for leaf_writer.c. */
#ifndef FORMATS_LEAF_LEAF_HEAD_H
#define FORMATS_LEAF_LEAF_HEAD_H

#include "formats/leaf/leaf_writer.h"

/* leaf_head_grid(), leaf_head_mesh(), leaf_head_curvilinear() - fill a header of zeros. */
void leaf_head_grid(leaf_header *h, const leaf_layout *l, const leaf_parameters *p, const grid *g,
                    const leaf_sets *sets);
void leaf_head_mesh(leaf_header *h, const leaf_layout *l, const leaf_parameters *p,
                    const leaf_mesh *mesh);
void leaf_head_curvilinear(leaf_header *h, const leaf_layout *l, const leaf_parameters *p,
                           const leaf_curvilinear *g);

/* leaf_head_text() - copy a text into `size` bytes, which are zero; cut if too long. */
void leaf_head_text(char *to, size_t size, const char *text);

#endif
