/* mesh_tile_polygons_template.h - tests tets that a tile's rays may hit, in doubles; included by
 * the units of an ISA (see formats/base/simd.h).
 *
 * Isopolygons are made a vector of tets at a time. Small ones then meet their rays together, with a
 * polygon and one of its rays per lane. Large ones meet theirs alone, a ray per lane.
 */
#ifndef RENDER_MESH_MESH_TILE_POLYGONS_TEMPLATE_H
#define RENDER_MESH_MESH_TILE_POLYGONS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/kept_polygons.h"
#include "render/mesh/mesh_tile_state_template.h"

/* ---- Tets ---- */

/* Fill a lane by itself: its polygon is kept with the treelet, or isopolygons_near() was not sure
 * of it. */
static void polygon_alone(mesh_tile *w, unsigned lane) {
    flat_queue *q = &w->queue;
    const resident_mesh *at = resident_mesh_of(q->at[lane]);
    isopolygon made;
    const isopolygon *g = NULL;
    if (at->polygons) {
        g = at->polygons->find(at, q->local[lane], q->isovalue[lane], &made);
    } else {
        const tet exact = mesh_walk_tet(at, q->local[lane]);
        g = isopolygon_of(&exact, q->isovalue[lane], &made) ? &made : NULL;
    }
    q->polygons.count[lane] = 0;
    if (g)
        polygon_lanes_put(&q->polygons, lane, g);
}

static void flat_make_polygons(flat_tile *w, unsigned lanes) {
    flat_queue *q = &w->queue;
    unsigned alone = ~isopolygons_near(&q->tets, q->isovalue, &q->polygons) & lanes;
    for (unsigned k = 0; k < VD_N && k < q->count; k++)
        alone |= (unsigned)(resident_mesh_of(q->at[k])->polygons != NULL) << k;
    for (unsigned k = 0; k < VD_N; k++)
        if (alone >> k & 1u)
            polygon_alone(w, k);
}

/* Queue a lane's tet. Flush when the queue is full. */
SIMD void put_tet(mesh_tile *w, const resident_mesh *at, const tet_lanes *l, unsigned lane,
                  int32_t iso, tile_rect rect, uint32_t centres) {
    const float *values = mesh_leaf_values(&at->mesh, at->values);
    flat_queue *q = &w->queue;
    const unsigned to = q->count++;
    for (int k = 0; k < 4; k++) {
        const uint32_t v = l->vertex[k][lane];
        for (int a = 0; a < 3; a++)
            q->tets.p[k][a][to] = (double)at->positions[v][a];
        q->tets.f[k][to] = (double)values[v];
    }
    q->isovalue[to] = w->b.s.f->tracer->isos.isovalues[iso];
    q->at[to] = &at->head;
    q->local[to] = l->local[lane];
    q->iso[to] = iso;
    q->rect[to] = rect;
    q->centres[to] = centres;
    q->pixels += (rect.x1 - rect.x0 + 1u) * (rect.y1 - rect.y0 + 1u);
    LANE_COUNT(looked_at, 1u);
    if (q->count == VD_N || q->pixels >= QUEUE_PIXELS)
        walk_queue(w);
}

#endif
#endif
