/* mesh_batch_wide.h - batches through meshes as AVX-512 traces them, on any CPU. */
#ifndef TESTS_SUPPORT_MESH_BATCH_WIDE_H
#define TESTS_SUPPORT_MESH_BATCH_WIDE_H

#include "render/mesh/mesh_batch.h"

/* mesh_batch_wide() - as every batch_fn. */
void mesh_batch_wide(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters);

#endif
