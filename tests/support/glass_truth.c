#include "tests/support/glass_truth.h"

#include <math.h>
#include <string.h>

typedef glass_real real;

real glass_dot(const real a[3], const real b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void glass_unit(real v[3]) {
    const real length = sqrtl(glass_dot(v, v));
    for (int a = 0; a < 3; a++)
        v[a] /= length;
}

/* ---- Laws ---- */

real glass_laws(const real d[3], const real normal[3], real ratio, real mirrored[3],
                real refracted[3]) {
    const real before = acosl(fminl(-glass_dot(d, normal), 1)), sine = ratio * sinl(before);
    real across[3];
    for (int a = 0; a < 3; a++) {
        mirrored[a] = d[a] - 2 * glass_dot(d, normal) * normal[a];
        across[a] = d[a] - glass_dot(d, normal) * normal[a];
    }
    if (sine >= 1)
        return 1;
    const real behind = asinl(sine);
    if (glass_dot(across, across) > 0)
        glass_unit(across);
    for (int a = 0; a < 3; a++)
        refracted[a] = sinl(behind) * across[a] - cosl(behind) * normal[a];
    if (before < 1e-6L)
        return (ratio - 1) * (ratio - 1) / ((ratio + 1) * (ratio + 1));
    const real s = sinl(before - behind) / sinl(before + behind),
               p = tanl(before - behind) / tanl(before + behind);
    return (s * s + p * p) / 2;
}

/* ---- Surfaces ---- */

typedef struct crossing {
    real t, out[3]; /* the normal that points out */
    real rgb[3];
    const leafcast_surface *look; /* NULL: of the wall */
} crossing;

/* The interval of t inside a glass_shape, and the normals at its ends. */
static bool inside(const glass_shape *s, const glass_ray *r, real t[2], real out[2][3]) {
    t[0] = -INFINITY;
    t[1] = INFINITY;
    if (s->faces == 0) {
        const real b = glass_dot(r->o, r->d),
                   square = b * b - glass_dot(r->o, r->o) + s->radius * s->radius;
        for (int i = 0; i < 2; i++) {
            t[i] = (i ? 1 : -1) * sqrtl(fmaxl(square, 0)) - b;
            for (int a = 0; a < 3; a++)
                out[i][a] = (r->o[a] + t[i] * r->d[a]) / s->radius;
        }
        return square > 0;
    }
    for (int k = 0; k < s->faces; k++) {
        const real slope = glass_dot(s->face[k], r->d),
                   at = (s->face[k][3] - glass_dot(s->face[k], r->o)) / slope;
        const int end = slope > 0;
        if (end ? at >= t[1] : at <= t[0])
            continue;
        t[end] = at;
        memcpy(out[end], s->face[k], sizeof out[end]);
    }
    return t[0] < t[1];
}

static bool wall_at(const glass_truth *w, const glass_ray *r, crossing *c) {
    real e[2][3], n[3], p[3], q[2][3];
    for (int a = 0; a < 3; a++) {
        e[0][a] = w->wall[1][a] - w->wall[0][a];
        e[1][a] = w->wall[2][a] - w->wall[0][a];
        p[a] = w->wall[0][a] - r->o[a];
    }
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, k = (a + 2) % 3;
        n[a] = e[0][b] * e[1][k] - e[0][k] * e[1][b];
    }
    c->t = glass_dot(p, n) / glass_dot(r->d, n);
    for (int a = 0; a < 3; a++)
        p[a] = r->o[a] + c->t * r->d[a] - w->wall[0][a];
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, k = (a + 2) % 3;
        q[0][a] = n[b] * e[0][k] - n[k] * e[0][b];
        q[1][a] = n[b] * e[1][k] - n[k] * e[1][b];
    }
    c->rgb[1] = glass_dot(p, q[1]) / glass_dot(e[0], q[1]);
    c->rgb[2] = glass_dot(p, q[0]) / glass_dot(e[1], q[0]);
    c->rgb[0] = 1 - c->rgb[1] - c->rgb[2];
    c->look = NULL;
    return c->rgb[0] > 0 && c->rgb[1] > 0 && c->rgb[2] > 0;
}

static bool is_there(const glass_shape *s, const glass_ray *r, real t) {
    return s->end == 0 ||
           (fabsl(r->o[0] + t * r->d[0]) < s->end && fabsl(r->o[1] + t * r->d[1]) < s->end);
}

