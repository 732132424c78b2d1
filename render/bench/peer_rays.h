/* peer_rays.h - sixteen rays handed to Embree: together, in halves or one by one; all surfaces on
 * them in one traversal. Empty without Embree's header. */
#ifndef RENDER_BENCH_PEER_RAYS_H
#define RENDER_BENCH_PEER_RAYS_H

#ifdef PEER_WITH_EMBREE

#include <embree3/rtcore.h>

#include "render/bench/peer_embree.h"

enum { PEER_LANES = 16 };

/* peer_rays_intersect() - find the nearest hit of each ray whose valid[] is set. behind: the rays
 * begin behind a surface, so Embree is told that they are incoherent if way->incoherent says so. */
void peer_rays_intersect(RTCScene scene, const peer_way *way, bool behind, const int *valid,
                         struct RTCRayHit16 *rays);

/* peer_rays_occluded() - tfar < 0 where something is hit. */
void peer_rays_occluded(RTCScene scene, const peer_way *way, const int *valid,
                        struct RTCRay16 *rays);

typedef struct peer_collected {
    float t, u, v, normal[3];
    unsigned triangle;
} peer_collected;

/* The nearest hits of each ray, in order. What a traversal hands to its filter: its context first.
 */
typedef struct peer_collection {
    struct RTCIntersectContext context;
    int wanted, count[PEER_LANES], taken[PEER_LANES];
    peer_collected hit[PEER_LANES][PEER_COLLECTED_MAX];
} peer_collection;

/* peer_rays_collect() - up to `wanted` hits of each ray in one traversal of a scene that was made
 * for it. peer_rays_take() - each ray's next of these behind its tnear, as peer_rays_intersect()
 * would leave it. */
void peer_rays_collect(RTCScene scene, int wanted, const int *valid, struct RTCRayHit16 *rays,
                       peer_collection *all);
void peer_rays_take(peer_collection *all, const int *valid, struct RTCRayHit16 *rays);

#endif

#endif
