/* counters.h - what rays cost, counted by each thread for itself: one table, from which the struct,
 * its sum, the public statistics and their JSON are made.
 */
#ifndef RENDER_RAY_COUNTERS_H
#define RENDER_RAY_COUNTERS_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* Names are those of leafcast_stats. */
#define RAY_COUNTERS(X)                                                                    \
    X(primary_rays)       /* from the eye */                                               \
    X(shadow_rays)        /* towards lights */                                             \
    X(nodes)              /* traversal steps, of the directory and in treelets */          \
    X(cells)              /* handed to the intersector */                                  \
    X(roots)              /* hits that it found */                                         \
    X(covered_pixels)     /* that show a surface */                                        \
    X(provisional_pixels) /* that show something coarser than asked for, or not yet all */ \
    X(ill_conditioned)    /* shadow rays whose start is known no better than to a cell */  \
    X(uncertified_pixels) /* of media: whose error may be more than was asked for */       \
    X(passed_tets)        /* from neighbour to neighbour; of these */                      \
    X(edge_tests)         /* on which side of an edge a ray passes (M08 6.2.1) */          \
    X(passes)             /* 1, and 1 more whenever all rays waited for treelets to give way */

/* What packets through a mesh do (W07 table 4). */
#define PACKET_COUNTERS(X)                                                 \
    X(box_tests)      /* rays individually tested against a box */         \
    X(interval_tests) /* packets against a box, by intervals */            \
    X(isorange_tests) /* packets: of treelets, nodes, tets */              \
    X(polygon_tests)  /* rays individually tested against an isopolygon */ \
    X(isopolygons)    /* made, or looked at once they are made */

typedef struct ray_counters {
#define COUNTER(name) uint64_t name;
    RAY_COUNTERS(COUNTER)
    PACKET_COUNTERS(COUNTER)
#undef COUNTER
    /* Errors of provisional pixels of media: in all, in steps of 2^-32, and the greatest one. */
    uint64_t doubt;
    double most_doubt;
} ray_counters;

static inline void ray_counters_doubt(ray_counters *c, double error) {
    c->doubt += (uint64_t)(fmin(error, 0x1p20) * 0x1p32);
    c->most_doubt = fmax(c->most_doubt, error);
}

static inline void ray_counters_add(ray_counters *total, const ray_counters *c) {
#define COUNTER(name) total->name += c->name;
    RAY_COUNTERS(COUNTER)
    PACKET_COUNTERS(COUNTER)
#undef COUNTER
    total->doubt += c->doubt;
    total->most_doubt = fmax(total->most_doubt, c->most_doubt);
}

#endif
