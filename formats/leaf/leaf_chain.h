/* leaf_chain.h - which payloads lead to others of earlier sets (FORMAT.md 14): one may have the
 * same bytes, or the differences to that one's samples.
 */
#ifndef FORMATS_LEAF_LEAF_CHAIN_H
#define FORMATS_LEAF_LEAF_CHAIN_H

#include "formats/leaf/leaf_layout.h"

/* Sections SAME and BASES: per payload 0, or 1 + the set that it leads to. NULL: all 0. */
typedef struct leaf_links {
    const uint32_t *same, *bases;
} leaf_links;

/* leaf_chain_home() - the payload whose bytes p has: itself, or an earlier set's.
 * leaf_chain_of() - the payloads whose codes are needed for p's samples: its home, the home's base,
 * that one's, .., up to a whole code. Returns how many, 1 to LEAF_CHAIN_MAX.
 *
 * Links must be sound, as leaf_check_directory() finds them. */
uint32_t leaf_chain_home(const leaf_layout *l, const leaf_links *links, uint32_t p);
int leaf_chain_of(const leaf_layout *l, const leaf_links *links, uint32_t p,
                  uint32_t chain[LEAF_CHAIN_MAX]);

#endif
