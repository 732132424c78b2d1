/* counters.h - what rays cost, counted by each thread for itself. One table makes the struct, its
 * sum, the public statistics and their JSON.
 */
#ifndef RENDER_RAY_COUNTERS_H
#define RENDER_RAY_COUNTERS_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* Names are those of leafcast_stats. */
#define RAY_COUNTERS(X)                                                            \
    X(primary_rays)       /* from the eye */                                       \
    X(shadow_rays)        /* towards lights */                                     \
    X(occlusion_rays)     /* towards what hides ambient light */                   \
    X(mirrored_rays)      /* from surfaces that reflect */                         \
    X(refracted_rays)     /* through surfaces that bend them */                    \
    X(nodes)              /* traversal steps, of the directory and in treelets */  \
    X(cells)              /* cells given to the intersector */                     \
    X(roots)              /* hits that it found */                                 \
    X(covered_pixels)     /* pixels that show a surface */                         \
    X(provisional_pixels) /* coarser than asked for, or not complete yet */        \
    X(ill_conditioned)    /* shadow rays whose start may be off by a cell */       \
    X(uncertified_pixels) /* of media: the error may exceed the limit */           \
    X(passed_tets)        /* entered from a neighbouring tet */                    \
    X(edge_tests)         /* side of a tet's edge that a ray passes (M08 6.2.1) */ \
    X(objects)            /* questions of rays to an object of the scene */        \
    X(passes)             /* rounds: 1 more whenever all rays wait for room */

/* Work of packets through a mesh (W07 table 4). */
#define PACKET_COUNTERS(X)                                                    \
    X(box_tests)      /* rays individually tested against a box */            \
    X(interval_tests) /* packets tested against a box, by intervals */        \
    X(isorange_tests) /* packets' tests of ranges of treelets, nodes, tets */ \
    X(polygon_tests)  /* rays individually tested against an isopolygon */    \
    X(isopolygons)    /* made, or looked up when made before */

typedef struct ray_counters {
#define COUNTER(name) uint64_t name;
    RAY_COUNTERS(COUNTER)
    PACKET_COUNTERS(COUNTER)
#undef COUNTER
    /* Errors of provisional pixels of media: their sum in steps of 2^-32, and the greatest one. */
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
