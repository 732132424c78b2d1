/* hex_tile.h - the primary rays of 32 x 32 pixels through cells with bent faces, together: what is
 * the same for all kinds of such cells (hex_tile_template.h).
 */
#ifndef RENDER_CURVED_HEX_TILE_H
#define RENDER_CURVED_HEX_TILE_H

#include "render/frame/tile.h"

/* HEX_TILE: pixels on a side. HEX_TILE_SCRATCH: bytes that a tile_fn needs beside its outcome. */
enum { HEX_TILE = 32, HEX_TILE_SCRATCH = 960 << 10 };

#endif
