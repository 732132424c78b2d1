/* mixed_geometry.h - the table of functions for mixed meshes in a treelet file: hexahedra, wedges,
 * pyramids and tets that share faces, each with its own interpolant.
 *
 * All cells are hexahedra, some with corners that are the same (formats/base/cell_shape.h). Blocks
 * of payloads are those of a mesh without gradients (leaf.h). In a treelet of n nodes and c cells:
 *
 *   topology   places of step 0, then uint16_t corners[c][8]: nodes at the corners of a hexahedron
 *              (formats/base/hexahedron.h); zeros up to a multiple of LEAF_ALIGN
 *   positions  places of a later step
 *   places     float x[n], y[n], z[n]; then the cells' hex_code, four a byte, the first one lowest;
 *              zeros up to a multiple of LEAF_ALIGN
 *   values     float[n]; zeros up to a multiple of LEAF_ALIGN
 *
 * A treelet's nodes are in the order in which its cells' corners use them first. A node that
 * several treelets share has the same bits in all. Cells are in the order of a space-filling curve.
 * COUNTS: c, n, 0, 0. Of the header: tets: cells; vertices: nodes of the whole mesh, each once;
 * treelet_tets: cells in a treelet at most; flat: cells that are folded at step 0.
 */
#ifndef FORMATS_LEAF_MIXED_GEOMETRY_H
#define FORMATS_LEAF_MIXED_GEOMETRY_H

#include "formats/base/hexahedron.h"
#include "formats/leaf/leaf_cells.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_layout.h"

enum { MIXED_CELLS_MAX = 8192 }; /* of a treelet, so that 16 bits number its nodes */

/* Where the parts of a treelet's payloads begin, in bytes. */
typedef struct mixed_shape {
    uint32_t cells, nodes;
    uint32_t codes_at, corners_at; /* of a topology; places end at the latter */
    uint32_t place_bytes, topology_bytes, value_bytes;
} mixed_shape;

/* mixed_shape_of() - counts: an element of COUNTS, without a mixed_counts_fault().
 * mixed_counts_fault() - what a treelet of a file with this header cannot have; NULL: it is sound.
 */
mixed_shape mixed_shape_of(const uint32_t counts[4]);
const char *mixed_counts_fault(const uint32_t counts[4], uint32_t treelet_cells);

/* The parts. topology, places, values: a treelet's payloads. */
static inline const float *mixed_coordinates(const mixed_shape *s, const void *places, int axis) {
    return (const float *)places + (size_t)axis * s->nodes;
}
static inline hex_code mixed_code(const mixed_shape *s, const void *places, uint32_t cell) {
    const uint8_t *codes = (const uint8_t *)places + s->codes_at;
    return (hex_code)(codes[cell / 4] >> 2 * (cell % 4) & 3);
}
static inline const uint16_t (*mixed_corners(const mixed_shape *s,
                                             const void *topology))[HEX_CORNERS] {
    return (const uint16_t(*)[HEX_CORNERS])((const char *)topology + s->corners_at);
}

/* mixed_layout() - the layout of so many treelets, fields and steps, without allocating. False:
 * that makes 2^32 - 1 payloads or more. */
bool mixed_layout(leaf_layout *l, uint64_t treelets, uint32_t fields, uint32_t steps, bool moving);

/* mixed_directory_of() - what the directory has besides. */
static inline const leaf_cells_directory *mixed_directory_of(const leaf_file *f) {
    return f->besides;
}

extern const leaf_geometry mixed_geometry;

#endif
