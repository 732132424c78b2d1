#include "render/bench/peer_rays.h"

#ifdef PEER_WITH_EMBREE

#include <math.h>
#include <string.h>

enum { LANES = PEER_LANES };

/* Half a packet there and back, for rtcIntersect8. */
#define HALF(to, to_at, from, from_at, part) \
    memcpy((to)->part + (to_at), (from)->part + (from_at), 8 * sizeof *(to)->part)

static void intersect_8(RTCScene scene, struct RTCIntersectContext *context, const int *valid,
                        struct RTCRayHit16 *rays) {
    for (int half = 0; half < LANES; half += 8) {
        struct RTCRayHit8 r;
        HALF(&r, 0, rays, half, ray.org_x);
        HALF(&r, 0, rays, half, ray.org_y);
        HALF(&r, 0, rays, half, ray.org_z);
        HALF(&r, 0, rays, half, ray.dir_x);
        HALF(&r, 0, rays, half, ray.dir_y);
        HALF(&r, 0, rays, half, ray.dir_z);
        HALF(&r, 0, rays, half, ray.tnear);
        HALF(&r, 0, rays, half, ray.tfar);
        HALF(&r, 0, rays, half, ray.time);
        HALF(&r, 0, rays, half, ray.mask);
        HALF(&r, 0, rays, half, ray.id);
        HALF(&r, 0, rays, half, ray.flags);
        HALF(&r, 0, rays, half, hit.geomID);
        HALF(&r, 0, rays, half, hit.instID[0]);
        rtcIntersect8(valid + half, scene, context, &r);
        HALF(rays, half, &r, 0, ray.tfar);
        HALF(rays, half, &r, 0, hit.u);
        HALF(rays, half, &r, 0, hit.v);
        HALF(rays, half, &r, 0, hit.primID);
        HALF(rays, half, &r, 0, hit.geomID);
        HALF(rays, half, &r, 0, hit.Ng_x);
        HALF(rays, half, &r, 0, hit.Ng_y);
        HALF(rays, half, &r, 0, hit.Ng_z);
    }
}

static void intersect_1(RTCScene scene, struct RTCIntersectContext *context, const int *valid,
                        struct RTCRayHit16 *rays) {
    for (int i = 0; i < LANES; i++) {
        if (!valid[i])
            continue;
        struct RTCRayHit r = {
            .ray = {.org_x = rays->ray.org_x[i],
                    .org_y = rays->ray.org_y[i],
                    .org_z = rays->ray.org_z[i],
                    .dir_x = rays->ray.dir_x[i],
                    .dir_y = rays->ray.dir_y[i],
                    .dir_z = rays->ray.dir_z[i],
                    .tnear = rays->ray.tnear[i],
                    .tfar = INFINITY,
                    .mask = ~0u},
            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}}};
        rtcIntersect1(scene, context, &r);
        rays->ray.tfar[i] = r.ray.tfar;
        rays->hit.u[i] = r.hit.u;
        rays->hit.v[i] = r.hit.v;
        rays->hit.primID[i] = r.hit.primID;
        rays->hit.geomID[i] = r.hit.geomID;
        rays->hit.Ng_x[i] = r.hit.Ng_x;
        rays->hit.Ng_y[i] = r.hit.Ng_y;
        rays->hit.Ng_z[i] = r.hit.Ng_z;
    }
}

/* As intersect_8() and intersect_1(): what is hidden has tfar < 0. */
static void occluded_8(RTCScene scene, struct RTCIntersectContext *context, const int *valid,
                       struct RTCRay16 *rays) {
    for (int half = 0; half < LANES; half += 8) {
        struct RTCRay8 r;
        HALF(&r, 0, rays, half, org_x);
        HALF(&r, 0, rays, half, org_y);
        HALF(&r, 0, rays, half, org_z);
        HALF(&r, 0, rays, half, dir_x);
        HALF(&r, 0, rays, half, dir_y);
        HALF(&r, 0, rays, half, dir_z);
        HALF(&r, 0, rays, half, tnear);
        HALF(&r, 0, rays, half, tfar);
        HALF(&r, 0, rays, half, time);
        HALF(&r, 0, rays, half, mask);
        HALF(&r, 0, rays, half, id);
        HALF(&r, 0, rays, half, flags);
        rtcOccluded8(valid + half, scene, context, &r);
        HALF(rays, half, &r, 0, tfar);
    }
}

static void occluded_1(RTCScene scene, struct RTCIntersectContext *context, const int *valid,
                       struct RTCRay16 *rays) {
    for (int i = 0; i < LANES; i++) {
        if (!valid[i])
            continue;
        struct RTCRay r = {.org_x = rays->org_x[i],
                           .org_y = rays->org_y[i],
                           .org_z = rays->org_z[i],
                           .dir_x = rays->dir_x[i],
                           .dir_y = rays->dir_y[i],
                           .dir_z = rays->dir_z[i],
                           .tnear = rays->tnear[i],
                           .tfar = rays->tfar[i],
                           .mask = ~0u};
        rtcOccluded1(scene, context, &r);
        rays->tfar[i] = r.tfar;
    }
}

