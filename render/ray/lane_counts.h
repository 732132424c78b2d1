/* lane_counts.h - how full the vectors of tiles' kernels are.
 *
 * Counted by the kernels of `leafcast bench lanes` alone, which are units of their own that define
 * LANE_COUNTS before they include the templates. Everywhere else LANE_COUNT() is nothing at all.
 */
#ifndef RENDER_RAY_LANE_COUNTS_H
#define RENDER_RAY_LANE_COUNTS_H

#include <stdbool.h>
#include <stdint.h>

/* Stages of a kernel, in the order in which rays reach them. The second entry is the width of the
 * stage's vectors: VF floats or VD doubles of the ISA, or a number. */
#define GRID_LANES(X)                                                   \
    X(windows, VF)         /* open rays of a window before a cell */    \
    X(visitors, VF)        /* ... those that visit the cell */          \
    X(survivors, VF)       /* ... those that the filter passes */       \
    X(groups, 8)           /* visited cells among 2^3, of one ray */    \
    X(queue, VF)           /* ray-cells of these before the filter */   \
    X(queue_survivors, VF) /* ... those that the filter passes */       \
    X(batches, 16)         /* ray-cells in a call of the cell kernel */ \
    X(roots, 16)           /* ... those with a hit */

#define MESH_LANES(X)                                                                \
    X(tets, VF)         /* active tets, gathered */                                  \
    X(covers, VF)       /* ... those whose isopolygon covers pixels */               \
    X(covering, VF)     /* ... or pixel centres, where it is small */                \
    X(looked_at, 1)     /* ... and that are not hidden */                            \
    X(polygons, VD)     /* isopolygons made together */                              \
    X(rays, VD)         /* rays tested together, on one or on one each */            \
    X(centres, VD)      /* ... those that hit; triangles of a quadrilateral apart */ \
    X(polygons_hit, VD) /* isopolygons hit by any ray, hidden or not */

typedef struct lane_stage {
    uint64_t vectors, lanes; /* vectors with a filled lane; filled lanes */
} lane_stage;

typedef struct lane_counts {
#define STAGE(name, width) lane_stage name;
    GRID_LANES(STAGE)
    MESH_LANES(STAGE)
#undef STAGE
} lane_counts;

extern lane_counts lane_counts_now; /* defined in bench_lanes.c; one thread's */

#ifdef LANE_COUNTS

static inline void lane_count(lane_stage *s, uint64_t bits) {
    s->vectors += bits != 0;
    s->lanes += (uint64_t)__builtin_popcountll(bits);
}

#define LANE_COUNT(stage, bits) lane_count(&lane_counts_now.stage, (bits))

#else

#define LANE_COUNT(stage, bits) ((void)(bits))

#endif

#endif
