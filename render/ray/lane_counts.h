/* lane_counts.h - how full the vectors of tiles' kernels are.
 *
 * Counted by the kernels of `leafcast bench lanes` alone, which are units of their own that define
 * LANE_COUNTS before they include the templates. Everywhere else LANE_COUNT() is nothing at all.
 */
#ifndef RENDER_RAY_LANE_COUNTS_H
#define RENDER_RAY_LANE_COUNTS_H

#include <stdbool.h>
#include <stdint.h>

/* Stages of a kernel, in the order in which rays come to them; how wide a vector is there: VF, VD:
 * so many floats or doubles of the ISA. */
#define GRID_LANES(X)                                                          \
    X(windows, VF)         /* rays that are open, of a window before a cell */ \
    X(visitors, VF)        /* ... that visit the cell */                       \
    X(survivors, VF)       /* ... that the filter lets through */              \
    X(groups, 8)           /* cells that a ray visits, of 2^3 */               \
    X(queue, VF)           /* ray-cells of such rays before the filter */      \
    X(queue_survivors, VF) /* ... that it lets through */                      \
    X(batches, 16)         /* ray-cells that go to the cell kernel together */ \
    X(roots, 16)           /* ... that have a hit */

#define MESH_LANES(X)                                                           \
    X(tets, VF)         /* active ones, gathered */                             \
    X(covers, VF)       /* ... whose isopolygon covers pixels */                \
    X(covering, VF)     /* ... or their centres, where it is small */           \
    X(looked_at, 1)     /* ... and are in sight */                              \
    X(polygons, VD)     /* isopolygons made of them together */                 \
    X(rays, VD)         /* that look at one together, or at one each */         \
    X(centres, VD)      /* ... and hit it; a quadrilateral's triangles apart */ \
    X(polygons_hit, VD) /* isopolygons that any ray hits, in sight or not */

typedef struct lane_stage {
    uint64_t vectors, lanes; /* that were not empty; that were filled */
} lane_stage;

typedef struct lane_counts {
#define STAGE(name, width) lane_stage name;
    GRID_LANES(STAGE)
    MESH_LANES(STAGE)
#undef STAGE
} lane_counts;

extern lane_counts lane_counts_now; /* of bench_lanes.c, which links it; one thread's */

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
