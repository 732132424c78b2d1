/* mixed_treelet.h - makes the payloads of one treelet of a mixed mesh (mixed_geometry.h): a row of
 * cell_treelet.h.
 */
#ifndef PREP_MESH_MIXED_TREELET_H
#define PREP_MESH_MIXED_TREELET_H

#include "formats/leaf/mixed_geometry.h"
#include "prep/mesh/cell_treelet.h"

/* Quadratic tets may be among the cells. */
enum { MIXED_TREELET_MAX = MIXED_QUADRATIC_MAX };

/* Of cells, four or more of the ids are different. */
extern const cell_treelets mixed_treelets;

#endif
