#include "render/curved/hex_roots.h"

#include "formats/curved/hex_open.h"

int hex_roots(const hexahedron *h, int sense, const hex_path *path, double isovalue,
              path_root out[PATH_ROOTS], path_counts *counts) {
    hex_opened opened;
    path_part parts[PATH_PARTS];
    hex_open(h, path, &opened);
    hex_open_parts(&opened, path, parts);
    const int count =
        path_roots(&opened.map, parts, path->count, sense == 0, isovalue, out, counts);
    for (int i = 0; i < count; i++)
        hex_open_out(&opened, out[i].at);
    return count;
}
