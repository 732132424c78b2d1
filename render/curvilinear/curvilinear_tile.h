/* curvilinear_tile.h - traces the primary rays of 32 x 32 pixels through a curvilinear grid
 * together: the counterpart of mesh/mesh_tile.h.
 *
 * The tree over the treelets, and the trees over their blocks, are walked once for all rays of a
 * tile. The nodes of a block are projected once; a cell covers the pixels between those of its
 * corners. The rays of these pixels meet the cell a vector at a time, by the operations of single
 * rays (curved/curved_meet_template.h). So the picture has the same bits as with single rays.
 */
#ifndef RENDER_CURVILINEAR_CURVILINEAR_TILE_H
#define RENDER_CURVILINEAR_CURVILINEAR_TILE_H

#include "render/curved/hex_tile.h"

/* By ISA. Scalar: NULL, so each ray is traced by itself. */
extern const tile_fn curvilinear_tile_kernels[CPU_ISAS];

#endif
