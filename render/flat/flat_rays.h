/* flat_rays.h - rays of any origins, each with its first hit so far on flat polygons.
 *
 * A ray keeps its first hit behind a given one, in the order of the kind, so a crossing seen from
 * two cells counts once. Its answer is, to the bit, that of flat_polygon_hit(). It depends neither
 * on the other rays nor on the order of polygons.
 */
#ifndef RENDER_FLAT_FLAT_RAYS_H
#define RENDER_FLAT_FLAT_RAYS_H

#include "render/flat/flat_polygon.h"

enum { FLAT_RAYS = 256 };

typedef struct flat_rays {
    _Alignas(64) double o[3][FLAT_RAYS];
    double d[3][FLAT_RAYS];
    double from[FLAT_RAYS]; /* hits lie in [from, to]: from is the larger of t0 and after.t, */
    double to[FLAT_RAYS];   /* to is the lesser of t1 and best.t */
    hit best[FLAT_RAYS];    /* hit_none() at first */
    hit after[FLAT_RAYS];
    /* Set by the caller: */
    bool front_first; /* of two crossings at one t the one from the front comes first, as
                         triangles have it; else the one from behind: flat_polygon_less() */
    bool one_origin;  /* all o are equal, as those of primary rays; false costs time */
} flat_rays;

/* flat_rays_put() - sets ray number `lane`. after: hit_before_all(), or the ray's last hit. Only
 * hits behind it count; the same crossing seen from another polygon does not. */
static inline void flat_rays_put(flat_rays *rays, int lane, const ray *r, const hit *after) {
    for (int a = 0; a < 3; a++) {
        rays->o[a][lane] = r->o[a];
        rays->d[a][lane] = r->d[a];
    }
    rays->from[lane] = after->t > r->t0 ? after->t : r->t0;
    rays->to[lane] = r->t1;
    rays->best[lane] = hit_none();
    rays->after[lane] = *after;
}

/* flat_rays_clear() - forgets what was found for this ray number, and finds no hit for it. For
 * numbers without a ray: kernels may process rays up to the next multiple of 16. */
void flat_rays_clear(flat_rays *rays, int lane);

/* flat_rays_less() - the order of a ray's hits, in which doubles lie side by side. */
static inline bool flat_rays_less(const flat_rays *rays, const hit *a, const hit *b) {
    if (a->t == b->t && a->iso == b->iso && a->entering != b->entering)
        return a->entering == rays->front_first;
    return flat_polygon_less(a, b);
}

/* flat_rays_offer() - for kernels: offers a hit of this ray. Returns whether it is the ray's
 * first so far. */
static inline bool flat_rays_offer(flat_rays *rays, int lane, const hit *h) {
    const hit *after = &rays->after[lane];
    const hit behind = {after->t, UINT64_MAX, after->iso, after->entering};
    if (!flat_rays_less(rays, &behind, h) || !flat_rays_less(rays, h, &rays->best[lane]))
        return false;
    rays->best[lane] = *h;
    rays->to[lane] = h->t;
    return true;
}

/* flat_rays_one() - for kernels: tests one ray by the scalar truth. Returns whether its first
 * hit changed. */
bool flat_rays_one(const flat_polygon *g, uint64_t cell, int32_t iso_index, flat_rays *rays,
                   int lane);

#endif
