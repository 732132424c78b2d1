/* extremes.h - the greatest, or the least, value on a ray's way through a volume, best first.
 *
 * The third question to a kind, beside tracer.h's hits and segments.h's pieces. Which place comes
 * first does not matter to a maximum, so treelets come by falling bound: what the directory says of
 * their values. A treelet, a node or a cell that cannot exceed what has been found is not entered,
 * and a treelet is not read: those that are read are those that exceed the result, and those that
 * equal it in front of its place.
 *
 * Least values are greatest ones of the opposite sign. So there are scores: the value, or minus it.
 *
 * What is found: of all pieces of segments.h the greatest score, that of a cell being no more than
 * the greatest of its samples (rounding could exceed it); and of the places where it is found the
 * first, by t. Both are the same bits whatever the order, and whatever was resident when.
 *
 * A ray that meets an absent treelet suspends with what it has found and the treelet's place in the
 * order. What comes before that place has been seen, or did not matter.
 */
#ifndef RENDER_RAY_EXTREMES_H
#define RENDER_RAY_EXTREMES_H

#include "render/ray/tracer.h"

/* A treelet on the ray's way. They are ordered by falling bound, then as the ray enters them. */
typedef struct extreme_way {
    double t_in, t_out;
    float bound;      /* no score in it is greater */
    uint32_t t;       /* LEAF_NO_TREELET: none */
    uint32_t octants; /* a grid's, see grid_passage.h */
} extreme_way;

typedef struct extreme_state {
    bool least;       /* what is looked for */
    bool provisional; /* preview: something that matters was coarser than wanted, or not there */
    float doubt;      /* preview: the greatest bound of what was not there */
    double score, t;  /* found so far; none: -INFINITY */
    uint32_t in;      /* this treelet of the volume, LEAF_NO_TREELET: of none of it */
    const tracer *of; /* the volume that is, or was, asked last */
    extreme_way next; /* where to resume; none: from the start */
    uint32_t blocked; /* next.t */
} extreme_state;

/* extreme_begin() - nothing is found. extreme_go_on() - in the first or another volume, with what
 * is found. */
extreme_state extreme_begin(bool least);
void extreme_go_on(extreme_state *s, const tracer *tr);

/* extreme_next() - until no treelet matters (TRACE_MISS), or the treelet s->blocked is needed. For
 * kinds that have the rows. near: what a neighbour of the ray has found; looking there first saves
 * time, and changes nothing else. May be NULL. */
trace_result extreme_next(const tracer *tr, const ray *r, const extreme_state *near,
                          extreme_state *s, ray_counters *counters);

/* extreme_found(), extreme_value() - whether anything is; what it is. */
static inline bool extreme_found(const extreme_state *s) {
    return s->score > -INFINITY;
}
static inline double extreme_value(const extreme_state *s) {
    return s->least ? -s->score : s->score;
}

/* ---- For kinds ---- */

/* extreme_matters() - whether scores up to `bound` from t_in on may change what is found. */
static inline bool extreme_matters(const extreme_state *s, double bound, double t_in) {
    return bound > s->score || (bound == s->score && t_in < s->t);
}

/* extreme_offer() - a score at t, in treelet `in`; whether it is better. */
static inline bool extreme_offer(extreme_state *s, double score, double t, uint32_t in) {
    if (!extreme_matters(s, score, t))
        return false;
    s->score = score;
    s->t = t;
    s->in = in;
    return true;
}

/* extreme_way_before() - whether a comes before b in the order of treelets. */
bool extreme_way_before(const extreme_way *a, const extreme_way *b);

/* extreme_bound() - of values in range[0] .. range[1]. */
static inline float extreme_bound(const extreme_state *s, const float range[2]) {
    return s->least ? -range[0] : range[1];
}

enum { EXTREME_WAYS_MAX = 48 };

/* The next treelets in the order, as far as there is room. */
typedef struct extreme_ways {
    extreme_state *state;
    extreme_way behind; /* only those behind it, */
    bool too;           /* and itself; behind.t none: all */
    bool full;          /* there are more */
    uint32_t count;
    extreme_way of[EXTREME_WAYS_MAX];
} extreme_ways;

/* extreme_ways_skip() - whether no treelet of such a bound, or less, is wanted. */
static inline bool extreme_ways_skip(const extreme_ways *w, float bound, double t_in) {
    return !extreme_matters(w->state, (double)bound, t_in) ||
           (w->full && bound < w->of[w->count - 1].bound);
}

/* extreme_ways_take() - a treelet on the way. */
void extreme_ways_take(extreme_ways *w, const extreme_way *way);

#endif
