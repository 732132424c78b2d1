/* mixed_coder.h - the payloads of a mixed mesh's treelet as streams. MIXED.md says the same byte
 * for byte.
 *
 * counts: as in section COUNTS, without a mixed_counts_fault().
 */
#ifndef FORMATS_LEAF_MIXED_CODER_H
#define FORMATS_LEAF_MIXED_CODER_H

#include "formats/leaf/leaf_coder.h"

extern const leaf_coder mixed_coder;

#endif
