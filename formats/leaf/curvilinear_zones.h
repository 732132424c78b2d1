/* curvilinear_zones.h - how a curvilinear grid is divided: zones, each a block of nodes of its own,
 * into treelets of up to 32^3 cells.
 *
 * Only the zones' numbers of nodes are stored. Treelets come zone after zone; within a zone in
 * Morton order of their places (bit 0 i, bit 1 j, bit 2 k), as far as they exist. So eight in a row
 * are neighbours (stream/treelet_tree.h). Cells count treelet after treelet, i fastest.
 */
#ifndef FORMATS_LEAF_CURVILINEAR_ZONES_H
#define FORMATS_LEAF_CURVILINEAR_ZONES_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/hexahedron.h"

enum {
    CURVILINEAR_LOG2 = 5,
    CURVILINEAR_SIDE = 1 << CURVILINEAR_LOG2, /* at most so many cells of a treelet along an axis */
    CURVILINEAR_NODES_MAX = 1 << 27           /* of a zone along an axis; at least 2 */
};

/* curvilinear_zones_treelets() - the treelets of a zone of nodes[0] x nodes[1] x nodes[2] nodes, 2
 * to CURVILINEAR_NODES_MAX each; at most `most` + 1. */
uint64_t curvilinear_zones_treelets(const uint32_t nodes[3], uint64_t most);

/* curvilinear_zones_walk() - call each() for all treelets of a zone, in order. first: its first
 * cell in the zone. cells: its cells along each axis. */
typedef void curvilinear_each(void *ctx, const uint32_t first[3], const uint32_t cells[3]);
void curvilinear_zones_walk(const uint32_t nodes[3], curvilinear_each *each, void *ctx);

#endif
