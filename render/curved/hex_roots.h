/* hex_roots.h - path_roots.h in a hexahedron, whose wedges and tets are opened (hex_open.h). */
#ifndef RENDER_CURVED_HEX_ROOTS_H
#define RENDER_CURVED_HEX_ROOTS_H

#include "formats/curved/hex_path.h"
#include "render/curved/path_roots.h"

/* hex_roots() - as path_roots().
 *
 * sense    hexahedron_sense(); 0: the cell is folded */
int hex_roots(const hexahedron *h, int sense, const hex_path *path, double isovalue,
              path_root out[PATH_ROOTS], path_counts *counts);

#endif
