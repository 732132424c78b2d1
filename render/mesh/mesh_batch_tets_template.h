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

#include "render/mesh/kept_polygons.h"
#include "render/mesh/mesh_beams_template.h"
#include "render/mesh/mesh_walk.h"
#include "stream/interest.h"

/* A bit per ray of a group. */
enum { RAY_WORDS = TET_RAYS / 64 };

/* Active tets of a treelet, a lane each. */
typedef struct batch_tets {
    uint32_t vertex[4][VF_N]; /* in the treelet */
    uint32_t local[VF_N];
    uint32_t beams[BEAM_BOXES];
    uint32_t any; /* beams of any of the tets */
    unsigned count;
} batch_tets;

typedef struct mesh_batch {
    const tracer *tr;
    ray_batch *b;
    ray_counters *counters;
    bool alone[RAY_BATCH];
    uint8_t octant[RAY_BATCH];
    beam_frame frame;
    /* A group: rays of an octant. */
    unsigned count;
    float along[3]; /* the sum of their directions */
    int axis;       /* the axis along which that is largest */
    tet_rays rays;
    frame_rays in_frame;
    uint8_t of[TET_RAYS];              /* a ray's number in the batch */
    bool any[TET_RAYS];                /* whether any hit will do */
    uint64_t origin[TET_RAYS];         /* the tet on whose isopolygon the ray begins */
    int32_t origin_iso[TET_RAYS];      /* below 0: on none */
    double wait[TET_RAYS];             /* t at which the ray enters the first absent treelet */
    const resident_mesh *at[TET_RAYS]; /* the treelet of its best hit */
    uint64_t looks[RAY_WORDS];         /* rays that still look for hits */
    /* The rays that make beams: */
    mesh_beams beams;
    uint8_t first[MESH_BEAMS], share[MESH_BEAMS]; /* rays of a beam: part of a word of `looks` */
    uint8_t beam_of[TET_RAYS];
    uint32_t alive; /* beams with rays that still look */
    batch_tets tets;
} mesh_batch;
_Static_assert(sizeof(mesh_batch) <= MESH_BATCH_SCRATCH, "a batch has room in its scratch");

/* ---- Rays that have found something ---- */

/* Ray i now looks less far than before: update its beam. Drop the ray, or the beam, if it does not
 * look any more. */
static void beam_sees(mesh_batch *w, unsigned i) {
    const unsigned beam = w->beam_of[i], first = w->first[beam];
    w->beams.far[beam] = farthest(&w->in_frame, first, first + w->share[beam]);
    if (w->in_frame.far[i] < 0.0f)
        w->looks[i / 64] &= ~(UINT64_C(1) << i % 64);
    if (w->beams.far[beam] < 0.0f)
        w->alive &= ~(1u << beam);
}

static void take_hit(mesh_batch *w, const resident_mesh *at, unsigned i) {
    w->at[i] = at;
    w->counters->roots++;
    if (w->any[i]) {
        w->rays.to[i] = -INFINITY;
        w->in_frame.far[i] = -1.0f;
    } else {
        look_up_to(&w->in_frame, (int)i, w->rays.to[i]);
    }
    beam_sees(w, i);
}

/* ---- Isopolygons ---- */

/* Tets, a lane each: their vertices in the frame, and their values. For an isovalue also which
 * vertices are inside, and the points on their edges. */
typedef struct framed_tets {
    vf p[4][3], f[4];
    unsigned odd; /* lanes with values too large for sums and quotients of floats */
    _Alignas(64) float cut[TET_EDGES][3][VF_N];
    int32_t inside[VF_N]; /* a bit per vertex */
} framed_tets;

/* The edges around a polygon as lines of the frame. The edge function of a ray (o, d) is d . moment
 * + edge . (o x d). */
typedef struct polygon_lines {
    float edge[4][3], moment[4][3];
    float error; /* of its edge functions */
    int count;
} polygon_lines;

/* Error bound of a polygon's edge functions: LINE_ERROR S + LINE_ERROR_LEAST, where S is the sum of
 * |x| over all components x of all edges. A ray that hits the exact polygon passes all edges on the
 * same side: a quadrilateral is flat and convex. Two errors may hide this.
 *
 * 1. Points are off by e = 2^-19 per component at most (mesh_beams_template.h). Let X be the hit,
 * and a and b the errors of points P and Q. The edge function is then off by d . (a x (Q - P)) + d
 * . ((P - X) x (b - a)) + d . (a x b). No component of d exceeds 1, and neither Q - P nor P - X is
 * longer than S / 2. So this is less than 3 e S + 2^-32; the 2^-32 is for products of errors. The
 * rounded points need not be in a plane: the proof uses only the exact polygon.
 *
 * 2. Sums are rounded. A point has components of little more than 1, an origin less than 2, o x d
 * less than 4. So the terms' moduli add up to 2 |Q - P| for d . moment, and to 4 |Q - P| for edge .
 * (o x d). Each term is rounded 9 times at most. With u = 2^-24 this gives 54 u |Q - P|, less than
 * e S.
 *
 * Both together are less than 4 e S + 2^-32. The constants allow 8 e S + 2^-32. */
