/* triangle_treelet.h - makes the payloads of one treelet of triangles (triangle_geometry.h): a row
 * of cell_treelet.h.
 */
#ifndef PREP_MESH_TRIANGLE_TREELET_H
#define PREP_MESH_TRIANGLE_TREELET_H

#include "prep/mesh/cell_treelet.h"

/* The three ids of a triangle are different. */
extern const cell_treelets triangle_treelets;

#endif
