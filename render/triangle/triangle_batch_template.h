/* triangle_batch_template.h - triangle_batch_X() of triangle_batch.h; included by the units of an
 * ISA (see formats/base/simd.h). */
#ifndef RENDER_TRIANGLE_TRIANGLE_BATCH_TEMPLATE_H
#define RENDER_TRIANGLE_TRIANGLE_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#define FLAT_BATCH_CORNERS 3

#include "render/flat/flat_batch_template.h"
#include "render/triangle/triangle_batch.h"
#include "render/triangle/triangle_walk.h"
#include "stream/triangle_resident.h"

void SIMD_NAME(triangle_batch)(const tracer *tr, ray_batch *b, void *scratch,
                               ray_counters *counters);

_Static_assert(sizeof(flat_batch) <= TRIANGLE_BATCH_SCRATCH, "a batch has room in its scratch");

/* ---- Triangles ---- */

/* Vertices in the frame, a triangle per lane. */
typedef struct framed_triangles {
    _Alignas(64) float p[TRIANGLE_CORNERS][3][VF_N];
} framed_triangles;

/* Put the lanes' triangles into the frame, in boxes. Positions are relative to the treelet's lower
 * corner first, so that they err by no more than the frame's margins allow. */
SIMD void frame_triangles(const flat_batch *w, const triangle_blocks *b, framed_triangles *x,
                          beam_boxes *boxes) {
    const batch_cells *l = &w->cells;
    const beam_frame *f = &w->frame;
    const float *bounds = b->tree.bounds[b->tree.levels - 1][0];
    for (int a = 0; a < 3; a++) {
        const double scale = f->scale * f->sign[a];
        const vf lo = f_set(bounds[a]), slack = f_set(f->slack[a]);
        const vf corner = f_set((float)(((double)bounds[a] - f->centre[a]) * scale));
        vf least = f_set(INFINITY), most = f_set(-INFINITY);
        for (int k = 0; k < TRIANGLE_CORNERS; k++) {
            const vf of = (vf)i_gather(b->p[a], i_load(l->vertex[k]) << 2);
            const vf p = (of - lo) * f_set((float)scale) + corner;
            least = f_min(least, p);
            most = f_max(most, p);
            f_store(x->p[k][a], p);
        }
        f_store(boxes->lo[a], least - slack);
        f_store(boxes->hi[a], most + slack);
    }
}

static bool batch_polygon(const flat_batch *w, const treelet *at, unsigned lane, int32_t iso,
                          flat_polygon *out) {
    const triangle_blocks *b = &resident_triangles_of(at)->blocks;
    triangle x;
    (void)iso;
    for (int k = 0; k < TRIANGLE_CORNERS; k++)
        for (int a = 0; a < 3; a++)
            x.p[k][a] = b->p[a][w->cells.vertex[k][lane]];
    triangle_polygon(&x, out);
    return true;
}

static void walk_triangles(flat_batch *w, const treelet *at) {
    const triangle_blocks *b = &resident_triangles_of(at)->blocks;
    batch_cells *l = &w->cells;
    const unsigned all = (1u << l->count) - 1;
    uint32_t met[BEAM_BOXES];
    framed_triangles x;
    beam_boxes boxes;
    fill_cells(l);
    frame_triangles(w, b, &x, &boxes);
    unsigned left = meet_boxes(&w->beams, &boxes, all, l->any & w->alive, l->beams, met);
    for (; left; left &= left - 1) {
        const unsigned lane = (unsigned)__builtin_ctz(left);
        uint64_t rays[RAY_WORDS];
        polygon_lines lines;
        float p[4][3];
        if (!rays_of_beams(w, met[lane], rays))
            continue;
        for (int k = 0; k < TRIANGLE_CORNERS; k++)
            for (int a = 0; a < 3; a++)
                p[k][a] = x.p[k][a][lane];
        lines_of_points((const float(*)[3])p, TRIANGLE_CORNERS, &lines);
        walk_cell(w, at, lane, (hit_of){triangle_blocks_number(b, l->local[lane]), 0}, &lines,
                  rays);
    }
    empty_cells(w);
}

/* ---- Treelets ---- */

static void visit_block(flat_batch *w, const void *ctx, uint32_t block, uint32_t beams) {
    const treelet *at = ctx;
    const triangle_blocks *b = &resident_triangles_of(at)->blocks;
    for (unsigned left = b->active[block]; left; left &= left - 1) {
        const uint32_t i = TRIANGLE_BLOCK * block + (uint32_t)__builtin_ctz(left);
        if (add_cell(w, b->rows[i], i, beams))
            walk_triangles(w, at);
    }
}

static void batch_treelet(flat_batch *w, const treelet *at, uint32_t beams) {
    walk_beams_through(w, &resident_triangles_of(at)->blocks.tree, beams, visit_block, NULL, at);
    if (w->cells.count > 0)
        walk_triangles(w, at);
}

static surface_point batch_point(const flat_batch *w, const treelet *at, const ray *r,
                                 const hit *h) {
    const triangle_blocks *b = &resident_triangles_of(at)->blocks;
    uint32_t local;
    (void)triangle_walk_place(w->tr->treelets->file, h->cell, &local);
    const triangle x = triangle_walk_one(b, local);
    return triangle_point(&x, r, h, w->tr->coloured);
}

/* Of a surface that goes through its box a few times. */
static double batch_cells_across(const flat_batch *w) {
    return sqrt(0.125 * (double)w->tr->treelets->file->header.tets);
}

void SIMD_NAME(triangle_batch)(const tracer *tr, ray_batch *b, void *scratch,
                               ray_counters *counters) {
    walk_batch(scratch, tr, b, true, counters);
}

#endif
#endif
