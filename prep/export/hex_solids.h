/* hex_solids.h - cells that are hexahedra as they are, treelet by treelet: points, cells and
 * values.
 *
 * A hexahedron with corners that are the same is written as the wedge, pyramid or tet that it is
 * (formats/base/cell_shape.h). Nodes count as one if their coordinates and their values of the
 * chosen fields are equal. Cells are turned so that their map is right-handed. Blanked ones are
 * left out, and nodes that no other has.
 */
#ifndef PREP_EXPORT_HEX_SOLIDS_H
#define PREP_EXPORT_HEX_SOLIDS_H

#include "prep/export/cell_choice.h"
#include "prep/export/piece.h"

/* hex_solids_create() - release *out. choice must outlive it. */
CHECKED status hex_solids_create(mem *m, const cell_choice *choice, int threads, piece_source *out);

/* hex_solids_worker() - bytes that each thread needs besides its piece. */
uint64_t hex_solids_worker(const cell_choice *choice);

#endif
