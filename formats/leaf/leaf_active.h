/* leaf_active.h - counts the cells of a treelet that an isovalue meets, whatever they are.
 *
 * A cell is active if the values at all of its corners are finite and min < iso && iso <= max.
 */
#ifndef FORMATS_LEAF_LEAF_ACTIVE_H
#define FORMATS_LEAF_LEAF_ACTIVE_H

#include "formats/leaf/leaf_unpacker.h"

enum { LEAF_ACTIVE_PAYLOADS = 3 };

/* Which treelet, and what for. */
typedef struct leaf_active {
    leaf_file *f;
    uint32_t set, treelet;
    double iso;
    leaf_unpacker *unpacker; /* the thread's */
    void *room; /* LEAF_ACTIVE_PAYLOADS times leaf_layout_payload_max() bytes, aligned to LEAF_ALIGN
                 */
} leaf_active;

/* leaf_active_count() - read the treelet's payloads, check them, and set *cells; 0 where cells are
 * records, which have no values. */
CHECKED status leaf_active_count(const leaf_active *a, uint64_t *cells);

#endif
