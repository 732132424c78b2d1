/* coarse_subjects.h - a lattice of 20^3 cells as a treelet file of each kind that coarse grids
 * stand for, in the scratch folder.
 */
#ifndef TESTS_SUPPORT_COARSE_SUBJECTS_H
#define TESTS_SUPPORT_COARSE_SUBJECTS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"

/* TETS, WHOLE_CELLS: meshes; LATTICE: a curvilinear grid, all with regular grids of 37^3 nodes.
 * THINNED: one of 36^3 cells, with the same grid of fewer nodes, and a regular one of 2 levels
 * inside. */
typedef enum subject { TETS, LATTICE, THINNED, WHOLE_CELLS, SUBJECTS } subject;

enum { SUBJECT_CELLS = 20 };

/* coarse_subjects_make() - the treelet file `name`, with a coarse grid if `coarse`; and that grid
 * as a file of its own. part_name NULL: not asked for. */
void coarse_subjects_make(mem *m, subject of, const char *name, const char *part_name, bool coarse);

/* coarse_subjects_take_part() - the coarse grid of a set of a file, as a file of its own. */
void coarse_subjects_take_part(mem *m, const char *name, uint32_t set, const char *part_name);

#endif
