/* triangle_cells.h - a surface as it is, treelet by treelet: its points, triangles and values.
 *
 * Vertices count as one if their coordinates, normals and values of the chosen fields are equal.
 * Triangles keep their sides, and those without an area are kept.
 */
#ifndef PREP_EXPORT_TRIANGLE_CELLS_H
#define PREP_EXPORT_TRIANGLE_CELLS_H

#include "prep/export/cell_choice.h"
#include "prep/export/piece.h"

/* triangle_cells_create() - release *out. choice must outlive it. */
CHECKED status triangle_cells_create(mem *m, const cell_choice *choice, int threads,
                                     piece_source *out);

/* triangle_cells_worker() - bytes that each thread needs besides its piece. */
uint64_t triangle_cells_worker(const cell_choice *choice);

#endif
