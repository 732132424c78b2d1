/* curvilinear_verify.h - whether the payloads of a curvilinear grid's treelet are what
 * CURVILINEAR.md says they must be: a row of leaf_verify.h. Boxes and ranges are exactly those of
 * the nodes; each cell's bits are made again; a cell that is blanked has a corner without a value.
 */
#ifndef FORMATS_LEAF_CURVILINEAR_VERIFY_H
#define FORMATS_LEAF_CURVILINEAR_VERIFY_H

#include "formats/leaf/leaf_geometry.h"

extern const leaf_verifier curvilinear_verifier;

#endif
