/* grid_codes.h - the codes of a treelet's min/max tree (FORMAT.md 4), from its samples.
 *
 * Converting and loading both stand on it, so it reads each sample once, vectorises along x, and
 * does not allocate.
 */
#ifndef FORMATS_LEAF_GRID_CODES_H
#define FORMATS_LEAF_GRID_CODES_H

#include <stddef.h>
#include <stdint.h>

#include "formats/leaf/leaf_layout.h"

/* Memory of one thread, aligned to 64 bytes: grid_codes_scratch_bytes() of it, for treelets with so
 * many levels of nodes (leaf_payload.node_levels). */
typedef struct grid_codes_scratch grid_codes_scratch;
size_t grid_codes_scratch_bytes(uint32_t node_levels);

/* A treelet's data for the directory. */
typedef struct grid_summary {
    float own[2]; /* +inf, -inf if no sample is finite; never -0 */
    uint8_t flags;
} grid_summary;

/* grid_codes_make() - write all of a treelet's payload but its samples, which must be there:
 * leaf_layout_payload(t).bytes, aligned to 64. Returns what follows from them. */
grid_summary grid_codes_make(const leaf_layout *l, uint32_t t, grid_codes_scratch *s,
                             void *payload);

/* grid_codes_make_within() - the same, with codes relative to a range that holds all finite
 * samples. */
void grid_codes_make_within(const leaf_layout *l, uint32_t t, const float range[2],
                            grid_codes_scratch *s, void *payload);

#endif