static const float LINE_ERROR = 0x1p-16f, LINE_ERROR_LEAST = 0x1p-32f;

SIMD void lines_of(const framed_tets *x, unsigned lane, polygon_lines *l) {
    const tet_cut *cut = &tet_cuts[x->inside[lane]];
    float p[4][3], sum = 0.0f;
    l->count = cut->count;
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            p[i][a] = x->cut[cut->edge[i]][a][lane];
    for (int i = 0; i < cut->count; i++) {
        const float *from = p[i], *to = p[i + 1 < cut->count ? i + 1 : 0];
        float *e = l->edge[i], *m = l->moment[i];
        for (int a = 0; a < 3; a++) {
            e[a] = to[a] - from[a];
            sum += fabsf(e[a]);
        }
        for (int a = 0; a < 3; a++)
            m[a] = from[(a + 1) % 3] * e[(a + 2) % 3] - from[(a + 2) % 3] * e[(a + 1) % 3];
    }
    l->error = LINE_ERROR * sum + LINE_ERROR_LEAST;
}

/* Returns which of VF_N rays from `at` on may hit the polygon. */
SIMD unsigned rays_near(const frame_rays *r, const polygon_lines *l, unsigned at) {
    mf above = mf_of_bits(0), below = mf_of_bits(0);
    for (int i = 0; i < l->count; i++) {
        vf sum = f_load(r->d[0] + at) * f_set(l->moment[i][0]);
        sum = sum + f_load(r->d[1] + at) * f_set(l->moment[i][1]);
        sum = sum + f_load(r->d[2] + at) * f_set(l->moment[i][2]);
        sum = sum + f_load(r->moment[0] + at) * f_set(l->edge[i][0]);
        sum = sum + f_load(r->moment[1] + at) * f_set(l->edge[i][1]);
        sum = sum + f_load(r->moment[2] + at) * f_set(l->edge[i][2]);
        above = mf_or(above, f_gt(sum, f_set(l->error)));
        below = mf_or(below, f_lt(sum, f_set(-l->error)));
    }
    return ~mf_bits(mf_and(above, below));
}

/* Collect the rays of beams that still look. Returns whether there are any. */
SIMD bool rays_of_beams(const mesh_batch *w, uint32_t beams, uint64_t rays[RAY_WORDS]) {
    uint64_t any = 0;
    memset(rays, 0, RAY_WORDS * sizeof *rays);
    for (uint32_t left = beams & w->alive; left; left &= left - 1) {
        const unsigned beam = (unsigned)__builtin_ctz(left), i = w->first[beam];
        rays[i / 64] |= ((UINT64_C(1) << w->share[beam]) - 1) << i % 64;
    }
    for (int word = 0; word < RAY_WORDS; word++)
        any |= rays[word] &= w->looks[word];
    return any;
}

/* Make the isopolygon, or take the one kept with the treelet. Returns whether there is one. */
SIMD bool batch_polygon(const mesh_batch *w, const resident_mesh *at, unsigned lane,
                        double isovalue, isopolygon *out) {
    const uint32_t local = w->tets.local[lane];
    if (at->polygons) {
        const isopolygon *g = at->polygons->find(at, local, isovalue, out);
        if (g && g != out)
            *out = *g;
        return g;
    }
    const float *values = mesh_leaf_values(&at->mesh, at->values);
    near_tet x;
    for (int k = 0; k < 4; k++) {
        const uint32_t v = w->tets.vertex[k][lane];
        x.v[k] = point4_of_triple(at->positions[v]);
        x.v[k][3] = (double)values[v];
    }
    const polygon_certainty found = isopolygon_near(&x, isovalue, out);
    if (found != DOUBTFUL_POLYGON)
        return found == SURE_POLYGON;
    const tet exact = mesh_walk_tet(at, local);
    return isopolygon_of(&exact, isovalue, out);
}

/* Drop the rays that begin on this isopolygon: it is flat, so they do not meet it again. For most
 * shadow rays it is the only polygon that the test in single precision leaves. bits: of the VF_N
 * rays from i on. Returns the bits that are left. */