/* The next surface behind t = from. */
static crossing next(const glass_truth *w, const glass_ray *r, real from) {
    crossing best = {.t = INFINITY}, c;
    if (wall_at(w, r, &c) && c.t > from)
        best = c;
    for (int i = 0; i < w->count; i++) {
        const leafcast_surface *look = &w->shapes[i].look;
        real t[2], out[2][3];
        if (!inside(&w->shapes[i], r, t, out))
            continue;
        for (int end = 0; end < 2; end++) {
            if (!(t[end] > from && t[end] < best.t) || !is_there(&w->shapes[i], r, t[end]))
                continue;
            best.t = t[end];
            best.look = look;
            memcpy(best.out, out[end], sizeof best.out);
            for (int a = 0; a < 3; a++)
                best.rgb[a] = look->rgb[a];
        }
    }
    return best;
}

static void see(const glass_truth *w, const glass_ray *r, int depth, int layers, real weight,
                real rgba[4]);

/* Follow a ray from a surface; add its share of all that it sees. */
static void follow(const glass_truth *w, const glass_ray *r, const crossing *c, const real to[3],
                   int depth, int layers, real weight, real share, real rgba[4]) {
    glass_ray on;
    real seen[4];
    for (int a = 0; a < 3; a++) {
        on.o[a] = r->o[a] + c->t * r->d[a];
        on.d[a] = to[a];
    }
    see(w, &on, depth, layers, weight, seen);
    for (int i = 0; i < 4; i++)
        rgba[i] += share * seen[i];
}

/* All that is seen along a ray, premultiplied, without the background. */
static void see(const glass_truth *w, const glass_ray *r, int depth, int layers, real weight,
                real rgba[4]) {
    real through = 1, from = 1e-9L;
    memset(rgba, 0, 4 * sizeof *rgba);
    while (through > w->least) {
        const crossing c = next(w, r, from);
        real mirrored[3], refracted[3], normal[3], share = 0, reflects = 0;
        if (!(c.t < INFINITY))
            return;
        from = c.t;
        layers++;
        const real opacity = c.look ? c.look->opacity : 1, clear = weight * through * (1 - opacity),
                   mirror = c.look ? weight * through * opacity * c.look->reflectivity : 0;
        const bool entering = glass_dot(c.out, r->d) < 0, turns = c.look && depth < w->bounces;
        const real index = c.look ? c.look->refraction : 0;
        const bool bends =
            turns && index > 0 && index != 1 && clear > w->least && layers != w->layers_max;
        for (int a = 0; a < 3; a++)
            normal[a] = entering ? c.out[a] : -c.out[a];
        if (turns)
            share = glass_laws(r->d, normal,
                               !bends     ? 1
                               : entering ? 1 / index
                                          : index,
                               mirrored, refracted);
        if (!bends)
            share = 0;
        else if (clear * (1 - share) <= w->least)
            share = 1;
        else if (mirror + clear * share <= w->least)
            share = 0;
        real behind[4] = {0}, own[4] = {0};
        if (turns && mirror + clear * share > w->least) {
            real seen[4] = {0};
            reflects = c.look->reflectivity;
            follow(w, r, &c, mirrored, depth + 1, 0, mirror + clear * share, 1, seen);
            for (int i = 0; i < 4; i++)
                behind[i] = share * seen[i];
            for (int i = 0; i < 3; i++)
                own[i] = seen[i] + (1 - seen[3]) * (real)w->background[3] * (real)w->background[i];
        }
        if (bends && share < 1)
            follow(w, r, &c, refracted, depth + 1, layers, clear * (1 - share), 1 - share, behind);
        for (int i = 0; i < 3; i++)
            rgba[i] += through * opacity * ((1 - reflects) * c.rgb[i] + reflects * own[i]);
        rgba[3] += through * opacity;
        for (int i = 0; i < 4; i++)
            rgba[i] += through * (1 - opacity) * behind[i];
        through *= 1 - opacity;
        if (bends || layers == w->layers_max)
            return;
    }
}

void glass_truth_pixel(const glass_truth *w, const glass_ray *r, real rgba[4]) {
    see(w, r, 0, 0, 1, rgba);
    const real left = (1 - rgba[3]) * (real)w->background[3];
    for (int i = 0; i < 3; i++)
        rgba[i] += left * (real)w->background[i];
    rgba[3] += left;
}
