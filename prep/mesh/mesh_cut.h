/* mesh_cut.h - where one treelet ends and the next begins.
 *
 * A treelet is the largest node of the binary Morton tree that begins with a given tet and holds at
 * most so many. More tets than that of one and the same key are cut by number. What is cut depends
 * on the keys alone, not on how many are in sight.
 */
#ifndef PREP_MESH_MESH_CUT_H
#define PREP_MESH_MESH_CUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "prep/mesh/mesh_sort.h"

/* mesh_cut_next() - the number of tets of the treelet that begins with records[0].
 *
 * records sorted; count >= 1 of them in sight, more than `most`, or else all that are left.
 * before: the key before records[0]; NULL for the very first. */
size_t mesh_cut_next(const mesh_record *records, size_t count, const uint64_t *before, size_t most);

#endif
