/* mesh_batch.h - traces rays of any origins and directions through a mesh together; see
 * ray_batch.h.
 *
 * Rays of one octant of directions go together, sorted so that neighbours are side by side. They
 * make MESH_BEAMS beams at a time. A beam has as many consecutive rays as stay narrow, or one ray
 * if rays have nothing in common. It is an interval of origins and one of directions per axis. The
 * tree over the treelets, and the trees in them, are walked once for all beams, near children
 * first, with a bit for each beam that may meet a node. For each vector of active tets, beams are
 * tested first against the boxes around their isopolygons, then against edge functions in single
 * precision. All these tests are conservative, with bounds that are stated where they are used.
 * Rays that are left go to tet_rays_template.h, so a ray's answer is that of single rays to the
 * bit.
 *
 * A ray that looks for any hit takes any. So it may find one where a ray alone, which takes
 * treelets in order, would wait for an absent one.
 *
 * Deviation from W07 5: packets there are of one eye, and are split no further. Here no ray waits
 * for a box that only other rays meet, and rays without coherence share what is fetched and made
 * for them: nodes, boxes, isopolygons.
 */
#ifndef RENDER_MESH_MESH_BATCH_H
#define RENDER_MESH_MESH_BATCH_H

#include "formats/base/cpu.h"
#include "render/ray/ray_batch.h"

enum { MESH_BEAMS = 32, MESH_BATCH_SCRATCH = 128 << 10 };

/* By ISA. Scalar: NULL, so each ray is traced by itself. */
extern const batch_fn mesh_batch_kernels[CPU_ISAS];

#endif
