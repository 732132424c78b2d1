/* heights_patch.h - where a ray meets the bilinear patch over a cell of terrain: the kernel that
 * decides, for single rays.
 *
 * Grid space has the lattice along axes 0 and 2, and the elevation along axis 1. On the ray's way
 * over the cell, f = height of the patch - elevation of the ray is a quadratic polynomial in t. Its
 * ends are taken on the planes of the lattice that the ray crosses: there f is the linear form of
 * the plane's two nodes, at the plane's own t, computed alike from both sides. So the end of one
 * cell is the start of the next, to the bit, and no ray slips through. The ray is inside, below the
 * terrain, where f >= 0. Where the sides of the ends differ there is one root. Else only an
 * extremum between them can reveal two.
 *
 * The way is cut to where the ray's elevation is that of the cell, and a margin more than rounding.
 * Beyond, the side is certain. So steep and vertical rays need no other rules.
 *
 * A cell owns [i, i + 1) on each axis. Where a ray passes a node, it crosses axis 0 first.
 */
#ifndef RENDER_HEIGHTS_HEIGHTS_PATCH_H
#define RENDER_HEIGHTS_HEIGHTS_PATCH_H

#include <float.h>

#include "render/ray/ray.h"

typedef struct heights_patch {
    double x, z;          /* its first node */
    double size, inverse; /* edge of the cell; 1 / size, a power of two */
    double h[4];          /* heights at (x, z), (x + size, z), (x, z + size), both */
} heights_patch;

typedef struct heights_root {
    double t;
    bool entering; /* comes from above */
} heights_root;

static inline double heights_least(double a, double b) {
    return a < b ? a : b;
}
static inline double heights_most(double a, double b) {
    return a > b ? a : b;
}

/* heights_patch_at() - the height at (u, v) of the unit square. On an edge it is exactly the linear
 * form of the edge's nodes. */
static inline double heights_patch_at(const double h[4], double u, double v) {
    const double first = h[0] * (1.0 - u) + h[1] * u, last = h[2] * (1.0 - u) + h[3] * u;
    return first * (1.0 - v) + last * v;
}

/* heights_patch_slope() - how steeply it rises: axis 0, along u at v (other); 1, along v at u. */
static inline double heights_patch_slope(const heights_patch *p, int axis, double other) {
    const double *h = p->h;
    const int across = axis ? 2 : 1, along = axis ? 1 : 2;
    return ((h[across] - h[0]) * (1.0 - other) + (h[3] - h[along]) * other) * p->inverse;
}

/* heights_margin() - how far beyond the least and the greatest height the side of a ray that starts
 * at elevation `from` is certain. */
static inline double heights_margin(double least, double most, double from) {
    return 0x1p-10 * (most - least) + 0x1p-40 * (fabs(least) + fabs(most) + fabs(from)) + 0x1p-900;
}

/* A place on the ray's way, relative to a cell. */
static inline double heights_share(double o, double d, double t, double first, double inverse) {
    const double at = (o + t * d - first) * inverse;
    return heights_least(heights_most(at, 0.0), 1.0);
}

/* heights_meets() - whether the ray's elevation between two t may be in a range. */
static inline bool heights_meets(const ray *r, double t_in, double t_out, double least,
                                 double most) {
    const double a = r->o[1] + t_in * r->d[1], b = r->o[1] + t_out * r->d[1];
    const double slack =
        0x1p-48 * (fabs(r->o[1]) + heights_most(fabs(a), fabs(b)) + fabs(least) + fabs(most));
    return !(heights_least(a, b) > most + slack || heights_most(a, b) < least - slack);
}

/* The one root in [0, 1] of c + b s + a s^2, which rises from c < 0, or from c = 0 downwards first,
 * to a value >= 0. */
static inline double heights_rise(double a, double b, double c) {
    const double square = b * b - 4.0 * a * c, root = sqrt(heights_most(square, 0.0));
    if (b >= 0.0)
        return b + root > 0.0 ? -2.0 * c / (b + root) : 0.0;
    return a > 0.0 ? (root - b) / (2.0 * a) : 1.0;
}

/* The planes of one axis: sets the t at which the ray enters and leaves them. False: it is beside
 * them. */
