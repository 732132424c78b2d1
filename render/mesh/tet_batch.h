/* tet_batch.h - tests many rays (flat_rays.h) against one isopolygon. Versions for newer
 * instructions come from one template (tet_batch_template.h); the scalar one is the truth. */
#ifndef RENDER_MESH_TET_BATCH_H
#define RENDER_MESH_TET_BATCH_H

#include "formats/base/cpu.h"
#include "render/flat/flat_rays.h"
#include "render/mesh/tet_kernel.h"

/* What the caller knows of all rays of a call: nothing, or that all hit the triangle of points 0 1
 * 2, or that all hit the triangle of points 0 2 3. It must know this for certain: from edge
 * functions whose signs rounding cannot change. */
typedef enum tet_known { TET_UNKNOWN, TET_FIRST_IS_HIT, TET_SECOND_IS_HIT } tet_known;

/* A tet_batch_fn tests the rays first <= i < end <= FLAT_RAYS against g. A hit that comes before
 * best[i] in the order of flat_polygon_less() replaces it, and its t becomes to[i]. g, cell and
 * iso_index are as for flat_polygon_hit(). `known` changes no result: it only saves time. */
typedef void (*tet_batch_fn)(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                             flat_rays *rays, int first, int end);

/* By ISA (cpu.h). */
extern const tet_batch_fn tet_batch_kernels[CPU_ISAS];

#endif
