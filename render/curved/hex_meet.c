#include "render/curved/hex_meet.h"

#include <math.h>
#include <string.h>

#include "formats/base/trilinear.h"
#include "formats/base/vec3.h"

/* A form's coefficients err by this share of their sum at most. */
#define ROUNDING  0x1p-48
#define ROOM      TRILINEAR_ROOM             /* what bounds of parameters may err by, */
#define ROOT_ROOM (TRILINEAR_STRETCH * ROOM) /* and a single root's, which bent forms move */
#define BEYOND    1.125  /* roots are single in a box that is larger by this factor */
#define NARROWEST 0x1p-4 /* sides of boxes, each relative to that of the one before; */
#define WORTH     0.5    /* and their content: larger ones are not worth a look */
enum { BOXES = 4 };

/* Newton's method, to a step whose square is below rounding. False: it leaves the box, or takes
 * long. */
static bool find(const double f[3][HEX_CORNERS], double isovalue, const double middle[3],
                 const double half[3], double x[3]) {
    enum { STEPS = 8 };
    for (int n = 0; n < STEPS; n++) {
        double slope[3][3], column[3][3], off[3], most = 0.0;
        for (int k = 0; k < 3; k++) {
            off[k] = trilinear_at(f[k], x);
            trilinear_slope(f[k], x, slope[k]);
        }
        off[2] -= isovalue;
        (void)trilinear_invert(slope, column);
        for (int i = 0; i < 3; i++) {
            const double by =
                (column[0][i] * off[0] + column[1][i] * off[1]) + column[2][i] * off[2];
            x[i] -= by;
            most = real_max(most, fabs(by));
            if (!(fabs(x[i] - middle[i]) <= BEYOND * half[i]))
                return false;
        }
        if (most <= 0x1p-33)
            return true;
    }
    return false;
}

/* The number of roots, 0 or 1; -1: not known. Boxes become smaller until one has none, or a single
 * one, which is found. */
static int single_root(const hex_meet *m, double isovalue, hex_root *out) {
    double f[3][HEX_CORNERS], rounding[3], middle[3] = {0.0, 0.0, 0.0}, half[3] = {1.0, 1.0, 1.0};
    double x[3], most = 0.0;
    trilinear_bend b;
    memcpy(f, m->form, sizeof f);
    for (int k = 0; k < 3; k++)
        rounding[k] = ROUNDING * (trilinear_size(f[k]) + (k == 2 ? fabs(isovalue) : 0.0));
    f[2][0] -= isovalue;
    for (int n = 1;; n++) {
        double part[3], width[3];
        if (!trilinear_bend_of(f, rounding, &b))
            return -1;
        for (int i = 0; i < 3; i++) {
            const double rest = ((b.two[0][i] + b.two[1][i]) + b.two[2][i]) + b.all[i];
            const double stray = rest + ROOM * (1.0 + rest + fabs(b.at[i]));
            const double lo = real_max(b.at[i] - stray, -1.0);
            const double hi = real_min(b.at[i] + stray, 1.0);
            if (lo > hi)
                return 0;
            part[i] = 0.5 * (hi + lo);
            width[i] = real_max(0.5 * (hi - lo), NARROWEST);
            x[i] = middle[i] + half[i] * real_min(real_max(-1.0, b.at[i]), 1.0);
        }
        if (trilinear_is_single(&b, BEYOND) && find(m->form, isovalue, middle, half, x))
            break;
        if (n == BOXES || width[0] * width[1] * width[2] > WORTH)
            return -1;
        for (int k = 0; k < 3; k++)
            trilinear_restrict(f[k], part, width);
        for (int i = 0; i < 3; i++) {
            middle[i] += half[i] * part[i];
            half[i] *= width[i];
        }
    }
    for (int i = 0; i < 3; i++) {
        most = real_max(most, fabs(x[i]));
        out->at[i] = 0.5 + 0.5 * x[i];
    }
    if (most > 1.0 - ROOT_ROOM)
        return most < 1.0 + ROOT_ROOM ? -1 : 0;
    out->t = hexahedron_at(m->q[2], out->at);
    out->entering = (b.det > 0.0) == (m->sense * m->ray->sense > 0);
    return 1;
}

/* ---- A cell ---- */

void hex_meet_begin(const hexahedron *cell, int sense, const sheared_ray *sheared, hex_meet *out) {
    out->cell = cell;
    out->ray = sheared;
    out->sense = sense;
    for (int c = 0; c < HEX_CORNERS; c++) {
        double q[3];
        sheared_ray_place(sheared, cell->p[c], q);
        for (int a = 0; a < 3; a++)
            out->q[a][c] = q[a];
    }
    trilinear_of(out->q[0], out->form[0]);
    trilinear_of(out->q[1], out->form[1]);
    trilinear_of(cell->value, out->form[2]);
}

int hex_meet_roots(const hex_meet *m, double isovalue, hex_root out[HEX_ROOTS],
                   hex_counts *counts) {
    hex_path path;
    const int single = m->sense != 0 ? single_root(m, isovalue, out) : -1;
    if (single >= 0)
        return single;
    if (hex_path_of(m->cell, m->sense, m->ray, &path) == 0)
        return 0;
    return hex_roots(m->cell, m->sense, &path, isovalue, out, counts);
}
