/* tet_batch.h - tests many rays against one isopolygon.
 *
 * Each ray keeps its first hit behind a given one, in the order of flat_polygon_less(), so a
 * crossing seen from two tets counts once. The answer of a ray is, to the bit, that of
 * flat_polygon_hit(). It depends neither on the other rays nor on the order of polygons. Versions
 * for newer instructions come from one template (tet_batch_template.h); the scalar one is the
 * truth.
 */
#ifndef RENDER_MESH_TET_BATCH_H
#define RENDER_MESH_TET_BATCH_H

#include "formats/base/cpu.h"
#include "render/mesh/tet_kernel.h"

enum { TET_RAYS = 256 };

typedef struct tet_rays {
    _Alignas(64) double o[3][TET_RAYS];
    double d[3][TET_RAYS];
    double from[TET_RAYS]; /* hits lie in [from, to]: from is the larger of t0 and after.t, */
    double to[TET_RAYS];   /* to is the lesser of t1 and best.t */
    hit best[TET_RAYS];    /* hit_none() at first */
    hit after[TET_RAYS];
    bool one_origin; /* all o are equal: set by the caller, true for primary rays; false costs
                        time */
} tet_rays;

/* tet_rays_put() - sets ray number `lane`. after: hit_before_all(), or the ray's last hit. Only
 * hits behind it count; the same crossing seen from another tet does not. */
static inline void tet_rays_put(tet_rays *rays, int lane, const ray *r, const hit *after) {
    for (int a = 0; a < 3; a++) {
        rays->o[a][lane] = r->o[a];
        rays->d[a][lane] = r->d[a];
    }
    rays->from[lane] = after->t > r->t0 ? after->t : r->t0;
    rays->to[lane] = r->t1;
    rays->best[lane] = hit_none();
    rays->after[lane] = *after;
}

/* tet_rays_clear() - forgets what was found for this ray number, and finds no hit for it. For
 * numbers without a ray: a version may process rays up to the next multiple of 16. */
void tet_rays_clear(tet_rays *rays, int lane);

/* What the caller knows of all rays of a call: nothing, or that all hit the triangle of points 0 1
 * 2, or that all hit the triangle of points 0 2 3. It must know this for certain: from edge
 * functions whose signs rounding cannot change. */
typedef enum tet_known { TET_UNKNOWN, TET_FIRST_IS_HIT, TET_SECOND_IS_HIT } tet_known;

/* A tet_batch_fn tests the rays first <= i < end <= TET_RAYS against g. A hit that comes before
 * best[i] in the order of flat_polygon_less() replaces it, and its t becomes to[i]. g, cell and
 * iso_index are as for flat_polygon_hit(). `known` changes no result: it only saves time. */
typedef void (*tet_batch_fn)(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                             tet_rays *rays, int first, int end);

/* By ISA (cpu.h). */
extern const tet_batch_fn tet_batch_kernels[CPU_ISAS];

/* tet_batch_offer() - for the versions: offers a hit of this ray. Returns whether it is the ray's
 * first so far. */
static inline bool tet_batch_offer(tet_rays *rays, int lane, const hit *h) {
    const hit *after = &rays->after[lane];
    const hit behind = {after->t, UINT64_MAX, after->iso, after->entering};
    if (!flat_polygon_less(&behind, h) || !flat_polygon_less(h, &rays->best[lane]))
        return false;
    rays->best[lane] = *h;
    rays->to[lane] = h->t;
    return true;
}

/* tet_batch_one() - for the versions: tests one ray by the scalar truth. Returns whether its first
 * hit changed. */
bool tet_batch_one(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_rays *rays, int lane);

#endif