SIMD unsigned from_elsewhere(const mesh_batch *w, hit_of of, unsigned i, unsigned bits) {
    unsigned left = bits;
    for (; bits; bits &= bits - 1) {
        const unsigned k = i + (unsigned)__builtin_ctz(bits);
        if (w->origin[k] == of.cell && w->origin_iso[k] == of.iso)
            left &= ~(bits & -bits);
    }
    return left;
}

/* Test VD_N rays from i on. */
SIMD void meet_polygon(mesh_batch *w, const resident_mesh *at, const isopolygon *g, hit_of of,
                       unsigned i, unsigned wanted) {
    seen s;
    see_from(g, &w->rays, (int)i, &s);
    for (unsigned taken = test_rays(g, &s, &w->rays, (int)i, of, wanted); taken; taken &= taken - 1)
        take_hit(w, at, i + (unsigned)__builtin_ctz(taken));
}

static void walk_tet(mesh_batch *w, const resident_mesh *at, const framed_tets *x, unsigned lane,
                     int32_t iso, uint32_t beams) {
    enum { FLOATS = (1u << VF_N) - 1, DOUBLES = (1u << VD_N) - 1 };
    const hit_of of = {at->first_tet + w->tets.local[lane], iso};
    const bool even = !(x->odd >> lane & 1u);
    uint64_t rays[RAY_WORDS];
    polygon_lines lines;
    isopolygon g;
    bool made = false;
    if (!rays_of_beams(w, beams, rays))
        return;
    if (even)
        lines_of(x, lane, &lines);
    for (unsigned word = 0; word < RAY_WORDS; word++) {
        for (uint64_t left = rays[word]; left;) {
            const unsigned from = (unsigned)__builtin_ctzll(left) & -(unsigned)VF_N;
            unsigned bits = (unsigned)(left >> from) & FLOATS;
            left &= ~((uint64_t)FLOATS << from);
            if (even)
                bits &= rays_near(&w->in_frame, &lines, 64 * word + from);
            bits = from_elsewhere(w, of, 64 * word + from, bits);
            if (!bits)
                continue;
            if (!made && !batch_polygon(w, at, lane, w->tr->isos.isovalues[iso], &g))
                return;
            made = true;
            for (unsigned k = 0; bits >> k; k += VD_N)
                if (bits >> k & DOUBLES)
                    meet_polygon(w, at, &g, of, 64 * word + from + k, bits >> k & DOUBLES);
        }
    }
}

/* ---- Tets ---- */

SIMD void frame_tets(const mesh_batch *w, const resident_mesh *at, framed_tets *x) {
    const batch_tets *l = &w->tets;
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
SIMD void boxes_of_polygons(const mesh_batch *w, framed_tets *x, double iso, beam_boxes *b) {
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

static void walk_tets(mesh_batch *w, const resident_mesh *at) {
    const isovalue_list *isos = &w->tr->isos;
    batch_tets *l = &w->tets;
    framed_tets x;
    for (unsigned k = l->count; k < VF_N; k++)
        for (int v = 0; v < 4; v++)
            l->vertex[v][k] = l->vertex[v][0];
    frame_tets(w, at, &x);
    for (int32_t i = 0; i < isos->count; i++) {
        const unsigned all = (1u << l->count) - 1;
        uint32_t met[BEAM_BOXES];
        beam_boxes boxes;
        boxes_of_polygons(w, &x, isos->isovalues[i], &boxes);
        unsigned left = meet_boxes(&w->beams, &boxes, all, l->any & w->alive, l->beams, met);
        for (; left; left &= left - 1) {
            const unsigned k = (unsigned)__builtin_ctz(left);
            walk_tet(w, at, &x, k, i, met[k]);
        }
    }
    w->counters->cells += l->count;
    l->any = 0;
    l->count = 0;
}

static void add_tet(mesh_batch *w, const resident_mesh *at, uint32_t local, uint32_t beams) {
    const uint16_t *v = mesh_leaf_tets(&at->mesh, at->head.payload)[local];
    batch_tets *l = &w->tets;
    for (int k = 0; k < 4; k++) {
        __builtin_prefetch(at->positions[v[k]]);
        l->vertex[k][l->count] = v[k];
    }
    l->any |= beams;
    l->beams[l->count] = beams;
    l->local[l->count++] = local;
    if (l->count == VF_N)
        walk_tets(w, at);
}

static void walk_leaf(mesh_batch *w, const resident_mesh *at, uint32_t first, uint32_t end,
                      uint32_t beams) {
    for (uint32_t word = first / 64; word * 64 < end; word++) {
        uint64_t bits = mesh_active_word(at->active, word, first, end);
        for (; bits; bits &= bits - 1)
            add_tet(w, at, word * 64 + (uint32_t)__builtin_ctzll(bits), beams);
    }
}

#endif
#endif
