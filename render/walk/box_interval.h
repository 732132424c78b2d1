/* box_interval.h - the part of a ray in a box, widened: for cells whose hits are not computed from
 * the planes of boxes (tets, balls, ..; see ray_box.h).
 *
 * A cell's kernel and its box round differently. So intervals are widened by a millionth of the
 * distance. They contain every t that the kernel finds in the box.
 */
#ifndef RENDER_WALK_BOX_INTERVAL_H
#define RENDER_WALK_BOX_INTERVAL_H

#include "render/ray/ray.h"

#define BOX_INTERVAL_MARGIN 0x1p-20

typedef struct box_interval {
    double t_in, t_out;
} box_interval;

/* A ray, prepared for tests against boxes. box_line_of() - prepare a ray. */
typedef struct box_line {
    double o[3], inverse[3]; /* 1 / d; 0 where d = 0 */
    double t0, t1;
} box_line;

static inline box_line box_line_of(const ray *r) {
    box_line s = {.t0 = r->t0, .t1 = r->t1};
    for (int a = 0; a < 3; a++) {
        s.o[a] = r->o[a];
        s.inverse[a] = r->d[a] == 0.0 ? 0.0 : 1.0 / r->d[a];
    }
    return s;
}

/* box_interval_in() - false if the ray misses the box. Monotone: the interval of a box within
 * another begins no earlier. */
static inline bool box_interval_in(const box_line *s, const double lo[3], const double hi[3],
                                   box_interval *out) {
    double t_in = -INFINITY, t_out = INFINITY;
    for (int a = 0; a < 3; a++) {
        if (s->inverse[a] == 0.0) {
            if (s->o[a] < lo[a] || s->o[a] > hi[a])
                return false;
            continue;
        }
        const bool back = s->inverse[a] < 0.0;
        const double near = ((back ? hi : lo)[a] - s->o[a]) * s->inverse[a];
        const double far = ((back ? lo : hi)[a] - s->o[a]) * s->inverse[a];
        t_in = near > t_in ? near : t_in;
        t_out = far < t_out ? far : t_out;
    }
    /* The margin grows with the box, also where t is below 0. So the interval is monotone. */
    const double length = t_out - t_in;
    const double first = t_in - 2.0 * BOX_INTERVAL_MARGIN * (fabs(t_in) + length);
    const double last = t_out + 2.0 * BOX_INTERVAL_MARGIN * (fabs(t_out) + length);
    out->t_in = first > s->t0 ? first : s->t0;
    out->t_out = last < s->t1 ? last : s->t1;
    /* If a number is not finite, the box may be met. */
    return !(first > last) && !(out->t_in > out->t_out);
}

/* box_interval_slack() - returns a bound of the error of hits near t in cells within these bounds.
 * The kernel of the cells must err by less than 2^-40 of the hit's t and of the t that it takes to
 * cross the bounds. */
static inline double box_interval_slack(const float bounds[6], const ray *r, double t) {
    double size = 0.0, fastest = 0.0;
    for (int a = 0; a < 3; a++) {
        size += (double)bounds[a + 3] - (double)bounds[a];
        fastest = fabs(r->d[a]) > fastest ? fabs(r->d[a]) : fastest;
    }
    return 0x1p-30 * (fabs(t) + size / fastest);
}

/* box_interval_behind() - returns a t with this property: a box within these bounds that the ray
 * leaves before t has no hit behind `after`. */
static inline double box_interval_behind(const float bounds[6], const ray *r, const hit *after) {
    return after->t - box_interval_slack(bounds, r, after->t);
}

#endif
