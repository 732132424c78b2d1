/* mesh_batch.h - traces rays of any origins and directions through a mesh together; see
 * ray_batch.h, and flat_batch_template.h for the way.
 */
#ifndef RENDER_MESH_MESH_BATCH_H
#define RENDER_MESH_MESH_BATCH_H

#include "formats/base/cpu.h"
#include "render/ray/ray_batch.h"

enum { MESH_BATCH_SCRATCH = 128 << 10 };

/* By ISA. Scalar: NULL, so each ray is traced by itself. */
extern const batch_fn mesh_batch_kernels[CPU_ISAS];

#endif
