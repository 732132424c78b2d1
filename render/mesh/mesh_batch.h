/* mesh_batch.h - rays of any origins and directions through a mesh together: what ray_batch.h is
 * about.
 *
 * Rays of one octant of directions go together, sorted so that neighbours are side by side. They
 * make MESH_BEAMS beams at a time: of as many rays in a row as stay narrow, of one where rays have
 * nothing in common. A beam is an interval of origins and one of directions an axis. The tree over
 * the treelets, and the trees in them, are walked once for all beams, near children first, with a
 * bit for each beam that may meet a node. At a vector of active tets the boxes around their
 * isopolygons come next, then edge functions of single precision; all of that errs on one side, and
 * by bounds that are written where they are used. What is left goes to tet_rays_template.h, so a
 * ray's answer is that of single rays to the bit.
 *
 * Of a ray that looks for any hit, any is taken: it may have one where a ray alone, which takes
 * treelets in order, would wait for one that is absent.
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

/* By ISA; scalar, NULL: every ray by itself. */
extern const batch_fn mesh_batch_kernels[CPU_ISAS];

#endif
