/* mesh_packet.h - the primary rays of a tile through a mesh by packets of N x N, as W07 5.2 has
 * them: the yardstick of mesh_tile.h, with its counters.
 *
 * A packet walks the tree over the treelets, and the trees in them, near children first. Children
 * without active tets are passed over, and an only active child is entered without a look at its
 * box (I). Otherwise the first active ray is tested against the box, and if it meets it the packet
 * goes in (II); if not, interval arithmetic over all rays may tell that all pass it by (III); if
 * not, the rays behind the first are tested one after the other until one meets it, which is then
 * the first below (IV). A leaf is looked at by intervals alone, then each of its tets for its
 * isorange (V). An active tet's isopolygon is made once a packet; the packet's corner rays
 * may tell that all rays miss it, or that all hit it (W07 4.3); else the rays meet it one by one,
 * in vectors (tet_batch.h).
 *
 * Deviations: nodes have eight children, the isoranges of which are tested when the treelet's masks
 * are made (mesh_active.h), so that a test is a look at a bit; a packet of 2 x 2 rays is W07's
 * smallest, whose rays are tested together, by one vector: nothing is to be gained by (II) to (IV)
 * there. Boxes, orders and corner rays only leave out what is sure to be missed: the kernel
 * decides, and the picture is the same bits as that of single rays.
 */
#ifndef RENDER_MESH_PACKET_H
#define RENDER_MESH_PACKET_H

#include "render/tile.h"

/* mesh_packet_for() - packets of f->kernels->packet rays on a side (2, 4, 8 or 16), whose
 * isopolygons f->kernels->tets meets. NULL where there is none: every ray by itself. */
tile_fn mesh_packet_for(cpu_isa isa);

#endif
