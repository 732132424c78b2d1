/* mixed_tile.h - traces the primary rays of 32 x 32 pixels through a mixed mesh together: the
 * counterpart of curvilinear/curvilinear_tile.h, with the cells of a block one by one, as they
 * share no rows of nodes. The picture has the same bits as with single rays.
 */
#ifndef RENDER_MIXED_MIXED_TILE_H
#define RENDER_MIXED_MIXED_TILE_H

#include "render/curved/hex_tile.h"

/* By ISA. Scalar: NULL, so each ray is traced by itself. */
extern const tile_fn mixed_tile_kernels[CPU_ISAS];

#endif
