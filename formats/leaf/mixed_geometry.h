/* mixed_geometry.h - the table of functions for mixed meshes in a treelet file: hexahedra, wedges,
 * pyramids and tets that share faces, each with its own interpolant.
 *
 * All cells are hexahedra, some with corners that are the same (formats/base/cell_shape.h). Blocks
 * of payloads are those of a mesh without gradients (leaf.h). In a treelet of n nodes and c cells:
 *
 *   topology   places of step 0, then uint16_t rows[c][8]: nodes at the corners of a hexahedron
 *              (formats/base/hexahedron.h); rows[c][10] if q > 0 (formats/base/cell_row.h); zeros
 *              up to a multiple of LEAF_ALIGN
 *   positions  places of a later step
 *   places     float x[n], y[n], z[n]; then the cells' hex_code, four a byte, the first one lowest;
 *              zeros up to a multiple of LEAF_ALIGN
 *   values     float[n]; zeros up to a multiple of LEAF_ALIGN
 *
 * A treelet's nodes are in the order in which its cells' rows use them first. A node that
 * several treelets share has the same bits in all. Cells are in the order of a space-filling curve.
 * COUNTS: c, n, q, 0; q: quadratic tets among the cells. What bounds positions and values bounds
 * the coefficients of such tets, too, rounded outward (curved_quadratic_limits()). Of the header:
 * tets: cells; vertices: nodes of the whole mesh, each once; treelet_tets: cells in a treelet at
 * most; flat: cells that are folded at step 0.
 */
#ifndef FORMATS_LEAF_MIXED_GEOMETRY_H
#define FORMATS_LEAF_MIXED_GEOMETRY_H

#include "formats/base/cell_row.h"
#include "formats/base/hexahedron.h"
#include "formats/leaf/leaf_cells.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_layout.h"

/* Cells of a treelet, so that 16 bits number its nodes; if some are quadratic. */
enum { MIXED_CELLS_MAX = 8192, MIXED_QUADRATIC_MAX = 6553 };

/* Where the parts of a treelet's payloads begin, in bytes. */
typedef struct mixed_shape {
    uint32_t cells, nodes, quadratic;
    uint32_t width;             /* of a row */
    uint32_t codes_at, rows_at; /* of a topology; places end at the latter */
    uint32_t place_bytes, topology_bytes, value_bytes;
} mixed_shape;

/* mixed_shape_of() - counts: an element of COUNTS, without a mixed_counts_fault().
 * mixed_counts_fault() - what a treelet of a file with this header cannot have; NULL: it is sound.
 */
mixed_shape mixed_shape_of(const uint32_t counts[4]);
const char *mixed_counts_fault(const uint32_t counts[4], uint32_t treelet_cells);

static inline uint32_t mixed_rows_bytes(const mixed_shape *s) {
    return s->cells * s->width * (uint32_t)sizeof(uint16_t);
}

/* The parts. topology, places, values: a treelet's payloads. */
static inline const float *mixed_coordinates(const mixed_shape *s, const void *places, int axis) {
    return (const float *)places + (size_t)axis * s->nodes;
}
static inline hex_code mixed_code(const mixed_shape *s, const void *places, uint32_t cell) {
    const uint8_t *codes = (const uint8_t *)places + s->codes_at;
    return (hex_code)(codes[cell / 4] >> 2 * (cell % 4) & 3);
}
static inline const uint16_t *mixed_rows(const mixed_shape *s, const void *topology) {
    return (const uint16_t *)(const void *)((const char *)topology + s->rows_at);
}
/* The row of a cell, its width made up for. */
static inline void mixed_row(const mixed_shape *s, const uint16_t *rows, uint32_t cell,
                             uint32_t row[CELL_ROW]) {
    const uint16_t *from = rows + (size_t)s->width * cell;
    for (uint32_t k = 0; k < CELL_ROW; k++)
        row[k] = from[k < s->width ? k : 0];
}

/* mixed_widen() - widen the limits of what the nodes have (a coordinate, or the value) to what the
 * treelet's quadratic tets may have in between; of those that have numbers at all nodes. */
void mixed_widen(const mixed_shape *s, const uint16_t *rows, const float *of_nodes, float *least,
                 float *greatest);

/* mixed_directory_of() - what the directory has besides. */
static inline const leaf_cells_directory *mixed_directory_of(const leaf_file *f) {
    return f->besides;
}

extern const leaf_geometry mixed_geometry;

#endif
