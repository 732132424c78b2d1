/* segments.h - one ray's pieces through the cells of a volume, in order of t.
 *
 * This is the second question to a kind. tracer.h asks where an isovalue is crossed; this asks what
 * the value is everywhere on the way. It is resumable at an absent treelet, as tracer_next() is.
 * Only what the loader's selection needs is visited: treelets, nodes and cells without interest
 * give no pieces, and are not read.
 *
 * Guarantees:
 *   - A piece has a length: t0 < t1. A cell that the ray passes gives one piece, unless its length
 *     vanishes in rounding. Cells that touch NaN or inf give none, nor do flat tets.
 *   - Pieces come by rising t0, none twice. In a grid they do not overlap at all; in a mesh (whose
 *     tets do not overlap) by no more than the rounding of t.
 *   - Where the ray leaves a cell through a face and enters the next one, the end of one piece is
 *     the start of the other: the same bits of t and of the value. Through an edge or a corner of a
 *     grid a ray also passes from cell to cell at one t, but each cell takes the value from its own
 *     face there, so they are equal only to rounding. Likewise beside a flat tet.
 *   - Values count from tracer.above: 0, or the threshold that the caller tests. It is subtracted
 *     from the samples first, as for isosurfaces. So where a face's samples are all equal, the sign
 *     of the value there is exact.
 *   - A ray in a face, along an edge or through a vertex belongs, in a grid, to the cell that owns
 *     [i, i + 1); in a mesh, to the tet that it would pass if it were moved by (e, e^2, e^3), e
 *     infinitely small. So nothing is counted twice or left out.
 *   - Where the selection says that all values of a range are equivalent (stream/homogeneous.h), a
 *     node or a treelet of a grid may be one piece. Its value is the range's middle, its spread
 *     half the range's width, or SEGMENT_EXACT. Elsewhere the spread is 0, or SEGMENT_EVEN.
 *   - Where a preview misses a treelet that matters, the ray has a doubt instead (tracer.doubts): a
 *     kind of piece, between others, that says in which part of the ray the missing pieces may be.
 *     In a grid, pieces of coarser treelets follow as a substitute, if there are any. Where
 *     deviations are known (deviation.h), the spread of each says how far it may be off, and gaps
 *     between them hold nothing of interest.
 *   - grid_segments.h and mesh_segments.h bound the errors of t and of values.
 *   - The same bits whatever was resident when, and however little.
 *
 * Checks (tests/render/ray/test_segments.c): every ray against all cells, or tets, by the reference
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
    double spread; /* SEGMENT_EXACT or more: how far the value may be off (but see SEGMENT_EXACT);
                      below 0: a doubt; else 0 or SEGMENT_EVEN */
    uint64_t cell; /* as in a hit; of a piece of several cells: one of them */
    uint32_t treelet; /* that it came from */
    uint32_t degree;  /* 1 (a tet), 3 (a trilinear cell) */
} segment;

typedef enum segments_result { SEGMENTS_SOME, SEGMENTS_END, SEGMENTS_BLOCKED } segments_result;

/* The order of a ray's pieces. */
typedef struct segment_key {
    double t0;
    uint64_t cell;
} segment_key;

/* How far a ray has come. The pieces ahead lie in the caller's memory, and stay there while the ray
 * is suspended. */
typedef struct segments_state {
    segment *ahead; /* room for `room` pieces that are found but not yet given out, in order */
    uint32_t room;  /* at least 1; more saves time */
    uint32_t first; /* index in `ahead` of the next piece to be given out */
    uint32_t sure, count; /* from there on: pieces that are certain to be next; all pieces */
    double t_from;        /* where to resume; */
    uint32_t blocked;     /* at this treelet; LEAF_NO_TREELET: waits for none */
    bool provisional;     /* preview: something on the way was coarser than wanted, or not there */
    uint32_t doubted;     /* preview: the last treelet of which there was a doubt */
    segment_key last;     /* the piece that was given out last */
    /* Where treelets overlap: */
    uint32_t entered;  /* the last treelet entered, at t_from */
    segment_key limit; /* pieces from here on were found, but dropped for want of room */
} segments_state;

/* segments_begin() - returns a state at the ray's start. ahead: room for `room` pieces. */
segments_state segments_begin(segment *ahead, uint32_t room);

/* segments_next() - go on to the next piece (SEGMENTS_SOME: *out is set), the end of the ray, or an
 * absent treelet that is needed: state->blocked. */
segments_result segments_next(const tracer *tr, const ray *r, segments_state *state, segment *out,
                              ray_counters *counters);

/* segments_move() - move the pieces ahead to other memory, with room for `room` pieces, at least 1.
 * Keeps the first ones; the others will be found again. Used before a blocked state is suspended in
 * little room, and when it goes on in more. */
