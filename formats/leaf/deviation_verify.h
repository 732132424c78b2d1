/* deviation_verify.h - checks a coarse treelet's deviations against its samples and its
 * children's. */
#ifndef FORMATS_LEAF_DEVIATION_VERIFY_H
#define FORMATS_LEAF_DEVIATION_VERIFY_H

#include "formats/leaf/leaf_unpacker.h"

/* deviation_verify_bytes() - room for a child's payload, and scratch.
 * deviation_verify() - check that each brick's deviation is at least the bound that (1) in
 * deviation.h gives from the children's. t: a treelet of a level above 0, in a set of a file with
 * deviations; payload: its payload. ST_CORRUPT: a deviation is too small. room: 64-byte aligned. */
size_t deviation_verify_bytes(const leaf_layout *l);
CHECKED status deviation_verify(leaf_file *f, uint32_t set, uint32_t t, const void *payload,
                                leaf_unpacker *u, void *room);

#endif
