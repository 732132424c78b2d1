#include "formats/base/cell_shape.h"

#include "formats/base/hexahedron.h"

static const struct {
    int vertices;
    uint8_t corner[HEX_CORNERS];
} shapes[CELL_SHAPES] = {
    [CELL_HEXAHEDRON] = {8, {0, 1, 3, 2, 4, 5, 7, 6}}, [CELL_WEDGE] = {6, {0, 1, 2, 2, 3, 4, 5, 5}},
    [CELL_PYRAMID] = {5, {0, 1, 3, 2, 4, 4, 4, 4}},    [CELL_VOXEL] = {8, {0, 1, 2, 3, 4, 5, 6, 7}},
    [CELL_TET] = {4, {0, 1, 2, 2, 3, 3, 3, 3}},
};

int cell_shape_vertices(cell_shape shape) {
    return shapes[shape].vertices;
}

const uint8_t *cell_shape_corners(cell_shape shape) {
    return shapes[shape].corner;
}
