/* mixed_file.h - files of mixed meshes: of the cells of cell_mix.h, as VTK has them, and converted
 * whole. Trouble fails the running test.
 */
#ifndef TESTS_SUPPORT_MIXED_FILE_H
#define TESTS_SUPPORT_MIXED_FILE_H

#include "prep/mesh/mesh_convert.h"
#include "tests/support/cell_mix.h"

/* mixed_file_write() - write a legacy VTK file. Nodes of the same position and value are one.
 * Returns how many there are. */
uint32_t mixed_file_write(const cell_mix_cell *cells, int count, const char *path);

/* mixed_file_keeps() - whether a cell has four or more different vertices: others are left out. */
bool mixed_file_keeps(const cell_mix_cell *c);

/* mixed_file_convert() - convert a mesh with its cells whole, in treelets of at most so many,
 * within `memory` bytes. */
void mixed_file_convert(const char *input, const char *output, uint32_t treelet_cells,
                        uint64_t memory, mesh_result *result);

#endif
