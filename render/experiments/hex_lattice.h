/* hex_lattice.h - a curvilinear grid as M08 6.4 has it in memory: nodes in rows, and normals at
 * them; which cells are neighbours follows from their place.
 *
 * A grid is one zone or several, each a block of nodes of its own. Zones know nothing of each
 * other: a face that two of them share is a boundary of both. So are faces beside a cell that is
 * not there.
 */
#ifndef RENDER_EXPERIMENTS_HEX_LATTICE_H
#define RENDER_EXPERIMENTS_HEX_LATTICE_H

#include <stdint.h>

#include "formats/base/hexahedron.h"
#include "formats/base/mem.h"

typedef struct hex_zone {
    uint32_t nodes[3];   /* along i, j, k */
    uint32_t node, cell; /* numbers of its first ones */
    int sense;           /* 1: its cells are right-handed; -1. By their majority */
} hex_zone;

/* How normals come about. M08 eq. 6.10 adds the columns of the Jacobian, weighted by the slope in
 * computational space. That is the gradient's direction only where cells are cubes: a gradient goes
 * over by the inverse transpose. Both have the same Jacobian, of central differences (eq. 6.9). */
typedef enum hex_normals { HEX_NORMALS_COLUMNS, HEX_NORMALS_INVERSE } hex_normals;

typedef struct hex_lattice {
    mem *m;
    hex_zone *zone;
    uint32_t zones;
    uint32_t nodes, cells; /* of all zones */
    float (*node)[4];      /* place, value */
    float (*normal)[3];    /* unit, down the slope; 0 where there is none */
    uint8_t *there;        /* per cell, 0: there is none */
} hex_lattice;

/* hex_lattice_make() - nodes: of each zone along i, j, k. All nodes are 0, and no cell is there.
 * ST_UNSUPPORTED: 2^32 nodes or more. On failure, too, free it.
 * hex_lattice_finish() - when nodes and cells are there: find the senses of the zones. */
CHECKED status hex_lattice_make(hex_lattice *l, mem *m, const uint32_t (*nodes)[3], uint32_t zones);
void hex_lattice_finish(hex_lattice *l);
void hex_lattice_free(hex_lattice *l);

/* hex_lattice_normals() - make the normals of all nodes, from their neighbours in the zone that
 * have a value. */
void hex_lattice_normals(hex_lattice *l, hex_normals how);

/* hex_lattice_node(), hex_lattice_cell() - numbers, by the place in a zone. hex_lattice_strides() -
 * from a node to the next along i, j, k. */
static inline uint32_t hex_lattice_node(const hex_zone *z, const uint32_t at[3]) {
    return z->node + at[0] + z->nodes[0] * (at[1] + z->nodes[1] * at[2]);
}
static inline uint32_t hex_lattice_cell(const hex_zone *z, const uint32_t at[3]) {
    return z->cell + at[0] + (z->nodes[0] - 1) * (at[1] + (z->nodes[1] - 1) * at[2]);
}
static inline void hex_lattice_strides(const hex_zone *z, uint32_t stride[3]) {
    stride[0] = 1;
    stride[1] = z->nodes[0];
    stride[2] = z->nodes[0] * z->nodes[1];
}

/* hex_lattice_corner() - a cell's corner (hexahedron.h). first: number of its corner 0. */
static inline uint32_t hex_lattice_corner(const uint32_t stride[3], uint32_t first, int corner) {
    for (int a = 0; a < 3; a++)
        first += corner >> a & 1 ? stride[a] : 0;
    return first;
}

/* hex_lattice_beyond() - go over a face of the cell at at[]; returns whether there is a cell. */
static inline bool hex_lattice_beyond(const hex_lattice *l, const hex_zone *z, uint32_t at[3],
                                      int face) {
    const int axis = face / 2;
    at[axis] += face % 2 ? 1u : UINT32_MAX;
    return at[axis] < z->nodes[axis] - 1 && l->there[hex_lattice_cell(z, at)];
}

#endif
