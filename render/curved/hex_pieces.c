#include "render/curved/hex_pieces.h"

#include <math.h>

#include "formats/base/vec3.h"
#include "formats/curved/hex_open.h"

int hex_pieces(const hexahedron *h, int sense, const hex_path *path, double tolerance,
               path_piece out[PATH_PIECES], path_counts *counts) {
    hex_opened opened;
    path_part parts[PATH_PARTS];
    double range[2] = {INFINITY, -INFINITY};
    for (int c = 0; c < HEX_CORNERS; c++) {
        range[0] = real_min(range[0], h->value[c]);
        range[1] = real_max(range[1], h->value[c]);
    }
    hex_open(h, path, &opened);
    hex_open_parts(&opened, path, parts);
    return path_pieces(&opened.map, parts, path->count, sense == 0, range, tolerance, out, counts);
}
