/* ray.h - rays in grid space, and their hits.
 *
 * A ray is (o + t d) for t in [t0, t1], all double. A world-space ray is converted once, and t
 * keeps its meaning (with a world direction of unit length: the distance from the origin in world
 * units). Hits along a ray are ordered by (t, cell, iso). A ray resumes strictly behind such a
 * triple, never behind t + epsilon.
 */
#ifndef RENDER_RAY_RAY_H
#define RENDER_RAY_RAY_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct ray {
    double o[3];
    double d[3]; /* finite, not all zero; a zero component is +0 */
    double t0, t1;
    double held[3]; /* o, moved just below the volume's upper end, because the last cell owns that
                       end. Traversal uses it on axes with d = 0; the cell kernel does not. */
} ray;

typedef struct hit {
    double t;      /* INFINITY: none */
    uint64_t cell; /* global index of the cell in its level: i + cx * (j + cy * k) */
    int32_t iso;   /* index into the list of isovalues */
    bool entering; /* from f < iso to f >= iso */
} hit;

static inline hit hit_none(void) {
    return (hit){INFINITY, UINT64_MAX, INT32_MAX, false};
}

/* Before every hit of a ray: begin a search for the first hit here. */
static inline hit hit_before_all(void) {
    return (hit){-INFINITY, 0, -1, false};
}

/* After all hits at t, and before all hits at a greater t. */
static inline hit hit_behind(double t) {
    return (hit){t, UINT64_MAX, INT32_MAX, false};
}

/* Before all hits at t or more. As the best of a search this is a bound, not a hit. */
static inline hit hit_from(double t) {
    return (hit){t, 0, -1, false};
}

static inline bool hit_is_bound(const hit *h) {
    return h->iso < 0;
}

static inline bool hit_exists(const hit *h) {
    return h->t < INFINITY;
}

static inline bool hit_less(const hit *a, const hit *b) {
    if (a->t != b->t)
        return a->t < b->t;
    if (a->cell != b->cell)
        return a->cell < b->cell;
    return a->iso < b->iso;
}

#endif
