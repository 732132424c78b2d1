/* triangle_coder.h - payloads of triangles as streams (leaf_coder.h).
 *
 * counts: as in section COUNTS, without a triangle_counts_fault().
 */
#ifndef FORMATS_LEAF_TRIANGLE_CODER_H
#define FORMATS_LEAF_TRIANGLE_CODER_H

#include "formats/leaf/leaf_coder.h"

extern const leaf_coder triangle_coder;

#endif
