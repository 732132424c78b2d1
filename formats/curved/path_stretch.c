#include "formats/curved/path_stretch.h"

#include <math.h>

#include "formats/base/vec3.h"

#define WIDEN 0x1p-40 /* bounds are wider than computed by this, relative to their terms */
#define ROOM  1.125   /* boxes are larger than needed by this factor */

/* The inverse of three slopes: column k is the change of parameters that changes value k by 1. */
static bool invert(const double slope[3][3], double column[3][3]) {
    for (int k = 0; k < 3; k++)
        vec3_cross(slope[(k + 1) % 3], slope[(k + 2) % 3], column[k]);
    const double det = vec3_dot(slope[0], column[0]);
    if (!(fabs(det) > 0.0))
        return false;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            column[k][i] /= det;
    return isfinite(vec3_size(column[0]) + vec3_size(column[1]) + vec3_size(column[2]));
}

/* By how much the computed value of a form may be wrong. */
static double rounding_of(const cell_form *f, const double *v) {
    double most = 0.0;
    for (int c = 0; c < f->count; c++)
        most = real_max(most, fabs(v[c]));
    return 0x1p-50 * most;
}

/* How far the parameters may be from where three values are as they should be. */
static double distance(const double column[3][3], const double off[3], int i) {
    return fabs(column[0][i]) * off[0] + fabs(column[1][i]) * off[1] + fabs(column[2][i]) * off[2];
}

/* Newton's method for three values that are to be aim[]. It may leave the cell a little
 * on its way. It ends where rounding alone decides the next step. */
static bool newton(const cell_form *f, const double *const v[3], const double aim[3],
                   double at[3]) {
    enum { STEPS = 24 };
    const double beyond = 0.25;
    double rounding[3];
    for (int k = 0; k < 3; k++)
        rounding[k] = rounding_of(f, v[k]) + 0x1p-53 * fabs(aim[k]);
    for (int n = 0; n < STEPS; n++) {
        double slope[3][3], column[3][3], miss[3];
        bool still = true;
        for (int k = 0; k < 3; k++) {
            miss[k] = aim[k] - f->at(v[k], at);
            f->slope(v[k], at, slope[k]);
        }
        if (!invert(slope, column))
            return false;
        for (int i = 0; i < 3; i++) {
            const double by =
                miss[0] * column[0][i] + miss[1] * column[1][i] + miss[2] * column[2][i];
            at[i] = real_min(real_max(-beyond, at[i] + by), 1.0 + beyond);
            still = still && fabs(by) <= 0x1p-52 + distance(column, rounding, i);
        }
        if (still)
            return true;
    }
    return false;
}

bool path_stretch_locate(const curved_map *m, double t, double at[3]) {
    return newton(m->form, (const double *const[3]){m->q[0], m->q[1], m->q[2]},
                  (double[3]){0.0, 0.0, t}, at);
}

/* How much the slopes of a value can differ from those in the middle of a box. */
static void unevenness(const cell_form *f, const double *v, const double at[3],
                       const double reach[3], double out[3]) {
    double twist[3], square[3];
    const double all = fabs(f->twist(v, at, twist, square));
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        out[a] = fabs(twist[c]) * reach[b] + fabs(twist[b]) * reach[c] + all * reach[b] * reach[c] +
                 2.0 * fabs(square[a]) * reach[a];
    }
}

/* The map times the inverse Jacobian in the middle; returns by how much that may be wrong. It is
 * multiplied first and bounded then: in a flat cell the inverse is large, but not what it makes of
 * how the cell is bent. */
static double straighten(const curved_map *m, const double column[3][3],
                         double straight[3][FORM_MOST]) {
    double rounding = 0.0;
    for (int i = 0; i < 3; i++) {
        double size = 0.0;
        for (int c = 0; c < m->form->count; c++)
            straight[i][c] =
                m->q[0][c] * column[0][i] + m->q[1][c] * column[1][i] + m->q[2][c] * column[2][i];
        for (int k = 0; k < 3; k++)
            size += 16.0 * rounding_of(m->form, m->q[k]) * fabs(column[k][i]);
        rounding = real_max(rounding, size);
    }
    return rounding;
}

/* By how much at most the straightened map's Jacobian in a box differs from 1. */
static void difference(const path_stretch *s, double rounding, double out[3][3]) {
    for (int i = 0; i < 3; i++) {
        unevenness(s->form, s->straight[i], s->at, s->reach, out[i]);
        for (int j = 0; j < 3; j++)
            out[i][j] += rounding + WIDEN;
    }
}

/* Krawczyk's operator maps the box about the middle into itself, once the box is large enough.
 * off: how far the parameters in the middle may be from the ray. Sets reach[], and apart[][] for
 * it. False: it does not. */
