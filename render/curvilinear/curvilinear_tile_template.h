/* curvilinear_tile_template.h - curvilinear_tile_X() of curvilinear_tile.h; included by the units
 * of an ISA (see formats/base/simd.h). */
#ifndef RENDER_CURVILINEAR_CURVILINEAR_TILE_TEMPLATE_H
#define RENDER_CURVILINEAR_CURVILINEAR_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/curvilinear/curvilinear_block_template.h"
#include "render/curvilinear/curvilinear_shade_template.h"

void SIMD_NAME(curvilinear_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                                 tile_outcome *out, ray_counters *counters);

/* What is kept in the outcome's scratch. */
typedef struct curvilinear_work {
    curvilinear_tile tile;
    curvilinear_shading shading;
} curvilinear_work;
_Static_assert(sizeof(curvilinear_work) <= CURVILINEAR_TILE_SCRATCH,
               "a tile has room in its scratch");

static const tile_visitor block_visitor = {walk_block, NULL, NULL};

static void visit_treelet(void *work, const tile_pending *p) {
    curvilinear_tile *w = work;
    w->at = resident_curvilinear_of(treelet_in_sight(&w->b, p));
    if (!w->at)
        return;
    shear_rays(w);
    walk_tree(&w->b, &w->at->lattice.tree, p->rect, p->near2, &block_visitor, w);
}

static void queue_treelet(void *work, uint32_t t) {
    const curvilinear_tile *w = work;
    loader_prefetch(w->b.s.f->tracer->treelets, t);
}

static const tile_visitor treelet_visitor = {visit_treelet, queue_treelet, NULL};

void SIMD_NAME(curvilinear_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                                 tile_outcome *out, ray_counters *counters) {
    curvilinear_work *work = out->scratch;
    curvilinear_tile *w = &work->tile;
    tile_boxes_begin(&w->b, f, &curvilinear_order, x0, y0, asked, out, counters);
    w->sheared = false;
    work->shading.s = &w->b.s;
    do {
        walk_tree(&w->b, f->tracer->treelets->tree, tile_boxes_again(&w->b), 0.0f, &treelet_visitor,
                  w);
        shade_walk(&w->b.s, &curvilinear_kind_of_tile, &work->shading, &work->shading.pixels);
    } while (tile_state_again(&w->b.s, TILE_LAYERS, work->shading.pixels.rgba[3]));
    shade_behind_all(f, &work->shading.pixels);
    write_tile(&w->b.s, &work->shading.pixels);
}

#endif
#endif
