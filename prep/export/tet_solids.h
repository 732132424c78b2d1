/* tet_solids.h - a mesh as it is, treelet by treelet: its points, tets and values.
 *
 * The file does not say which vertices of two treelets are one. Vertices count as one if their
 * coordinates and their values of the chosen fields are equal. Tets are turned so that their volume
 * is positive.
 */
#ifndef PREP_EXPORT_TET_SOLIDS_H
#define PREP_EXPORT_TET_SOLIDS_H

#include "prep/export/piece.h"
#include "prep/export/tet_bench.h"

/* tet_solids_create() - release *out. choice must outlive it. */
CHECKED status tet_solids_create(mem *m, const cell_choice *choice, int threads, piece_source *out);

/* tet_solids_worker() - bytes that each thread needs besides its piece. */
uint64_t tet_solids_worker(const cell_choice *choice);

#endif
