/* mesh_beams_template.h - beams of rays and boxes, in the frame of a mesh; included by the units of
 * an ISA (see formats/base/simd.h).
 *
 * The frame. A mesh is moved and scaled until its bounds lie within -1 .. 1, and mirrored until all
 * directions of a group of rays are positive. A ray's direction is scaled until its largest
 * component is 1, and the ray begins where it comes to the mesh or where it begins to look, a
 * little (AHEAD) before that: so all that it may meet lies at 0 <= t <= 4 or so, and a box's near
 * planes are its lower ones. Numbers are floats of ordinary size then, whatever the mesh's
 * coordinates are.
 *
 * What errs, with u = 2^-24, and what is given away for it:
 *   positions   An origin, a plane and a point of a polygon err by 4 u each at most: they are made
 * in double and rounded, or of a treelet's corner and a multiple, both rounded. A treelet's planes,
 * which mesh_leaf_plane() rounds, err by u of their place in the world besides. Boxes are larger by
 * `slack`: 2^-19, and 4 u of that place. t           A difference and a product err by 2 u of
 * themselves, a direction's inverse by u: inverses are smaller for near planes and larger for far
 * ones by 16 u. Near ones behind the origin do not count (t begins at 0), far ones there have the
 * right sign: the difference has it, because of the slack. steepness   An inverse is at most 2^40:
 * a ray that is steeper moves by less than 2^-37 there, which is nothing beside the slack. ends A
 * hit's t errs by less than 2^-40 of itself (mesh_walk_behind()), and rays come from 2^20 at most:
 * 2^-20. AHEAD is 2^-16, before the start and behind the end.
 */
#ifndef RENDER_MESH_MESH_BEAMS_TEMPLATE_H
#define RENDER_MESH_MESH_BEAMS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/mesh_batch.h"
#include "render/mesh/mesh_tracer.h"
#include "render/mesh/mesh_walk.h"
#include "render/mesh/tet_rays_template.h"

static const double AHEAD = 0x1p-16, STEEPEST = 0x1p40, FARTHEST = 0x1p12;

/* A mesh's frame, and how a group of rays mirrors it. */
typedef struct beam_frame {
    double centre[3], scale;
    double sign[3];
    float slack[3]; /* of boxes */
    double half;    /* all of the mesh lies within -half .. half, with all that is given away */
} beam_frame;

/* False: numbers so large or small that floats will not do. */
static bool frame_of_bounds(const float bounds[6], beam_frame *f) {
    double size = 0.0;
    for (int a = 0; a < 3; a++) {
        const double lo = (double)bounds[a], hi = (double)bounds[a + 3];
        f->centre[a] = 0.5 * (lo + hi);
        size = hi - lo > size ? hi - lo : size;
    }
    f->scale = 2.0 / size;
    f->half = 1.0 + 0x1p-5;
    for (int a = 0; a < 3; a++) {
        const double lo = fabs((double)bounds[a]), hi = fabs((double)bounds[a + 3]);
        const double slack = 0x1p-18 + 0x1p-22 * (lo > hi ? lo : hi) * f->scale;
        f->slack[a] = (float)slack;
        f->half = 1.0 + 0x1p-5 + slack > f->half ? 1.0 + 0x1p-5 + slack : f->half;
    }
    return f->scale > 0x1p-100 && f->scale < 0x1p100 && f->half < 2.0;
}

/* ---- Rays ---- */

/* Those of a group, numbered like those of tet_rays. */
typedef struct frame_rays {
    _Alignas(64) float o[3][TET_RAYS], d[3][TET_RAYS], inverse[3][TET_RAYS];
    float moment[3][TET_RAYS]; /* o x d */
    float far[TET_RAYS];       /* how far they look; below 0: they do not */
    float back[TET_RAYS];      /* how far before them their beam begins */
    double begin[TET_RAYS];    /* t of the frame: per_t of it less what it begins at */
    double per_t[TET_RAYS];
} frame_rays;

