/* mesh_packet.h - the primary rays of a tile through a mesh by packets of N x N, as W07 5.2 has
 * them: the yardstick of mesh_tile.h, with its counters.
 *
 * A packet walks the tree over the treelets, and the trees in them, near children first. Children
 * without active tets are passed over, and an only active child is entered without a look at its
 * box (I). Otherwise the first active ray is tested against the box, and if it meets it the packet
 * goes in (II). If not, interval arithmetic may tell that all rays pass the box by, or have found
 * something nearer (III). If not, the rays behind the first are tested one after the other until
 * one meets it, which is then the first below (IV). A leaf is looked at by intervals alone, then
 * each of its tets for its isorange (V). An active tet's isopolygon is made once a packet; the
 * packet's corner rays may tell that all rays miss it, or that all hit it (W07 4.3); else the rays
 * meet it one by one, in vectors (tet_batch.h). A packet of 2 x 2 is W07's yardstick, the smallest:
 * all its rays are tested together against every box and polygon.
 *
 * Deviations: nodes have eight children, whose isoranges are tested when the treelet's masks are
 * made (mesh_active.h): here a test is a look at a bit. Intervals are of directions and of pixels:
 * (IV) tests only rays of the pixels that the box can cover, and which still look that far. Boxes
 * and corner rays only leave out what is surely missed: the kernel decides, and the picture is the
 * same bits as that of single rays.
 */
#ifndef RENDER_MESH_MESH_PACKET_H
#define RENDER_MESH_MESH_PACKET_H

#include "render/frame/tile.h"

/* By ISA; scalar, NULL: every ray by itself. Of mesh_rays.packet rays on a side: 2, 4, 8 or 16. */
extern const tile_fn mesh_packet_kernels[CPU_ISAS];

#endif
