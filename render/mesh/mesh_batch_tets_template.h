/* mesh_batch_tets_template.h - tests a batch of rays against a treelet's active tets on their way;
 * included by the units of an ISA (see formats/base/simd.h).
 *
 * Tets are taken a vector at a time. Boxes around their isopolygons are tested against beams. Then
 * the isopolygons' edges are tested against the rays of the beams that meet the box, in single
 * precision. The remaining rays are tested in doubles, as single rays are.
 */
#ifndef RENDER_MESH_MESH_BATCH_TETS_TEMPLATE_H
#define RENDER_MESH_MESH_BATCH_TETS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#define FLAT_BATCH_CORNERS 4

#include "render/flat/flat_batch_cells_template.h"
#include "render/mesh/isopolygon_template.h"
#include "render/mesh/kept_polygons.h"
#include "render/mesh/mesh_walk.h"
#include "stream/interest.h"

/* ---- Isopolygons ---- */

/* Tets, a lane each: their vertices in the frame, and their values. For an isovalue also which
 * vertices are inside, and the points on their edges. */
typedef struct framed_tets {
    vf p[4][3], f[4];
    unsigned odd; /* lanes with values too large for sums and quotients of floats */
    _Alignas(64) float cut[TET_EDGES][3][VF_N];
    int32_t inside[VF_N]; /* a bit per vertex */
} framed_tets;

SIMD void lines_of(const framed_tets *x, unsigned lane, polygon_lines *l) {
    const tet_cut *cut = &tet_cuts[x->inside[lane]];
    float p[4][3];
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            p[i][a] = x->cut[cut->edge[i]][a][lane];
    lines_of_points((const float(*)[3])p, cut->count, l);
}

/* Make the isopolygon, or take the one kept with the treelet. Returns whether there is one. */
static bool batch_polygon(const flat_batch *w, const treelet *of, unsigned lane, int32_t iso,
                          isopolygon *out) {
    const resident_mesh *at = resident_mesh_of(of);
    const double isovalue = w->tr->isos.isovalues[iso];
    const uint32_t local = w->cells.local[lane];
    if (at->polygons) {
        const isopolygon *g = at->polygons->find(at, local, isovalue, out);
        if (g && g != out)
            *out = *g;
        return g;
    }
    const float *values = mesh_leaf_values(&at->mesh, at->values);
    near_tet x;
    for (int k = 0; k < 4; k++) {
        const uint32_t v = w->cells.vertex[k][lane];
        x.v[k] = point4_of_triple(at->positions[v]);
        x.v[k][3] = (double)values[v];
    }
    const polygon_certainty found = isopolygon_near(&x, isovalue, out);
    if (found != DOUBTFUL_POLYGON)
        return found == SURE_POLYGON;
    const tet exact = mesh_walk_tet(at, local);
    return isopolygon_of(&exact, isovalue, out);
}

/* ---- Tets ---- */

SIMD void frame_tets(const flat_batch *w, const resident_mesh *at, framed_tets *x) {
    const batch_cells *l = &w->cells;
    const beam_frame *f = &w->frame;
    const float *values = mesh_leaf_values(&at->mesh, at->values);
    mf odd = mf_of_bits(0);
    for (int k = 0; k < 4; k++) {
        _Alignas(64) float of[VF_N];
        f_load_triples(at->positions[0], l->vertex[k], x->p[k]);
        for (int a = 0; a < 3; a++) {
            const float lo = at->bounds[a];
            const double scale = f->scale * f->sign[a];
            x->p[k][a] = (x->p[k][a] - f_set(lo)) * f_set((float)scale) +
                         f_set((float)(((double)lo - f->centre[a]) * scale));
        }
        for (unsigned i = 0; i < VF_N; i++)
            of[i] = values[l->vertex[k][i]];
        x->f[k] = f_load(of);
        odd = mf_or(odd, f_gt(f_abs(x->f[k]), f_set(0x1p125f)));
    }
    x->odd = mf_bits(odd);
}

/* Make boxes around the isopolygons of tets: around the points where they cut the tets' edges. Such
 * a point is at the share s of its edge. s errs by six units of 2^-24 of itself, for numerator,
 * denominator and quotient. So the point errs by less than half of what boxes are widened by. */
