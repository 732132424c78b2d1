/* mesh_batch.h - traces rays of any origins and directions through a mesh together; see
 * ray_batch.h.
 *
 * Rays of one octant of directions go together, sorted so that neighbours are side by side. They
 * form MESH_BEAMS beams at a time. A beam is an interval of origins and an interval of directions
 * per axis. It has as many consecutive rays as keep it narrow, or a single ray if rays have nothing
 * in common. The tree over the treelets, and the trees in them, are walked once for all beams, near
 * children first. Each node has a bit for each beam that may meet it. Active tets are taken a
 * vector at a time. Beams are tested against the boxes around their isopolygons, then rays against
 * the edge functions, in single precision. All these tests are conservative; the bounds are stated
 * where they are used. The remaining rays go to tet_rays_template.h. So a ray's answer equals the
 * answer of single rays, to the bit.
 *
 * A ray that looks for any hit takes any. So it may find one where a single ray, which takes
 * treelets in order, would wait for an absent treelet.
 *
 * Deviation from W07 5: the packets there have one eye, and are not split. Here no ray visits a box
 * that only other rays meet. Rays without coherence share nodes, boxes and isopolygons once these
 * are fetched or made.
 */
#ifndef RENDER_MESH_MESH_BATCH_H
#define RENDER_MESH_MESH_BATCH_H

#include "formats/base/cpu.h"
#include "render/ray/ray_batch.h"

enum { MESH_BEAMS = 32, MESH_BATCH_SCRATCH = 128 << 10 };

/* By ISA. Scalar: NULL, so each ray is traced by itself. */
extern const batch_fn mesh_batch_kernels[CPU_ISAS];

#endif
