/* deviation_verify.h - a coarse treelet's deviations against its samples and its children's. */
#ifndef FORMATS_LEAF_DEVIATION_VERIFY_H
#define FORMATS_LEAF_DEVIATION_VERIFY_H

#include "formats/leaf/leaf_file.h"

/* deviation_verify_bytes() - room for a child's payload, its stored bytes beside it, and scratch.
 * deviation_verify() - of treelet t of a level above 0 in a set of a file with deviations, whose
 * payload this is: each brick's is at least what (1) in deviation.h says by the children's.
 * ST_CORRUPT: one is less. room: 64-byte aligned. */
size_t deviation_verify_bytes(const leaf_layout *l);
CHECKED status deviation_verify(leaf_file *f, uint32_t set, uint32_t t, const void *payload,
                                void *room);

#endif
