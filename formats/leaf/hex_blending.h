/* hex_blending.h - times between the steps of kinds whose cells are hexahedra (hex_treelet.h): the
 * row of leaf_blending.h for all of them.
 *
 * Nodes and values are blended; corners stay. Cells are folded, right- or left-handed as their
 * blended nodes say. There is no cell where one of both steps has none.
 */
#ifndef FORMATS_LEAF_HEX_BLENDING_H
#define FORMATS_LEAF_HEX_BLENDING_H

#include "formats/leaf/leaf_blending.h"

extern const leaf_blending hex_blending;

#endif