/* VD_N rays from `at` on. */
SIMD void put_in_frame(const beam_frame *f, const tet_rays *from, int at, frame_rays *to) {
    vd d[3], o[3], largest = d_set(0.0), enter = d_set(-INFINITY), leave = d_set(INFINITY);
    for (int a = 0; a < 3; a++) {
        d[a] = d_abs(d_load(from->d[a] + at));
        o[a] = (d_load(from->o[a] + at) - d_set(f->centre[a])) * d_set(f->scale * f->sign[a]);
        largest = d_max(largest, d[a]);
    }
    const vd per_t = largest * d_set(f->scale);
    for (int a = 0; a < 3; a++) {
        d[a] = d[a] / largest;
        const vd inverse = d_set(1.0) / d_max(d[a], d_set(1.0 / STEEPEST));
        enter = d_max(enter, (d_set(-f->half) - o[a]) * inverse);
        leave = d_min(leave, (d_set(f->half) - o[a]) * inverse);
        d_store_floats(to->inverse[a] + at, inverse);
        d_store_floats(to->d[a] + at, d[a]);
    }
    const vd first = d_max(enter, d_load(from->from + at) * per_t);
    const vd end = d_min(leave, d_load(from->to + at) * per_t);
    const vd begin = first - d_set(AHEAD);
    const vd far =
        d_select(d_le(begin, end + d_set(AHEAD)), end - begin + d_set(2.0 * AHEAD), d_set(-1.0));
    for (int a = 0; a < 3; a++) {
        o[a] = o[a] + begin * d[a];
        d_store_floats(to->o[a] + at, o[a]);
    }
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        d_store_floats(to->moment[a] + at, o[b] * d[c] - o[c] * d[b]);
    }
    d_store_floats(to->far + at, far);
    d_store(to->begin + at, begin);
    d_store(to->per_t + at, per_t);
}

/* It looks no farther than t. */
static void look_up_to(frame_rays *r, int i, double t) {
    const float far = (float)(t * r->per_t[i] - r->begin[i] + 2.0 * AHEAD);
    r->far[i] = far < r->far[i] ? far : r->far[i];
}

/* ---- Beams ---- */

/* A lane each. For near planes the origin that is farthest ahead and the fastest ray, for far
 * planes the other end. */
typedef struct mesh_beams {
    _Alignas(64) float ahead[3][MESH_BEAMS], behind[3][MESH_BEAMS];
    float least[3][MESH_BEAMS], most[3][MESH_BEAMS]; /* of the inverses */
    float far[MESH_BEAMS];
} mesh_beams;

static void empty_beam(mesh_beams *m, unsigned beam) {
    for (int a = 0; a < 3; a++) {
        m->ahead[a][beam] = m->behind[a][beam] = 0.0f;
        m->least[a][beam] = m->most[a][beam] = 1.0f;
    }
    m->far[beam] = -1.0f;
}

/* Rays begin where their beam does along an axis: those that begin later go back to there, where
 * that is not far. So origins are spread over a plane, and not in a box. */
typedef struct beam_start {
    int axis;
    float at; /* -INFINITY: they begin where they do */
} beam_start;

SIMD beam_start start_of(const frame_rays *r, int first, int end, int axis) {
    float least = INFINITY, most = -INFINITY, slowest = 1.0f;
    for (int i = first; i < end; i++) {
        if (r->far[i] < 0.0f)
            continue;
        const float o = r->o[axis][i], d = r->d[axis][i];
        least = o < least ? o : least;
        most = o > most ? o : most;
        slowest = d < slowest ? d : slowest;
    }
    return (beam_start){axis, most - least <= 0.25f && slowest >= 0.25f ? least : -INFINITY};
}

/* How far a beam of these rays looks; below 0: it does not. */
SIMD float farthest(const frame_rays *r, int first, int end) {
    float most = -1.0f;
    for (int i = first; i < end; i++) {
        const float far = r->far[i] < 0.0f ? -1.0f : r->far[i] + r->back[i];
        most = far > most ? far : most;
    }
    return most;
}

/* What mesh_interval_in() gives away for these rays, which wait for the treelets that it says they
 * enter: 4 MESH_GENEROSITY of a box's t at most, which is less than where they begin in the frame
 * and 8. */
SIMD float generosity(const frame_rays *r, int first, int end) {
    double most = 0.0;
    for (int i = first; i < end; i++)
        if (r->far[i] >= 0.0f)
            most = fabs(r->begin[i]) > most ? fabs(r->begin[i]) : most;
    return (float)(4.0 * MESH_GENEROSITY * (most + 8.0));
}

/* How far ray i goes back, in its t. */
SIMD float way_back(const frame_rays *r, int i, const beam_start *s) {
    return s->at > -INFINITY ? (r->o[s->axis][i] - s->at) * r->inverse[s->axis][i] : 0.0f;
}

