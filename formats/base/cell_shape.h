/* cell_shape.h - the shapes of cells in unstructured meshes, and all of them as hexahedra.
 *
 * A wedge, a pyramid and a tet are hexahedra with corners that are the same. Then the trilinear
 * form is what is usual for the shape: linear in the triangle times linear along the wedge;
 * bilinear in the pyramid's base, linear from there to the apex; linear in the tet. A quadratic tet
 * is of its own kind.
 */
#ifndef FORMATS_BASE_CELL_SHAPE_H
#define FORMATS_BASE_CELL_SHAPE_H

#include <stdint.h>

/* And the order of a shape's vertices. Also the index into mesh_report.split and .whole. */
typedef enum cell_shape {
    CELL_HEXAHEDRON, /* 8: bottom quad around, then the top one above it (VTK_HEXAHEDRON) */
    CELL_WEDGE,      /* 6: a triangle, then the opposite one; edges 0-3, 1-4, 2-5 */
    CELL_PYRAMID,    /* 5: quad around, then the apex */
    CELL_VOXEL,      /* 8: x fastest (VTK_VOXEL) */
    CELL_SPLIT_SHAPES,
    CELL_TET = CELL_SPLIT_SHAPES, /* 4 */
    CELL_QUADRATIC_TET,           /* 10: quadratic_tet.h; the one that is no hexahedron */
    CELL_SHAPES
} cell_shape;

enum { CELL_VERTICES_MAX = 10 };

/* cell_shape_vertices() - their number. cell_shape_row() - for each place of a cell's row
 * (cell_row.h) the vertex that is there. */
int cell_shape_vertices(cell_shape shape);
const uint8_t *cell_shape_row(cell_shape shape);

#endif
