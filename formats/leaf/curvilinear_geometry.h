/* curvilinear_geometry.h - the table of functions for curvilinear grids in a treelet file.
 *
 * A treelet has a payload of places at each step where the nodes move, else one, and a payload of
 * values for each set. Blocks of payloads are those of a mesh that has no gradients (leaf.h), with
 * the places of step 0 in place of topologies. In a treelet of n nodes and c cells:
 *
 *   places   float x[n], y[n], z[n]; then the cells' hex_code, four a byte, the first one
 *            lowest; zeros up to a multiple of LEAF_ALIGN, and at least CURVILINEAR_TAIL bytes
 *            behind the nodes
 *   values   float[n]; zeros up to a multiple of LEAF_ALIGN
 *
 * Nodes and cells: i fastest. A node on a face of treelets is in all of them, with the same bits.
 */
#ifndef FORMATS_LEAF_CURVILINEAR_GEOMETRY_H
#define FORMATS_LEAF_CURVILINEAR_GEOMETRY_H

#include "formats/leaf/curvilinear_zones.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_layout.h"

enum { CURVILINEAR_TAIL = 32 }; /* so that vectors may read beyond a row */

/* Where a treelet's cells are in the grid. */
typedef struct curvilinear_where {
    uint32_t zone, first[3]; /* its first cell in the zone */
} curvilinear_where;

/* What the directory has besides: leaf_file.besides. */
typedef struct curvilinear_directory {
    float (*bounds)[6];
    uint32_t (*zones)[4]; /* section ZONES */
    /* Which follow from the zones, per treelet: */
    uint32_t (*counts)[4]; /* cells along i, j, k; 0 */
    curvilinear_where *where;
    uint64_t *first; /* treelets + 1: number of a treelet's first cell in the whole file */
} curvilinear_directory;

static inline const curvilinear_directory *curvilinear_directory_of(const leaf_file *f) {
    return f->besides;
}

/* curvilinear_nodes() - the nodes of a treelet of so many cells. curvilinear_cells() - its cells.
 * curvilinear_place_bytes(), curvilinear_value_bytes() - the bytes of its payloads. */
static inline uint32_t curvilinear_nodes(const uint32_t cells[3]) {
    return (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
}
static inline uint32_t curvilinear_cells(const uint32_t cells[3]) {
    return cells[0] * cells[1] * cells[2];
}
uint32_t curvilinear_place_bytes(const uint32_t cells[3]);
uint32_t curvilinear_value_bytes(const uint32_t cells[3]);

/* curvilinear_layout() - the layout of so many treelets, fields and steps, without allocating.
 * False: that makes 2^32 - 1 payloads or more. Its counts (leaf_layout_set_counts()): cells along
 * i, j, k, and 0. */
bool curvilinear_layout(leaf_layout *l, uint64_t treelets, uint32_t fields, uint32_t steps,
                        bool moving);

extern const leaf_geometry curvilinear_geometry;

#endif
