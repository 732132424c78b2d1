/* mesh_packet.h - traces the primary rays of a tile through a mesh in packets of N x N, as in W07
 * 5.2: the yardstick for mesh_tile.h, with its counters.
 *
 * A packet walks the tree over the treelets, and the trees in them, near children first. Children
 * without active tets are skipped; an only active child is entered without a test of its box (I).
 * Otherwise the first active ray is tested against the box; if it hits, the packet goes in (II). If
 * not, interval arithmetic may prove that all rays miss the box, or have found something nearer
 * (III). If not, the rays behind the first are tested one by one until one hits; it is then the
 * first below (IV). A leaf is tested by intervals alone, then each of its tets by its isorange (V).
 * An active tet's isopolygon is made once a packet. The packet's corner rays may prove that all
 * rays miss it, or that all hit it (W07 4.3); else the rays are tested one by one, in vectors
 * (tet_batch.h). A packet of 2 x 2 is the smallest, and W07's yardstick: all its rays are tested
 * together against every box and polygon.
 *
 * Deviations. Nodes have eight children, whose isoranges are tested when the treelet's masks are
 * made (mesh_active.h): here that test only reads a bit. There are intervals of directions and of
 * pixels: (IV) tests only rays of pixels that the box can cover, and that still look so far. Boxes
 * and corner rays reject only sure misses; the kernel decides the rest. So the picture has the same
 * bits as with single rays.
 */
#ifndef RENDER_MESH_MESH_PACKET_H
#define RENDER_MESH_MESH_PACKET_H

#include "render/frame/tile.h"

/* By ISA. Scalar: NULL, so each ray is traced by itself. mesh_rays.packet rays on a side: 2, 4, 8
 * or 16. */
extern const tile_fn mesh_packet_kernels[CPU_ISAS];

#endif
