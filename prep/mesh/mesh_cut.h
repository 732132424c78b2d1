/* mesh_cut.h - decides where one treelet ends and the next begins.
 *
 * A treelet is the largest node of the binary Morton tree that begins with a given tet and holds at
 * most `most` tets. If more tets than that have one and the same key, they are cut by number. The
 * result depends on the keys alone, not on how many are visible.
 */
#ifndef PREP_MESH_MESH_CUT_H
#define PREP_MESH_MESH_CUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "prep/mesh/mesh_sort.h"

/* mesh_cut_next() - number of tets in the treelet that begins with records[0].
 *
 * records: sorted; count >= 1 of them, which is more than `most`, or all that are left. before: the
 * key before records[0]; NULL for the very first. */
size_t mesh_cut_next(const mesh_record *records, size_t count, const uint64_t *before, size_t most);

#endif
