/* segments.h - one ray's pieces through the cells of a volume, in order of t.
 *
 * The second question to a kind, beside tracer.h's: not where an isovalue is crossed, but what the
 * value does everywhere on the way. Resumable at an absent treelet, as tracer_next() is. Like
 * there, only what the loader's selection needs is looked at: treelets, nodes and cells without
 * interest give nothing, and are not read.
 *
 * What holds:
 *   - A piece has a length: t0 < t1. A cell that the ray passes gives one piece, unless its length
 *     vanishes in rounding. Cells that touch NaN or inf give none, flat tets neither.
 *   - Pieces come by rising t0, none twice. In a grid they do not overlap by a bit; in a mesh
 * (whose tets do not overlap) by no more than the rounding of t.
 *   - Where the ray leaves a cell through a face and enters the next one, the end of one piece is
 *     the start of the other: the same bits of t and of the value. In a grid a ray through an edge
 *     or a corner passes from cell to cell at one t, too, but the value there is that of either
 *     cell's own face, equal to rounding. So it is beside a flat tet.
 *   - Values count from tracer.above: 0, or the threshold of who asks whether it is reached. That
 *     is taken off the samples first, as isosurfaces do. So where a face's samples are all equal,
 *     the sign of the value there is exact.
 *   - What a ray in a face, along an edge or through a vertex belongs to: in a grid, to the cell
 *     that owns [i, i + 1); in a mesh, to the tet that it would pass if it were moved by (e, e^2,
 *     e^3), e infinitely small. So nothing is counted twice or left out.
 *   - Where the selection says that it does not matter which value of a range it is
 *     (stream/homogeneous.h), a node or a treelet of a grid may be one piece, of the range's middle
 *     and with half its width, or SEGMENT_EXACT, as spread. Elsewhere that is 0, or SEGMENT_EVEN.
 *   - Where a preview misses a treelet that matters, the ray has a doubt instead (tracer.doubts):
 *     something like a piece, between others, that says in how much of the ray what is missing may
 *     be. In a grid pieces of coarser treelets follow that stand in there, if there are such. Where
 *     deviations are known (deviation.h), each says by its spread how far it may be off, and where
 *     there is none, nothing of interest is.
 *   - t and values err by no more than grid_segments.h and mesh_segments.h say.
 *   - The same bits whatever was resident when, and however little.
 *
 * How it is checked (tests/test_segments.c): every ray against all cells, or tets, by the reference
 * renderers in long double, which share no code. For each cell there: a piece iff it is passed for
 * more than the bound, t and the value at both ends and between them within the bound. Ends that
 * adjoin, bit for bit. The sum of lengths. The same bits with one resident treelet, with room for
 * one piece, and with everything.
 */
#ifndef RENDER_RAY_SEGMENTS_H
#define RENDER_RAY_SEGMENTS_H

#include "render/ray/tracer.h"

/* A piece of a ray in a cell. Its value at t is a polynomial in s = (t - t0) / (t1 - t0), in
 * Bernstein form: b[0] .. b[degree], whose first and last are the values at t0 and t1. */
typedef struct segment {
    double t0, t1;
    double b[4];
    double spread; /* SEGMENT_EXACT or more: the value may be off by so much, but see there; below
                      0: it is a doubt; else 0, or SEGMENT_EVEN */
    uint64_t cell; /* as in a hit; of several cells: one of theirs */
    uint32_t treelet; /* that it came from */
    uint32_t degree;  /* 1 (a tet), 3 (a trilinear cell) */
} segment;

typedef enum segments_result { SEGMENTS_SOME, SEGMENTS_END, SEGMENTS_BLOCKED } segments_result;

/* Pieces of a ray are ordered by these. */
typedef struct segment_key {
    double t0;
    uint64_t cell;
} segment_key;

/* How far a ray has come. The pieces ahead lie in the caller's memory: where a ray is suspended,
 * they stay with it. */
typedef struct segments_state {
    segment *ahead;       /* room for `room` pieces: found, but not yet given out, in order */
    uint32_t room;        /* at least 1; more saves time */
    uint32_t first;       /* of them, the next to be given out */
    uint32_t sure, count; /* from there on: certain to be the next ones; all */
    double t_from;        /* where to resume; */
    uint32_t blocked;     /* at this treelet; LEAF_NO_TREELET: none is waited for */
    bool provisional;     /* preview: something on the way was coarser than wanted, or not there */
    uint32_t doubted;     /* preview: the last treelet of which there was a doubt */
    segment_key last;     /* the piece that was given out last */
    /* Where treelets overlap: */
    uint32_t entered;  /* the last treelet entered, at t_from */
    segment_key limit; /* pieces from here on have been found, and dropped for want of room */
} segments_state;

