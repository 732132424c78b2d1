#include "formats/base/cell_shape.h"

#include "formats/base/cell_row.h"

static const struct {
    int vertices;
    uint8_t row[CELL_ROW];
} shapes[CELL_SHAPES] = {
    [CELL_HEXAHEDRON] = {8, {0, 1, 3, 2, 4, 5, 7, 6, 0, 0}},
    [CELL_WEDGE] = {6, {0, 1, 2, 2, 3, 4, 5, 5, 0, 0}},
    [CELL_PYRAMID] = {5, {0, 1, 3, 2, 4, 4, 4, 4, 0, 0}},
    [CELL_VOXEL] = {8, {0, 1, 2, 3, 4, 5, 6, 7, 0, 0}},
    [CELL_TET] = {4, {0, 1, 2, 2, 3, 3, 3, 3, 0, 0}},
    [CELL_QUADRATIC_TET] = {10, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}},
};

int cell_shape_vertices(cell_shape shape) {
    return shapes[shape].vertices;
}

const uint8_t *cell_shape_row(cell_shape shape) {
    return shapes[shape].row;
}
