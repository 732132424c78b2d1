/* medium_cuts.h - pieces of rays cut into stretches, each in one span of the transfer function,
 * many at a time: dense lists for vectors.
 *
 * The order of work: add pieces; find their cuts (at[], off[]), vector by vector; make stretches of
 * them with medium_cuts_place(); compute what is seen of each stretch, vector by vector. All
 * operations are the same as in medium_stretch.c.
 */
#ifndef RENDER_MEDIUM_MEDIUM_CUTS_H
#define RENDER_MEDIUM_MEDIUM_CUTS_H

#include "render/medium/medium_stretch.h"
#include "render/ray/segment_batch.h"

/* The most stretches at a time, and of a piece. */
enum { MEDIUM_STRETCHES = 256, MEDIUM_STRETCHES_OF_PIECE = 64 };

/* Cuts to be found, in the order of the stretches that end at them. A cut is where the value is v,
 * in a part [a, b] of a piece in which the value goes monotonically from fa to fb. */
typedef struct medium_cut_list {
    unsigned count;
    uint16_t piece[MEDIUM_STRETCHES];
    _Alignas(64) double v[MEDIUM_STRETCHES], enough[MEDIUM_STRETCHES];
    double a[MEDIUM_STRETCHES], b[MEDIUM_STRETCHES];
    double fa[MEDIUM_STRETCHES], fb[MEDIUM_STRETCHES];
    /* Found: the cut's place, and how far the value there is from v. */
    double at[MEDIUM_STRETCHES], off[MEDIUM_STRETCHES];
} medium_cut_list;

typedef struct medium_stretch_list {
    unsigned count;
    uint16_t piece[MEDIUM_STRETCHES], span[MEDIUM_STRETCHES];
    bool is_cut[MEDIUM_STRETCHES]; /* ends at a cut, whose place is not known yet */
    _Alignas(64) double from[MEDIUM_STRETCHES], to[MEDIUM_STRETCHES], off[MEDIUM_STRETCHES];
    /* What is seen of each: a medium_stretch. */
    double rgb[3][MEDIUM_STRETCHES], through[MEDIUM_STRETCHES];
    double rgb_error[MEDIUM_STRETCHES], through_error[MEDIUM_STRETCHES];
    /* Stretches to be done in steps, and the length of each one's first step. */
    unsigned stepped;
    uint16_t by_steps[MEDIUM_STRETCHES];
    double step[MEDIUM_STRETCHES];
} medium_stretch_list;

typedef struct medium_cuts {
    unsigned count; /* pieces */
    uint16_t piece[MEDIUM_STRETCHES];
    uint16_t end[MEDIUM_STRETCHES]; /* index behind its last stretch */
    bool lost[MEDIUM_STRETCHES];    /* a cut was not found: leave the piece to the scalar code */
    medium_cut_list cuts;
    medium_stretch_list stretches;
} medium_cuts;

/* medium_cuts_clear() - remove all pieces. */
void medium_cuts_clear(medium_cuts *c);

/* medium_cuts_full() - whether there may be no room for another piece. */
static inline bool medium_cuts_full(const medium_cuts *c) {
    return c->stretches.count + MEDIUM_STRETCHES_OF_PIECE > MEDIUM_STRETCHES;
}

/* medium_cuts_add() - add piece i of the columns. value_error: bound of its value's error. low,
 * high: spans of its least and its greatest coefficient. Returns false if the scalar code has to
 * compute the piece: the transfer function has a step there, or there is no room. */
bool medium_cuts_add(medium_cuts *c, const transfer *t, const segment_columns *pieces, unsigned i,
                     double value_error, int low, int high);

/* medium_cuts_add_whole() - add a piece that lies in one span. */
void medium_cuts_add_whole(medium_cuts *c, unsigned i, int span);

/* medium_cuts_place() - make stretches from the cuts that have been found. Keeps only stretches of
 * which something is seen. */
void medium_cuts_place(medium_cuts *c, const transfer *t);

#endif