SIMD void boxes_of_polygons(const flat_batch *w, framed_tets *x, double iso, beam_boxes *b) {
    const vf most = f_set(INFINITY), least = f_set(-INFINITY), zero = f_set(0.0f);
    const vf threshold = f_set(value_limits_threshold(iso));
    const vf near = f_set((float)iso), rest = f_set((float)(iso - (double)(float)iso));
    vf up[4], lo[3] = {most, most, most}, hi[3] = {least, least, least};
    mf in[4];
    unsigned edge = 0;
    vf sides = zero;
    for (int k = 0; k < 4; k++) {
        in[k] = f_ge(x->f[k], threshold);
        up[k] = (near - x->f[k]) + rest;
        sides = sides + f_select(in[k], f_set((float)(1 << k)), zero);
    }
    const vi inside = f_to_int(sides);
    memcpy(x->inside, &inside, sizeof inside);
    for (int i = 0; i < 3; i++) {
        for (int j = i + 1; j < 4; j++, edge++) {
            const mf cut = mf_and_not(mf_or(in[i], in[j]), mf_and(in[i], in[j]));
            const vf s = f_max(zero, f_min(up[i] / (x->f[j] - x->f[i]), f_set(1.0f)));
            for (int a = 0; a < 3; a++) {
                const vf p = x->p[i][a] + s * (x->p[j][a] - x->p[i][a]);
                f_store(x->cut[edge][a], p);
                lo[a] = f_min(lo[a], f_select(cut, p, most));
                hi[a] = f_max(hi[a], f_select(cut, p, least));
            }
        }
    }
    const mf odd = mf_of_bits(x->odd);
    for (int a = 0; a < 3; a++) {
        const vf lower = f_min(f_min(x->p[0][a], x->p[1][a]), f_min(x->p[2][a], x->p[3][a]));
        const vf upper = f_max(f_max(x->p[0][a], x->p[1][a]), f_max(x->p[2][a], x->p[3][a]));
        const vf slack = f_set(w->frame.slack[a]);
        f_store(b->lo[a], f_select(odd, lower, lo[a]) - slack);
        f_store(b->hi[a], f_select(odd, upper, hi[a]) + slack);
    }
}

static void walk_tets(flat_batch *w, const resident_mesh *at) {
    const isovalue_list *isos = &w->tr->isos;
    batch_cells *l = &w->cells;
    framed_tets x;
    fill_cells(l);
    frame_tets(w, at, &x);
    for (int32_t i = 0; i < isos->count; i++) {
        const unsigned all = (1u << l->count) - 1;
        uint32_t met[BEAM_BOXES];
        beam_boxes boxes;
        boxes_of_polygons(w, &x, isos->isovalues[i], &boxes);
        unsigned left = meet_boxes(&w->beams, &boxes, all, l->any & w->alive, l->beams, met);
        for (; left; left &= left - 1) {
            const unsigned k = (unsigned)__builtin_ctz(left);
            const bool even = !(x.odd >> k & 1u);
            uint64_t rays[RAY_WORDS];
            polygon_lines lines;
            if (!rays_of_beams(w, met[k], rays))
                continue;
            if (even)
                lines_of(&x, k, &lines);
            walk_cell(w, &at->head, k, (hit_of){at->first_tet + l->local[k], i},
                      even ? &lines : NULL, rays);
        }
    }
    empty_cells(w);
}

static void add_tet(flat_batch *w, const resident_mesh *at, uint32_t local, uint32_t beams) {
    const uint16_t *v = mesh_leaf_tets(&at->mesh, at->head.payload)[local];
    for (int k = 0; k < 4; k++)
        __builtin_prefetch(at->positions[v[k]]);
    if (add_cell(w, v, local, beams))
        walk_tets(w, at);
}

static void walk_leaf(flat_batch *w, const resident_mesh *at, uint32_t first, uint32_t end,
                      uint32_t beams) {
    for (uint32_t word = first / 64; word * 64 < end; word++) {
        uint64_t bits = mesh_active_word(at->active, word, first, end);
        for (; bits; bits &= bits - 1)
            add_tet(w, at, word * 64 + (uint32_t)__builtin_ctzll(bits), beams);
    }
}

#endif
#endif
