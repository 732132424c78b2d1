/* hex_tile_template.h - hex_trace_tile(): a tile of primary rays through cells with bent faces;
 * included by the units of an ISA (see formats/base/simd.h). The kind defines before, beside what
 * hex_shade_template.h asks for:
 *
 *   static const treelet_tree *hex_tile_tree(const treelet *at);   over a treelet's blocks
 *   static void hex_walk_block(void *work, const tile_pending *p); walk_cell() of a block's active
 *                                                                  cells; work: a hex_tile
 */
#ifndef RENDER_CURVED_HEX_TILE_TEMPLATE_H
#define RENDER_CURVED_HEX_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/curved/hex_tile_cells_template.h"

/* What is kept in the outcome's scratch. */
typedef struct hex_work {
    hex_tile tile;
    hex_shading shading;
} hex_work;
_Static_assert(sizeof(hex_work) <= HEX_TILE_SCRATCH, "a tile has room in its scratch");

static const tile_visitor hex_block_visitor = {hex_walk_block, NULL, NULL};

static void visit_treelet(void *work, const tile_pending *p) {
    hex_tile *w = work;
    w->at = treelet_in_sight(&w->b, p);
    if (!w->at)
        return;
    shear_rays(w);
    walk_tree(&w->b, hex_tile_tree(w->at), p->rect, p->near2, &hex_block_visitor, w);
}

static void queue_treelet(void *work, uint32_t t) {
    const hex_tile *w = work;
    loader_prefetch(w->b.s.f->tracer->treelets, t);
}

static const tile_visitor hex_treelet_visitor = {visit_treelet, queue_treelet, NULL};

/* The body of a tile_fn. */
static void hex_trace_tile(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                           tile_outcome *out, ray_counters *counters) {
    hex_work *work = out->scratch;
    hex_tile *w = &work->tile;
    tile_boxes_begin(&w->b, f, &hex_order, x0, y0, asked, out, counters);
    w->sheared = false;
    work->shading.s = &w->b.s;
    do {
        walk_tree(&w->b, f->tracer->treelets->tree, tile_boxes_again(&w->b), 0.0f,
                  &hex_treelet_visitor, w);
        shade_walk(&w->b.s, &hex_kind_of_tile, &work->shading, &work->shading.pixels);
    } while (tile_state_again(&w->b.s, TILE_LAYERS, work->shading.pixels.rgba[3]));
    shade_behind_all(f, &work->shading.pixels);
    write_tile(&w->b.s, &work->shading.pixels);
}

#endif
#endif
