/* cell_row.h - a cell of an unstructured mesh as a row of nodes.
 *
 * Either the eight corners of a hexahedron (hexahedron.h, cell_shape.h), then the first of them
 * twice more; or the ten nodes of a quadratic tet (quadratic_tet.h), no two of them the same.
 */
#ifndef FORMATS_BASE_CELL_ROW_H
#define FORMATS_BASE_CELL_ROW_H

#include <stdbool.h>
#include <stdint.h>

enum { CELL_ROW = 10 };

static inline bool cell_row_is_quadratic(const uint32_t row[CELL_ROW]) {
    return row[CELL_ROW - 2] != row[CELL_ROW - 1];
}

/* cell_row_corners() - the corners of the linear cell at a row's corners, as a hexahedron's. */
static inline void cell_row_corners(const uint32_t row[CELL_ROW], uint32_t corner[8]) {
    static const int of_tet[8] = {0, 1, 2, 2, 3, 3, 3, 3};
    for (int c = 0; c < 8; c++)
        corner[c] = row[cell_row_is_quadratic(row) ? of_tet[c] : c];
}

#endif