static inline bool heights_planes(const ray *r, int axis, double first, double size, double *in,
                                  double *out) {
    const double d = r->d[axis], o = r->o[axis];
    if (d == 0.0) {
        *in = -INFINITY;
        *out = INFINITY;
        return first <= r->held[axis] && r->held[axis] < first + size;
    }
    const double near = d < 0.0 ? first + size : first, far = d < 0.0 ? first : first + size;
    *in = (near - o) / d;
    *out = (far - o) / d;
    return true;
}

/* heights_patch_roots() - the roots on the whole line of the ray, in order; returns how many. */
static inline int heights_patch_roots(const heights_patch *p, const ray *r, heights_root out[2]) {
    double in[3], to[3];
    if (!heights_planes(r, 0, p->x, p->size, &in[0], &to[0]) ||
        !heights_planes(r, 2, p->z, p->size, &in[2], &to[2]))
        return 0;
    /* Refuse cells that the ray does not visit; at a node it crosses axis 0 first. */
    if (!(in[0] <= to[2] && in[2] < to[0]))
        return 0;
    /* Cut the way to the cell's elevations. */
    const double least =
        heights_least(heights_least(p->h[0], p->h[1]), heights_least(p->h[2], p->h[3]));
    const double most =
        heights_most(heights_most(p->h[0], p->h[1]), heights_most(p->h[2], p->h[3]));
    const double margin = heights_margin(least, most, r->o[1]);
    const double bottom = least - margin, top = most + margin, rise = r->d[1];
    if (rise == 0.0 && (r->o[1] < bottom || r->o[1] > top))
        return 0;
    in[1] = rise == 0.0 ? -INFINITY : ((rise < 0.0 ? top : bottom) - r->o[1]) / rise;
    to[1] = rise == 0.0 ? INFINITY : ((rise < 0.0 ? bottom : top) - r->o[1]) / rise;
    const double t_in = heights_most(heights_most(in[0], in[2]), in[1]);
    const double t_out = heights_least(heights_least(to[0], to[2]), to[1]);
    if (!(t_in <= t_out))
        return 0;
    /* Take f at both ends: on a plane of the lattice exactly there. */
    double u[2], v[2], f[2];
    const double ends[2] = {t_in, t_out};
    for (int e = 0; e < 2; e++) {
        const double *planes = e ? to : in, t = ends[e];
        const bool on_x = planes[0] == t, on_z = planes[2] == t;
        /* At a node the plane of axis 2 is crossed last on the way in, that of axis 0 first out. */
        const bool by_z = on_z && (!on_x || e == 0), by_x = on_x && !by_z;
        u[e] = by_x ? ((r->d[0] < 0.0) == (e == 0) ? 1.0 : 0.0)
                    : heights_share(r->o[0], r->d[0], t, p->x, p->inverse);
        v[e] = by_z ? ((r->d[2] < 0.0) == (e == 0) ? 1.0 : 0.0)
                    : heights_share(r->o[2], r->d[2], t, p->z, p->inverse);
        f[e] = heights_patch_at(p->h, u[e], v[e]) - (r->o[1] + t * rise);
    }
    /* Find the roots of f(0) + b s + a s^2, s from 0 to 1; for a ray from inside, of -f. */
    const double sign = f[0] < 0.0 ? 1.0 : -1.0;
    const double twist = (p->h[3] - p->h[2]) - (p->h[1] - p->h[0]);
    const double a = sign * twist * (u[1] - u[0]) * (v[1] - v[0]), c = sign * f[0];
    const double b = sign * (f[1] - f[0]) - a, width = t_out - t_in;
    double s[2];
    int count = 0;
    if ((f[0] < 0.0) != (f[1] < 0.0)) {
        s[count++] = heights_rise(a, b, c);
    } else {
        const double square = b * b - 4.0 * a * c;
        if (!(a < 0.0 && b > 0.0 && b < -2.0 * a && square > 0.0))
            return 0;
        const double both = b + sqrt(square);
        s[count++] = -2.0 * c / both;
        s[count++] = both / (-2.0 * a);
    }
    for (int i = 0; i < count; i++) {
        const double share = heights_least(heights_most(s[i], 0.0), 1.0);
        out[i].t = heights_least(t_in + share * width, t_out);
        out[i].entering = (f[0] < 0.0) == (i == 0);
    }
    return count;
}

#endif
