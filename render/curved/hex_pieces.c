#include "render/curved/hex_pieces.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "formats/curved/hex_open.h"
#include "formats/curved/hex_stretch.h"

/* ---- Polynomials: coefficients times binomials, so that products are convolutions ---- */

enum { CUBIC = 3, WHOLE = 9 };

static const double binomials[4][WHOLE - CUBIC + 1] = {
    {1.0}, {1.0, 3.0, 3.0, 1.0}, {0.0}, {1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0}};
static const double whole_binomials[WHOLE + 1] = {1.0,   9.0,  36.0, 84.0, 126.0,
                                                  126.0, 84.0, 36.0, 9.0,  1.0};

/* out = x y, of degrees m and n. */
static void multiply(const double *x, int m, const double *y, int n, double *out) {
    memset(out, 0, (size_t)(m + n + 1) * sizeof *out);
    for (int i = 0; i <= m; i++)
        for (int k = 0; k <= n; k++)
            out[i + k] += x[i] * y[k];
}

/* The products of the three parameters' distances from a point, each of degree 9: first, second,
 * third; second x third, third x first, first x second; all three. */
typedef struct products {
    double single[3][WHOLE + 1], pair[3][WHOLE + 1], all[WHOLE + 1];
} products;

static void multiply_all(const double cubic[3][CUBIC + 1], products *out) {
    double scaled[3][CUBIC + 1], two[2 * CUBIC + 1];
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i <= CUBIC; i++)
            scaled[a][i] = cubic[a][i] * binomials[1][i];
        multiply(scaled[a], CUBIC, binomials[3], 2 * CUBIC, out->single[a]);
    }
    for (int a = 0; a < 3; a++) {
        multiply(scaled[(a + 1) % 3], CUBIC, scaled[(a + 2) % 3], CUBIC, two);
        multiply(two, 2 * CUBIC, binomials[1], CUBIC, out->pair[a]);
    }
    multiply(two, 2 * CUBIC, scaled[2], CUBIC, out->all); /* two: first x second */
}

/* A trilinear form of the parameters, about a point, as a polynomial of degree 9. */
static void compose(const double v[HEX_CORNERS], const double at[3], const products *p,
                    double out[WHOLE + 1]) {
    const double middle = hexahedron_at(v, at);
    double slope[3], twist[3];
    const double all = hexahedron_twist(v, at, twist);
    hexahedron_slope(v, at, slope);
    for (int i = 0; i <= WHOLE; i++) {
        out[i] = middle * whole_binomials[i] + all * p->all[i];
        for (int a = 0; a < 3; a++)
            out[i] += slope[a] * p->single[a][i] + twist[a] * p->pair[a][i];
    }
}

static double most_of(const double polynomial[WHOLE + 1]) {
    double most = 0.0;
    for (int i = 0; i <= WHOLE; i++)
        most = real_max(most, fabs(polynomial[i]) / whole_binomials[i]);
    return most;
}

/* The cubic through four values that are a third apart. */
static void through(const double f[4], double b[CUBIC + 1]) {
    b[0] = f[0];
    b[1] = (-5.0 * f[0] + 18.0 * f[1] - 9.0 * f[2] + 2.0 * f[3]) / 6.0;
    b[2] = (2.0 * f[0] - 9.0 * f[1] + 18.0 * f[2] - 5.0 * f[3]) / 6.0;
    b[3] = f[3];
}

/* ---- Pieces ---- */

typedef struct search {
    hex_opened cell;
    double tolerance, range;
    hex_piece *out;
    int count, room; /* room: pieces that may still come of halving */
    hex_counts counts;
} search;

/* By how much at most the parameters differ from their guess. Of the map the guess makes a
 * polynomial that should be t. */
static void guess_error(const hex_stretch *s, const products *p, const double t[2],
                        double error[3]) {
    double most = 0.0, contraction = 0.0;
    for (int i = 0; i < 3; i++) {
        double off[WHOLE + 1];
        compose(s->straight[i], s->at, p, off);
        for (int k = 0; k <= WHOLE; k++)
            off[k] -= s->rate[i] * (t[0] + (t[1] - t[0]) * k / WHOLE) * whole_binomials[k];
        error[i] = most_of(off);
        for (int c = 0; c < HEX_CORNERS; c++)
            error[i] += 0x1p-48 * fabs(s->straight[i][c]);
        most = real_max(most, error[i]);
        contraction = real_max(contraction, s->apart[i]);
    }
    for (int i = 0; i < 3; i++)
        error[i] += s->apart[i] * most / (1.0 - contraction);
}

