/* hex_pieces.h - path_pieces.h in a hexahedron, whose wedges and tets are opened (hex_open.h). */
#ifndef RENDER_CURVED_HEX_PIECES_H
#define RENDER_CURVED_HEX_PIECES_H

#include "formats/curved/hex_path.h"
#include "render/curved/path_pieces.h"

/* hex_pieces() - as path_pieces().
 *
 * sense    hexahedron_sense(); 0: the cell is folded */
int hex_pieces(const hexahedron *h, int sense, const hex_path *path, double tolerance,
               path_piece out[PATH_PIECES], path_counts *counts);

#endif