static struct RTCIntersectContext context_of(bool coherent) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

void peer_rays_intersect(RTCScene scene, const peer_way *way, bool behind, const int *valid,
                         struct RTCRayHit16 *rays) {
    struct RTCIntersectContext context = context_of(!(behind && way->incoherent));
    if (way->packet == PEER_PACKET_16)
        rtcIntersect16(valid, scene, &context, rays);
    else if (way->packet == PEER_PACKET_8)
        intersect_8(scene, &context, valid, rays);
    else
        intersect_1(scene, &context, valid, rays);
}

void peer_rays_occluded(RTCScene scene, const peer_way *way, const int *valid,
                        struct RTCRay16 *rays) {
    struct RTCIntersectContext context = context_of(!way->incoherent);
    if (way->packet == PEER_PACKET_16)
        rtcOccluded16(valid, scene, &context, rays);
    else if (way->packet == PEER_PACKET_8)
        occluded_8(scene, &context, valid, rays);
    else
        occluded_1(scene, &context, valid, rays);
}

/* ---- all surfaces on a ray in one traversal ---- */

/* Into a lane's list, in order. A full list loses its last. */
static void collect(peer_collection *c, unsigned lane, const peer_collected *h) {
    peer_collected *list = c->hit[lane];
    int at = c->count[lane];
    if (at == c->wanted && !(h->t < list[--at].t))
        return;
    c->count[lane] = at + 1;
    for (; at > 0 && h->t < list[at - 1].t; at--)
        list[at] = list[at - 1];
    list[at] = *h;
}

/* Embree's filter, of 1 to 16 rays as it likes. Nothing is a hit, so that it goes on; but when a
 * list is full, what is behind it need not be looked at. */
static void collect_lanes(const struct RTCFilterFunctionNArguments *a) {
    enum { TFAR = 8, ID = 10, NX = 0, NY, NZ, U, V, TRIANGLE }; /* rows of RTCRayN and RTCHitN */
    peer_collection *c = (peer_collection *)a->context;
    float *ray = (float *)a->ray;
    const float *hit = (const float *)a->hit;
    const unsigned n = a->N;
    for (unsigned i = 0; i < n; i++) {
        if (!a->valid[i])
            continue;
        unsigned lane = 0;
        peer_collected h = {.t = ray[TFAR * n + i],
                            .u = hit[U * n + i],
                            .v = hit[V * n + i],
                            .normal = {hit[NX * n + i], hit[NY * n + i], hit[NZ * n + i]}};
        memcpy(&lane, &ray[ID * n + i], sizeof lane);
        memcpy(&h.triangle, &hit[TRIANGLE * n + i], sizeof h.triangle);
        collect(c, lane, &h);
        if (c->count[lane] == c->wanted)
            ray[TFAR * n + i] = c->hit[lane][c->wanted - 1].t;
        else
            a->valid[i] = 0;
    }
}

void peer_rays_collect(RTCScene scene, int wanted, const int *valid, struct RTCRayHit16 *rays,
                       peer_collection *all) {
    all->context = context_of(true);
    all->context.filter = collect_lanes;
    all->wanted = wanted;
    memset(all->count, 0, sizeof all->count);
    memset(all->taken, 0, sizeof all->taken);
    rtcIntersect16(valid, scene, &all->context, rays);
}

static void take(peer_collection *all, int i, struct RTCRayHit16 *rays) {
    struct RTCHit16 *hit = &rays->hit;
    while (all->taken[i] < all->count[i] && all->hit[i][all->taken[i]].t < rays->ray.tnear[i])
        all->taken[i]++;
    hit->geomID[i] = RTC_INVALID_GEOMETRY_ID;
    if (all->taken[i] == all->count[i])
        return;
    const peer_collected *h = &all->hit[i][all->taken[i]++];
    rays->ray.tfar[i] = h->t;
    hit->u[i] = h->u;
    hit->v[i] = h->v;
    hit->Ng_x[i] = h->normal[0];
    hit->Ng_y[i] = h->normal[1];
    hit->Ng_z[i] = h->normal[2];
    hit->primID[i] = h->triangle;
    hit->geomID[i] = 0;
}

void peer_rays_take(peer_collection *all, const int *valid, struct RTCRayHit16 *rays) {
    for (int i = 0; i < LANES; i++)
        if (valid[i])
            take(all, i, rays);
}

#else

typedef int peer_rays_are_not_here; /* a file may not be empty */

#endif