/* One cubic for the whole stretch. Returns a bound of its error. */
static double fit(const search *f, const hex_stretch *s, const hex_end *from, const hex_end *to,
                  hex_piece *out) {
    const double t[2] = {from->t, to->t};
    double value[4] = {from->value, 0.0, 0.0, to->value}, at[4][3], cubic[3][CUBIC + 1];
    for (int a = 0; a < 3; a++) {
        at[0][a] = from->at[a];
        at[3][a] = to->at[a];
        at[1][a] = s->at[a] - s->rate[a] * s->half / 3.0;
        at[2][a] = s->at[a] + s->rate[a] * s->half / 3.0;
    }
    for (int k = 1; k < 3; k++) {
        if (!hex_stretch_locate(f->cell.q, t[0] + (t[1] - t[0]) * k / 3.0, at[k]))
            return INFINITY;
        value[k] = hexahedron_at(f->cell.value, at[k]);
    }
    for (int a = 0; a < 3; a++) {
        const double off[4] = {at[0][a] - s->at[a], at[1][a] - s->at[a], at[2][a] - s->at[a],
                               at[3][a] - s->at[a]};
        through(off, cubic[a]);
        for (int k = 0; k <= CUBIC; k++) /* the bounds hold in the stretch's box */
            if (!(fabs(cubic[a][k]) <= s->reach[a]))
                return INFINITY;
    }
    through(value, out->b);
    out->t[0] = t[0];
    out->t[1] = t[1];
    products p;
    double wrong[3], curve[WHOLE + 1], own[WHOLE + 1], scaled[CUBIC + 1], steepest[3];
    multiply_all((const double(*)[CUBIC + 1]) cubic, &p);
    guess_error(s, &p, t, wrong);
    compose(f->cell.value, s->at, &p, curve);
    for (int i = 0; i <= CUBIC; i++)
        scaled[i] = out->b[i] * binomials[1][i];
    multiply(scaled, CUBIC, binomials[3], 2 * CUBIC, own);
    for (int i = 0; i <= WHOLE; i++)
        curve[i] -= own[i];
    double error = most_of(curve);
    hex_stretch_steepest(s, f->cell.value, steepest);
    for (int i = 0; i < 3; i++)
        error += steepest[i] * wrong[i];
    for (int c = 0; c < HEX_CORNERS; c++)
        error += 0x1p-48 * fabs(f->cell.value[c]);
    return error;
}

static hex_piece linear(const hex_end *from, const hex_end *to, double error) {
    const double third = (to->value - from->value) / 3.0;
    return (hex_piece){
        {from->t, to->t}, {from->value, from->value + third, to->value - third, to->value}, error};
}

static bool look(void *ctx, const hex_end *from, const hex_end *to, int depth, hex_end *middle) {
    search *f = ctx;
    hex_stretch s;
    hex_piece piece = {{from->t, to->t}, {0.0}, INFINITY};
    bool located = false;
    f->counts.stretches++;
    if (hex_stretch_of(f->cell.q, from, to, &s, &located))
        piece.error = fit(f, &s, from, to, &piece);
    if (!(piece.error <= f->tolerance) && located && depth < HEX_DEPTH && f->room > 0 &&
        hex_stretch_middle(&s, f->cell.value, from, to, middle)) {
        f->room--;
        return true;
    }
    if (!(piece.error <= f->range))
        piece = linear(from, to, f->range);
    f->counts.doubtful += !(piece.error <= f->tolerance);
    f->out[f->count++] = piece;
    return false;
}

int hex_pieces(const hexahedron *h, int sense, const hex_path *path, double tolerance,
               hex_piece out[HEX_PIECES], hex_counts *counts) {
    search f = {.tolerance = tolerance, .out = out};
    double range[2] = {INFINITY, -INFINITY};
    for (int c = 0; c < HEX_CORNERS; c++) {
        range[0] = real_min(range[0], h->value[c]);
        range[1] = real_max(range[1], h->value[c]);
    }
    f.range = range[1] - range[0];
    hex_open(h, path, &f.cell);
    f.room = HEX_PIECES - path->count;
    for (int i = 0; i < path->count; i++) {
        hex_part part = path->part[i];
        if (!(part.end[0].t < part.end[1].t))
            continue;
        for (int k = 0; k < 2; k++)
            hex_open_into(&f.cell, part.end[k].at);
        if (sense != 0)
            hex_part_walk(&part, look, &f);
        else
            out[f.count++] = linear(&part.end[0], &part.end[1], 0.0);
    }
    if (counts) {
        counts->paths += (uint64_t)path->count;
        counts->stretches += f.counts.stretches;
        counts->doubtful += f.counts.doubtful;
    }
    return f.count;
}
