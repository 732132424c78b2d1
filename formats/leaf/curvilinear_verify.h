/* curvilinear_verify.h - whether the payloads of a curvilinear grid's treelet are what CURVILINEAR.md
 * says they must be (leaf_verify.h).
 */
#ifndef FORMATS_LEAF_CURVILINEAR_VERIFY_H
#define FORMATS_LEAF_CURVILINEAR_VERIFY_H

#include "formats/leaf/leaf_geometry.h"

/* curvilinear_verify() - leaf_geometry.verify: boxes and ranges are exactly those of the nodes;
 * each cell's bits are made again; a cell that is blanked has a corner without a value. */
CHECKED status curvilinear_verify(const leaf_loading *from, uint32_t treelet, uint64_t *non_finite);

#endif