void segments_move(segments_state *state, segment *to, uint32_t room);

/* ---- A piece ---- */

/* segment_at() - the value at parameter `at` in [0, 1] of the piece; exact at 0 and 1. */
double segment_at(const segment *s, double at);

/* segment_part() - the Bernstein coefficients over the part [a, b] of [0, 1], into out[0] ..
 * out[degree]. */
void segment_part(const segment *s, double a, double b, double out[4]);

/* segment_cut() - cut a piece to the ray's [t0, t1]. Returns false if nothing is left. */
bool segment_cut(segment *s, const ray *r);

/* The spread of a piece that was taken whole and has one value exactly. */
#define SEGMENT_EXACT 0x1p-1021

/* The spread of a cell's own piece where all samples of the cell are equal. b[1] is their value,
 * without rounding error; b[0] and b[degree] are shared with the neighbours, whose rounding may
 * have moved them. segment_flatten() - give such a piece that value everywhere; changes no other
 * piece. */
#define SEGMENT_EVEN 0x1p-1022
static inline void segment_flatten(segment *s) {
    for (uint32_t k = 0; k <= s->degree && s->spread == SEGMENT_EVEN; k++)
        s->b[k] = s->b[1];
}

/* segment_spread() - returns the spread of a piece that stands for the values range[0] to range[1];
 * middle: their middle, which the piece has as its value. */
double segment_spread(const double range[2], double middle);

/* segment_values() - set range[] to the values of a piece with this middle and spread: the original
 * range, or slightly more if that has no exact middle. */
void segment_values(double middle, double spread, double range[2]);

/* The spread of a doubt, which covers t0 to t1. GUESSED: the pieces that follow are guesses, in
 * place of the pieces of the absent `treelet`, which fills t0 to t1. BESIDE: `treelet` may have
 * pieces from t0 to t1, where other pieces leave gaps. BOUNDED: as GUESSED, and the spread of each
 * guess, 0 or more, bounds the error of its value.
 */
#define SEGMENT_GUESSED (-1.0)
#define SEGMENT_BESIDE  (-2.0)
#define SEGMENT_BOUNDED (-3.0)

/* segment_doubt() - make a doubt about a treelet of a tracer's volume. The directory gives its
 * values. */
segment segment_doubt(const tracer *tr, uint32_t t, double spread, double t0, double t1);

/* segment_doubted() - set range[] to the least and the greatest value of a doubted treelet.
 * Returns whether some of its samples are not finite: places near them have no value. */
bool segment_doubted(const tracer *tr, uint32_t t, double range[2]);

/* segment_t() - returns the t of parameter `at` of the piece. */
double segment_t(const segment *s, double at);

/* segment_range() - the least and the greatest value of the piece, and t of both. */
typedef struct segment_extent {
    double least, most, least_t, most_t;
} segment_extent;
segment_extent segment_range(const segment *s);

/* ---- Beside a piece ---- */

/* The gradient of the value along a piece, in world space, as for the scene's normals: each
 * component a cubic in the piece's s, by powers. For shading only: its error is not bounded. */
typedef struct segment_gradient {
    double power[3][4];
} segment_gradient;

/* segment_gradient_of() - the same from Bernstein coefficients. segment_gradient_at() - its value
 * at parameter s in [0, 1]. */
segment_gradient segment_gradient_of(const double b[3][4]);

/* segment_gradient_through() - the cubics through four values that are a third of the piece apart.
 */
segment_gradient segment_gradient_through(const double values[3][4]);

static inline void segment_gradient_at(const segment_gradient *g, double s, double out[3]) {
    for (int a = 0; a < 3; a++) {
        const double *p = g->power[a];
        out[a] = p[0] + s * (p[1] + s * (p[2] + s * p[3]));
    }
}

/* ---- Errors ---- */

/* Bounds of the errors of a ray's pieces. */
typedef struct segments_error {
    double t;     /* of their ends */
    double value; /* at a given t, without the effect of the error of t */
} segments_error;

/* segment_value_error() - returns a bound of the error of a piece's value at a given t. Also bounds
 * values that are computed by halving the piece. */
double segment_value_error(const segment *s, const segments_error *error);

/* segments_error_of() - the bounds for a ray through a volume whose values lie in range[0] ..
 * range[1]. */
segments_error segments_error_of(const tracer *tr, const ray *r, const double range[2]);

/* ---- For kinds ---- */

static inline bool segment_key_less(segment_key a, segment_key b) {
    return a.t0 != b.t0 ? a.t0 < b.t0 : a.cell < b.cell;
}

#endif