/* segments_begin() - from the ray's start, with room for so many pieces. */
segments_state segments_begin(segment *ahead, uint32_t room);

/* segments_next() - the next piece, nothing more, or the treelet state->blocked is needed. *out is
 * set where the result is SEGMENTS_SOME. */
segments_result segments_next(const tracer *tr, const ray *r, segments_state *state, segment *out,
                              ray_counters *counters);

/* segments_move() - what is ahead to other memory, with room for `room` pieces, at least 1: those
 * that come first; the others will be found again. Before a state that is blocked is suspended in
 * little room, and when it goes on in more. */
void segments_move(segments_state *state, segment *to, uint32_t room);

/* ---- A piece ---- */

/* segment_at() - the value at parameter s in [0, 1] of the piece, the very ends at 0 and 1. */
double segment_at(const segment *s, double at);

/* segment_part() - into out[0] .. out[degree]: the coefficients over [a, b], in [0, 1] of it. */
void segment_part(const segment *s, double a, double b, double out[4]);

/* The spread of a piece that was taken whole and has one value. */
#define SEGMENT_EXACT 0x1p-1021

/* The spread of a cell's own piece where all samples of the cell are equal: b[1] is that value, and
 * not even rounding moves it; b[0] and b[degree] are those of the neighbours, which rounding may
 * have moved. segment_flatten() - such a piece has that value everywhere; no other changes. */
#define SEGMENT_EVEN 0x1p-1022
static inline void segment_flatten(segment *s) {
    for (uint32_t k = 0; k <= s->degree && s->spread == SEGMENT_EVEN; k++)
        s->b[k] = s->b[1];
}

/* segment_spread() - for values from range[0] to range[1], with their middle. segment_values() -
 * the same range again, or a little more where it has no exact middle. */
double segment_spread(const double range[2], double middle);
void segment_values(double middle, double spread, double range[2]);

/* What a doubt has as spread: from t0 to t1 the pieces that follow are guesses, in place of those
 * of `treelet`, which fills all of that; or `treelet` may have pieces there, where others leave
 * room; or as the first, and the spread of each piece, 0 or more, is how far the value may be off.
 */
#define SEGMENT_GUESSED (-1.0)
#define SEGMENT_BESIDE  (-2.0)
#define SEGMENT_BOUNDED (-3.0)

/* segment_doubt() - of a treelet of a tracer's volume, whose directory says which values it has. */
segment segment_doubt(const tracer *tr, uint32_t t, double spread, double t0, double t1);

/* segment_doubted() - those values into range[]; whether there may be none in places. */
bool segment_doubted(const tracer *tr, uint32_t t, double range[2]);

/* segment_t() - t there. */
double segment_t(const segment *s, double at);

/* segment_range() - the least and the greatest value in it, and where: t of both. */
typedef struct segment_extent {
    double least, most, least_t, most_t;
} segment_extent;
segment_extent segment_range(const segment *s);

/* ---- Beside a piece ---- */

/* The gradient of the value along a piece, in world space, as the scene's normals are made: each
 * component a cubic in the piece's s, by powers. For looks alone: nothing bounds it. */
typedef struct segment_gradient {
    double power[3][4];
} segment_gradient;

/* segment_gradient_of() - of Bernstein coefficients. segment_gradient_at() - at parameter s in
 * [0, 1]. */
segment_gradient segment_gradient_of(const double b[3][4]);

static inline void segment_gradient_at(const segment_gradient *g, double s, double out[3]) {
    for (int a = 0; a < 3; a++) {
        const double *p = g->power[a];
        out[a] = p[0] + s * (p[1] + s * (p[2] + s * p[3]));
    }
}

/* ---- Errors ---- */

/* How far off the pieces of a ray may be, at most. */
typedef struct segments_error {
    double t;     /* their ends */
    double value; /* at a given t but for what comes of that */
} segments_error;

/* segment_value_error() - how far the value of a piece may be off at a given t, and what of it has
 * been worked out by halvings. */
double segment_value_error(const segment *s, const segments_error *error);

/* segments_error_of() - on a ray through a volume whose values are in range[0] .. range[1]. */
segments_error segments_error_of(const tracer *tr, const ray *r, const double range[2]);

/* ---- For kinds ---- */

static inline bool segment_key_less(segment_key a, segment_key b) {
    return a.t0 != b.t0 ? a.t0 < b.t0 : a.cell < b.cell;
}

#endif
