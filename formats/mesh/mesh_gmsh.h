/* mesh_gmsh.h - Gmsh's .msh, versions 2.2 and 4.1, text and binary of either byte order.
 *
 * Points are numbered in the order of $Nodes; the file's own numbers go through an id_map. Tets,
 * hexes, prisms and pyramids of the first order are taken, cells of fewer dimensions skipped, all
 * others refused. Fields by name: $NodeData (NaN where a node has no row; 4 bytes a point in
 * memory), $ElementNodeData (the mean over the cells at a point; 4 bytes a value), and $ElementData
 * for cells_to_points (4 bytes a cell). Sections of one name are time steps in the file's order;
 * their first real tag is the time. A name that comes once has the same values at all steps. Pipes
 * are refused: the file is read twice.
 */
#ifndef FORMATS_MESH_MESH_GMSH_H
#define FORMATS_MESH_MESH_GMSH_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader mesh_gmsh_reader;

#endif
