/* curvilinear_coder.h - the payloads of a curvilinear grid's treelet as streams. CURVILINEAR.md
 * says the same byte for byte.
 *
 * counts: cells along i, j, k.
 */
#ifndef FORMATS_LEAF_CURVILINEAR_CODER_H
#define FORMATS_LEAF_CURVILINEAR_CODER_H

#include "formats/leaf/leaf_coder.h"

extern const leaf_coder curvilinear_coder;

#endif
