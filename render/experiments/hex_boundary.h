/* hex_boundary.h - where a ray enters a grid in memory: a kd-tree over its boundary faces, each cut
 * into two triangles (M08 6.3.1, 6.4.1).
 *
 * The tree is made by the surface area heuristic, from planes at equal distances. The product's own
 * way to a first cell is a tree of boxes over all cells; it has no step of its own there that could
 * be timed beside this one.
 */
#ifndef RENDER_EXPERIMENTS_HEX_BOUNDARY_H
#define RENDER_EXPERIMENTS_HEX_BOUNDARY_H

#include "formats/curved/sheared_ray.h"
#include "render/experiments/hex_exit.h"
#include "render/experiments/hex_lattice.h"

typedef struct hex_boundary_face {
    uint32_t zone, at[3], node[4];
    int face;
} hex_boundary_face;

typedef struct hex_boundary {
    mem *m;
    const hex_lattice *lattice;
    hex_boundary_face *face; /* triangles 2 i and 2 i + 1 are of face i */
    size_t faces, faces_room;
    struct hex_boundary_node *node;
    size_t nodes, nodes_room;
    uint32_t *triangle; /* of the leaves */
    size_t triangles, triangles_room;
    double box[2][3];
} hex_boundary;

/* hex_boundary_make() - of a finished lattice, which is kept by reference. On failure, too, free
 * it. */
CHECKED status hex_boundary_make(hex_boundary *b, mem *m, const hex_lattice *l);
void hex_boundary_free(hex_boundary *b);

typedef struct hex_entry {
    const hex_boundary_face *face;
    hex_point point; /* by the triangle */
} hex_entry;

/* hex_boundary_next() - the first boundary face that the ray enters by behind t. r: the space of
 * the ray o + t d. False: none. */
bool hex_boundary_next(const hex_boundary *b, const sheared_ray *r, const double o[3],
                       const double d[3], double t, hex_entry *out);

#endif
