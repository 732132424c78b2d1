/* extremes.h - the greatest, or the least, value on a ray's way through a volume, best first.
 *
 * This is the third question to a kind, beside the hits of tracer.h and the pieces of segments.h. A
 * maximum does not depend on the order of the search. So treelets are visited by falling bound,
 * which the directory gives. Treelets, nodes and cells that cannot improve the result are skipped,
 * and skipped treelets are not read. So a treelet is read only if its bound exceeds the final
 * score, or equals it and the ray enters the treelet in front of the final place.
 *
 * A least value is the greatest one of the opposite sign. So the code compares scores: the value,
 * or minus it.
 *
 * The result is the greatest score of all pieces of segments.h, and the least t at which it occurs.
 * A cell's score is at most the greatest of its samples, which rounding could exceed. Score and t
 * are the same bits in any order of treelets, and whatever was resident when.
 *
 * A ray that meets an absent treelet suspends with its result so far and the treelet's place in the
 * order. Everything before that place has been searched, or could not improve the result.
 */
#ifndef RENDER_RAY_EXTREMES_H
#define RENDER_RAY_EXTREMES_H

#include "render/ray/tracer.h"

/* A treelet on the ray's way. Ordered by falling bound, then by where the ray enters. */
typedef struct extreme_way {
    double t_in, t_out;
    float bound;      /* no score in it is greater */
    uint32_t t;       /* LEAF_NO_TREELET: none */
    uint32_t octants; /* grids only: see grid_passage.h */
} extreme_way;

typedef struct extreme_state {
    bool least;       /* looks for the least value, not the greatest */
    bool provisional; /* preview: something that may change the result was coarser than asked, or
                         absent */
    float doubt;      /* preview: the greatest bound of what was absent */
    double score, t;  /* found so far; none: -INFINITY */
    uint32_t in;      /* the treelet of volume `of` that has it; LEAF_NO_TREELET: none has */
    const tracer *of; /* the volume that is, or was last, searched */
    extreme_way next; /* where to resume; none: from the start */
    uint32_t blocked; /* the absent treelet that is needed: next.t */
} extreme_state;

/* extreme_begin() - returns a state with nothing found. extreme_go_on() - begin to search a volume,
 * the first or a further one; keeps the result so far. */
extreme_state extreme_begin(bool least);
void extreme_go_on(extreme_state *s, const tracer *tr);

/* extreme_next() - search until no treelet can change the result (TRACE_MISS), or the absent
 * treelet s->blocked is needed. Only for kinds with extreme rows (kind.h). near: state of a
 * neighbouring ray, or NULL. Searching first where it found its value saves time, and does not
 * change the result. */
trace_result extreme_next(const tracer *tr, const ray *r, const extreme_state *near,
                          extreme_state *s, ray_counters *counters);

/* extreme_found() - whether any value was found. extreme_value() - that value. */
static inline bool extreme_found(const extreme_state *s) {
    return s->score > -INFINITY;
}
static inline double extreme_value(const extreme_state *s) {
    return s->least ? -s->score : s->score;
}

/* ---- For kinds ---- */

/* extreme_matters() - whether scores up to `bound`, at t_in or later, may change the result. */
static inline bool extreme_matters(const extreme_state *s, double bound, double t_in) {
    return bound > s->score || (bound == s->score && t_in < s->t);
}

/* extreme_offer() - take a score at t, in treelet `in`, if it is better. Returns whether it is. */
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

/* extreme_bound() - the greatest score of values in range[0] .. range[1]. */
static inline float extreme_bound(const extreme_state *s, const float range[2]) {
    return s->least ? -range[0] : range[1];
}

enum { EXTREME_WAYS_MAX = 48 };

/* The next treelets in the order, as many as there is room for. */
typedef struct extreme_ways {
    extreme_state *state;
    extreme_way behind; /* only treelets after this one in the order, */
    bool too;           /* and this one; behind.t LEAF_NO_TREELET: all */
    bool full;          /* there are more */
    uint32_t count;
    extreme_way of[EXTREME_WAYS_MAX];
} extreme_ways;

/* extreme_ways_skip() - returns whether a treelet with this bound or a lower one, entered at t_in
 * or later, may be skipped. */
static inline bool extreme_ways_skip(const extreme_ways *w, float bound, double t_in) {
    return !extreme_matters(w->state, (double)bound, t_in) ||
           (w->full && bound < w->of[w->count - 1].bound);
}

/* extreme_ways_take() - add a treelet that is on the ray's way. */
void extreme_ways_take(extreme_ways *w, const extreme_way *way);

#endif
