/* flat_batch_cells_template.h - what a batch (flat_batch_template.h) knows of its rays, and its
 * rays against polygons of cells; included by the units of an ISA (see formats/base/simd.h).
 *
 * The kind's unit defines FLAT_BATCH_CORNERS, of a cell, before it includes this, and the functions
 * that are declared here without a body.
 */
#ifndef RENDER_FLAT_FLAT_BATCH_CELLS_TEMPLATE_H
#define RENDER_FLAT_FLAT_BATCH_CELLS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/flat/flat_beams_template.h"
#include "render/ray/ray_batch.h"
#include "stream/loader.h"

/* A bit per ray of a group. */
enum { RAY_WORDS = FLAT_RAYS / 64 };

/* Active cells of a treelet, a lane each. */
typedef struct batch_cells {
    uint32_t vertex[FLAT_BATCH_CORNERS][VF_N]; /* in the treelet */
    uint32_t local[VF_N];
    uint32_t beams[BEAM_BOXES];
    uint32_t any; /* beams of any of the cells */
    unsigned count;
} batch_cells;

typedef struct flat_batch {
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
    flat_rays rays;
    frame_rays in_frame;
    uint8_t of[FLAT_RAYS];         /* a ray's number in the batch */
    bool any[FLAT_RAYS];           /* whether any hit will do */
    uint64_t origin[FLAT_RAYS];    /* the cell on whose polygon the ray begins */
    int32_t origin_iso[FLAT_RAYS]; /* below 0: on none */
    double wait[FLAT_RAYS];        /* t at which the ray enters the first absent treelet */
    const treelet *at[FLAT_RAYS];  /* the treelet of its best hit */
    uint64_t looks[RAY_WORDS];     /* rays that still look for hits */
    /* The rays that make beams: */
    flat_beams beams;
    uint8_t first[FLAT_BEAMS], share[FLAT_BEAMS]; /* rays of a beam: part of a word of `looks` */
    uint8_t beam_of[FLAT_RAYS];
    uint32_t alive; /* beams with rays that still look */
    batch_cells cells;
} flat_batch;

/* Of the kind: walk a treelet that is there. Make the polygon of a lane's cell; false: there is
 * none. The point of a ray's hit in a treelet. Cells along a side of the frame, on average. */
static void batch_treelet(flat_batch *w, const treelet *at, uint32_t beams);
static bool batch_polygon(const flat_batch *w, const treelet *at, unsigned lane, int32_t iso,
                          flat_polygon *out);
static surface_point batch_point(const flat_batch *w, const treelet *at, const ray *r,
                                 const hit *h);
static double batch_cells_across(const flat_batch *w);

/* ---- Rays that have found something ---- */

/* Ray i now looks less far than before: update its beam. Drop the ray, or the beam, if it does not
 * look any more. */
static void beam_sees(flat_batch *w, unsigned i) {
    const unsigned beam = w->beam_of[i], first = w->first[beam];
    w->beams.far[beam] = farthest(&w->in_frame, first, first + w->share[beam]);
    if (w->in_frame.far[i] < 0.0f)
        w->looks[i / 64] &= ~(UINT64_C(1) << i % 64);
    if (w->beams.far[beam] < 0.0f)
        w->alive &= ~(1u << beam);
}

static void take_hit(flat_batch *w, const treelet *at, unsigned i) {
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

/* ---- Polygons ---- */

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
 * 1. Points are off by e = 2^-19 per component at most (flat_beams_template.h). Let X be the hit,
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

/* Make the lines around a polygon. */
SIMD void lines_of_points(const float p[4][3], int count, polygon_lines *l) {
    float sum = 0.0f;
    l->count = count;
    for (int i = 0; i < count; i++) {
        const float *from = p[i], *to = p[i + 1 < count ? i + 1 : 0];
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
SIMD bool rays_of_beams(const flat_batch *w, uint32_t beams, uint64_t rays[RAY_WORDS]) {
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

/* Drop the rays that begin on this polygon: it is flat, so they do not meet it again. For most
 * shadow rays it is the only polygon that the test in single precision leaves. bits: of the VF_N
 * rays from i on. Returns the bits that are left. */
SIMD unsigned from_elsewhere(const flat_batch *w, hit_of of, unsigned i, unsigned bits) {
    unsigned left = bits;
    for (; bits; bits &= bits - 1) {
        const unsigned k = i + (unsigned)__builtin_ctz(bits);
        if (w->origin[k] == of.cell && w->origin_iso[k] == of.iso)
            left &= ~(bits & -bits);
    }
    return left;
}

/* Test VD_N rays from i on. */
SIMD void meet_polygon(flat_batch *w, const treelet *at, const flat_polygon *g, hit_of of,
                       unsigned i, unsigned wanted) {
    seen s;
    see_from(g, &w->rays, (int)i, &s);
    for (unsigned taken = test_rays(g, &s, &w->rays, (int)i, of, wanted); taken; taken &= taken - 1)
        take_hit(w, at, i + (unsigned)__builtin_ctz(taken));
}

/* Test the rays of beams against the polygon of a lane's cell. lines: around it; NULL: unknown. */
static void walk_cell(flat_batch *w, const treelet *at, unsigned lane, hit_of of,
                      const polygon_lines *lines, const uint64_t rays[RAY_WORDS]) {
    enum { FLOATS = (1u << VF_N) - 1, DOUBLES = (1u << VD_N) - 1 };
    flat_polygon g;
    bool made = false;
    for (unsigned word = 0; word < RAY_WORDS; word++) {
        for (uint64_t left = rays[word]; left;) {
            const unsigned from = (unsigned)__builtin_ctzll(left) & -(unsigned)VF_N;
            unsigned bits = (unsigned)(left >> from) & FLOATS;
            left &= ~((uint64_t)FLOATS << from);
            if (lines)
                bits &= rays_near(&w->in_frame, lines, 64 * word + from);
            bits = from_elsewhere(w, of, 64 * word + from, bits);
            if (!bits)
                continue;
            if (!made && !batch_polygon(w, at, lane, of.iso, &g))
                return;
            made = true;
            for (unsigned k = 0; bits >> k; k += VD_N)
                if (bits >> k & DOUBLES)
                    meet_polygon(w, at, &g, of, 64 * word + from + k, bits >> k & DOUBLES);
        }
    }
}

/* Add a cell to the lanes. Returns whether they are full. */
SIMD bool add_cell(flat_batch *w, const uint16_t vertex[], uint32_t local, uint32_t beams) {
    batch_cells *l = &w->cells;
    for (int k = 0; k < FLAT_BATCH_CORNERS; k++)
        l->vertex[k][l->count] = vertex[k];
    l->any |= beams;
    l->beams[l->count] = beams;
    l->local[l->count++] = local;
    return l->count == VF_N;
}

/* Let lanes without a cell have a copy of the first one. */
SIMD void fill_cells(batch_cells *l) {
    for (unsigned k = l->count; k < VF_N; k++)
        for (int v = 0; v < FLAT_BATCH_CORNERS; v++)
            l->vertex[v][k] = l->vertex[v][0];
}

SIMD void empty_cells(flat_batch *w) {
    w->counters->cells += w->cells.count;
    w->cells.any = 0;
    w->cells.count = 0;
}

#endif
#endif