/* Of the rays from `first` on that look at all; false: none. axis: the one they go along most. */
static bool make_beam(mesh_beams *m, unsigned beam, frame_rays *r, int first, int end, int axis) {
    const beam_start start = start_of(r, first, end, axis);
    empty_beam(m, beam);
    for (int i = first; i < end; i++)
        r->back[i] = way_back(r, i, &start);
    m->far[beam] = farthest(r, first, end);
    if (m->far[beam] < 0.0f)
        return false;
    const float slack = generosity(r, first, end);
    for (int a = 0; a < 3; a++) {
        float ahead = -INFINITY, behind = INFINITY, least = INFINITY, most = 0.0f;
        for (int i = first; i < end; i++) {
            if (r->far[i] < 0.0f)
                continue;
            const float o = r->o[a][i] - r->back[i] * r->d[a][i], inverse = r->inverse[a][i];
            ahead = o > ahead ? o : ahead;
            behind = o < behind ? o : behind;
            least = inverse < least ? inverse : least;
            most = inverse > most ? inverse : most;
        }
        m->ahead[a][beam] = ahead + slack;
        m->behind[a][beam] = behind - slack;
        m->least[a][beam] = least * (1.0f - 0x1p-20f);
        m->most[a][beam] = most * (1.0f + 0x1p-20f);
    }
    return true;
}

/* ---- Boxes ---- */

/* AVX-512 has lanes that are idle at nodes, SSE two vectors. */
enum { BEAM_BOXES = (int)VF_N > (int)MESH_CHILDREN ? (int)VF_N : (int)MESH_CHILDREN };

typedef struct beam_boxes {
    _Alignas(64) float lo[3][BEAM_BOXES], hi[3][BEAM_BOXES];
} beam_boxes;

/* Which of VF_N beams from `at` on may meet a box; or one beam which of VF_N boxes. */
SIMD unsigned beams_through(const mesh_beams *m, const beam_boxes *b, unsigned box, unsigned at) {
    vf in = f_set(0.0f), out = f_load(m->far + at);
    for (int a = 0; a < 3; a++) {
        const vf near = f_set(b->lo[a][box]) - f_load(m->ahead[a] + at);
        const vf far = f_set(b->hi[a][box]) - f_load(m->behind[a] + at);
        in = f_max(in, near * f_load(m->least[a] + at));
        out = f_min(out, far * f_load(m->most[a] + at));
    }
    return mf_bits(f_le(in, out));
}

SIMD unsigned boxes_in(const mesh_beams *m, const beam_boxes *b, unsigned at, unsigned beam) {
    vf in = f_set(0.0f), out = f_set(m->far[beam]);
    for (int a = 0; a < 3; a++) {
        const vf near = f_load(b->lo[a] + at) - f_set(m->ahead[a][beam]);
        const vf far = f_load(b->hi[a] + at) - f_set(m->behind[a][beam]);
        in = f_max(in, near * f_set(m->least[a][beam]));
        out = f_min(out, far * f_set(m->most[a][beam]));
    }
    return mf_bits(f_le(in, out));
}

SIMD unsigned vectors_in(uint32_t beams) {
    enum { ALL = (1u << VF_N) - 1 };
    unsigned count = 0;
    for (unsigned at = 0; at < MESH_BEAMS; at += VF_N)
        count += (beams >> at & ALL) != 0;
    return count;
}

/* Of the boxes in `boxes` (bits) those that some of the beams wanted of them may meet: met[] of
 * them, which means nothing for others. any: all beams that are wanted. */
SIMD unsigned meet_boxes(const mesh_beams *m, const beam_boxes *b, unsigned boxes, uint32_t any,
                         const uint32_t wanted[BEAM_BOXES], uint32_t met[BEAM_BOXES]) {
    enum { ALL = (1u << VF_N) - 1 };
    const unsigned end = 32u - (unsigned)__builtin_clz(boxes | 1u);
    const unsigned steps = (end + VF_N - 1) / VF_N * (unsigned)__builtin_popcount(any);
    unsigned found = 0;
    if (3 * steps <= 2 * (unsigned)__builtin_popcount(boxes) * vectors_in(any)) {
        memset(met, 0, BEAM_BOXES * sizeof *met);
        for (uint32_t left = any; left; left &= left - 1) {
            const unsigned beam = (unsigned)__builtin_ctz(left);
            for (unsigned at = 0; at < end; at += VF_N) {
                unsigned bits = (boxes_in(m, b, at, beam) << at) & boxes;
                for (found |= bits; bits; bits &= bits - 1) {
                    const unsigned c = (unsigned)__builtin_ctz(bits);
                    met[c] |= wanted[c] & left & -left;
                }
            }
        }
        return found;
    }
    for (; boxes; boxes &= boxes - 1) {
        const unsigned c = (unsigned)__builtin_ctz(boxes);
        met[c] = 0;
        for (unsigned at = 0; at < MESH_BEAMS; at += VF_N) {
            const unsigned bits = wanted[c] >> at & ALL;
            if (bits)
                met[c] |= (beams_through(m, b, c, at) & bits) << at;
        }
        found |= (unsigned)(met[c] != 0) << c;
    }
    return found;
}

#endif
#endif