static bool prove(path_stretch *s, const double off[3], double rounding, double apart[3][3]) {
    enum { TRIES = 4 };
    for (int n = 0; n <= TRIES && vec3_size(s->reach) < 3.0; n++) {
        double image[3];
        bool proven = true;
        difference(s, rounding, apart);
        for (int i = 0; i < 3; i++) {
            image[i] = fabs(s->rate[i]) * s->half + vec3_dot(apart[i], s->reach) + off[i] + WIDEN;
            proven = proven && image[i] <= s->reach[i];
        }
        /* With room for what is near the stretch, such as a guess. Until then only what was too
         * small grows: all else would pull it along. */
        for (int i = 0; i < 3; i++)
            if (proven || image[i] > s->reach[i])
                s->reach[i] = ROOM * image[i];
        if (proven) {
            difference(s, rounding, apart);
            return true;
        }
    }
    return false;
}

/* The rate in the box is the rate in the middle and `apart` times the rate in the box, at most: a
 * geometric series. */
static bool bound_rate(path_stretch *s, const double apart[3][3]) {
    const double size[3] = {fabs(s->rate[0]), fabs(s->rate[1]), fabs(s->rate[2])};
    double most = 0.0, stray = 0.0;
    for (int i = 0; i < 3; i++) {
        s->spread[i] = vec3_dot(apart[i], size);
        s->apart[i] = apart[i][0] + apart[i][1] + apart[i][2];
        most = real_max(most, s->apart[i]);
        stray = real_max(stray, s->spread[i]);
    }
    for (int i = 0; i < 3; i++)
        s->spread[i] += s->apart[i] * stray / (1.0 - most) + WIDEN * size[i];
    return most < 0.875;
}

bool path_stretch_of(const curved_map *m, const path_end *from, const path_end *to,
                     path_stretch *out, bool *located) {
    const double aim[3] = {0.0, 0.0, 0.5 * (from->t + to->t)};
    double slope[3][3], column[3][3], apart[3][3], miss[3], off[3];
    out->form = m->form;
    out->half = 0.5 * (to->t - from->t);
    for (int i = 0; i < 3; i++)
        out->at[i] = 0.5 * (from->at[i] + to->at[i]);
    *located = path_stretch_locate(m, aim[2], out->at);
    if (!*located)
        return false;
    for (int k = 0; k < 3; k++) {
        m->form->slope(m->q[k], out->at, slope[k]);
        miss[k] = fabs(m->form->at(m->q[k], out->at) - aim[k]) + rounding_of(m->form, m->q[k]);
    }
    if (!invert(slope, column))
        return false;
    for (int i = 0; i < 3; i++) {
        const double far = real_max(fabs(from->at[i] - out->at[i]), fabs(to->at[i] - out->at[i]));
        out->rate[i] = column[2][i];
        out->reach[i] = ROOM * real_max(far, fabs(column[2][i]) * out->half) + WIDEN;
        off[i] = distance(column, miss, i);
    }
    const double rounding = straighten(m, column, out->straight);
    return prove(out, off, rounding, apart) && bound_rate(out, apart);
}

bool path_stretch_middle(const path_stretch *s, const double *v, const path_end *from,
                         const path_end *to, path_end *middle) {
    *middle =
        (path_end){0.5 * (from->t + to->t), {s->at[0], s->at[1], s->at[2]}, s->form->at(v, s->at)};
    return middle->t > from->t && middle->t < to->t;
}

double path_stretch_slope(const path_stretch *s, const double *v, double *error) {
    double slope[3], uneven[3], sum = 0.0;
    s->form->slope(v, s->at, slope);
    unevenness(s->form, v, s->at, s->reach, uneven);
    *error = 0.0;
    for (int i = 0; i < 3; i++) {
        sum += slope[i] * s->rate[i];
        *error += (fabs(slope[i]) + uneven[i]) * s->spread[i] +
                  (uneven[i] + WIDEN * fabs(slope[i])) * fabs(s->rate[i]);
    }
    return sum;
}

void path_stretch_steepest(const path_stretch *s, const double *v, double steepest[3]) {
    double slope[3], uneven[3];
    s->form->slope(v, s->at, slope);
    unevenness(s->form, v, s->at, s->reach, uneven);
    for (int i = 0; i < 3; i++)
        steepest[i] = fabs(slope[i]) + uneven[i];
}

bool path_stretch_solve(const curved_map *m, const double *v, const path_stretch *s, double at[3]) {
    if (!newton(m->form, (const double *const[3]){m->q[0], m->q[1], v}, (double[3]){0.0, 0.0, 0.0},
                at))
        return false;
    for (int i = 0; i < 3; i++)
        if (!(fabs(at[i] - s->at[i]) <= s->reach[i] + WIDEN))
            return false;
    return true;
}
