#include "render/curved/path_pieces.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "formats/curved/path_stretch.h"

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
 * third; second x third, third x first, first x second; each twice; all three. */
typedef struct products {
    double single[3][WHOLE + 1], pair[3][WHOLE + 1], square[3][WHOLE + 1], all[WHOLE + 1];
} products;

static void multiply_all(const double cubic[3][CUBIC + 1], bool squares, products *out) {
    double scaled[3][CUBIC + 1], two[2 * CUBIC + 1];
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i <= CUBIC; i++)
            scaled[a][i] = cubic[a][i] * binomials[1][i];
        multiply(scaled[a], CUBIC, binomials[3], 2 * CUBIC, out->single[a]);
    }
    for (int a = 0; a < 3 && squares; a++) {
        multiply(scaled[a], CUBIC, scaled[a], CUBIC, two);
        multiply(two, 2 * CUBIC, binomials[1], CUBIC, out->square[a]);
    }
    for (int a = 0; a < 3; a++) {
        multiply(scaled[(a + 1) % 3], CUBIC, scaled[(a + 2) % 3], CUBIC, two);
        multiply(two, 2 * CUBIC, binomials[1], CUBIC, out->pair[a]);
    }
    multiply(two, 2 * CUBIC, scaled[2], CUBIC, out->all); /* two: first x second */
}

/* A form of the parameters, about a point, as a polynomial of degree 9. */
static void compose(const cell_form *f, const double *v, const double at[3], const products *p,
                    double out[WHOLE + 1]) {
    const double middle = f->at(v, at);
    double slope[3], twist[3], square[3];
    const double all = f->twist(v, at, twist, square);
    f->slope(v, at, slope);
    for (int i = 0; i <= WHOLE; i++) {
        out[i] = middle * whole_binomials[i] + all * p->all[i];
        for (int a = 0; a < 3; a++)
            out[i] += slope[a] * p->single[a][i] + twist[a] * p->pair[a][i];
        for (int a = 0; a < 3 && f->squares; a++)
            out[i] += square[a] * p->square[a][i];
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
    const curved_map *map;
    double tolerance, range;
    path_piece *out;
    int count, room; /* room: pieces that may still come of halving */
    path_counts counts;
} search;

/* By how much at most the parameters differ from their guess. Of the map the guess makes a
 * polynomial that should be t. */
static void guess_error(const path_stretch *s, const products *p, const double t[2],
                        double error[3]) {
    double most = 0.0, contraction = 0.0;
    for (int i = 0; i < 3; i++) {
        double off[WHOLE + 1];
        compose(s->form, s->straight[i], s->at, p, off);
        for (int k = 0; k <= WHOLE; k++)
            off[k] -= s->rate[i] * (t[0] + (t[1] - t[0]) * k / WHOLE) * whole_binomials[k];
        error[i] = most_of(off);
        for (int c = 0; c < s->form->count; c++)
            error[i] += 0x1p-48 * fabs(s->straight[i][c]);
        most = real_max(most, error[i]);
        contraction = real_max(contraction, s->apart[i]);
    }
    for (int i = 0; i < 3; i++)
        error[i] += s->apart[i] * most / (1.0 - contraction);
}

/* One cubic for the whole stretch. Returns a bound of its error. */
static double fit(const search *f, const path_stretch *s, const path_end *from, const path_end *to,
                  path_piece *out) {
    const double t[2] = {from->t, to->t};
    double value[4] = {from->value, 0.0, 0.0, to->value}, at[4][3], cubic[3][CUBIC + 1];
    for (int a = 0; a < 3; a++) {
        at[0][a] = from->at[a];
        at[3][a] = to->at[a];
        at[1][a] = s->at[a] - s->rate[a] * s->half / 3.0;
        at[2][a] = s->at[a] + s->rate[a] * s->half / 3.0;
    }
    for (int k = 1; k < 3; k++) {
        if (!path_stretch_locate(f->map, t[0] + (t[1] - t[0]) * k / 3.0, at[k]))
            return INFINITY;
        value[k] = s->form->at(f->map->value, at[k]);
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
    multiply_all((const double(*)[CUBIC + 1]) cubic, s->form->squares, &p);
    guess_error(s, &p, t, wrong);
    compose(s->form, f->map->value, s->at, &p, curve);
    for (int i = 0; i <= CUBIC; i++)
        scaled[i] = out->b[i] * binomials[1][i];
    multiply(scaled, CUBIC, binomials[3], 2 * CUBIC, own);
    for (int i = 0; i <= WHOLE; i++)
        curve[i] -= own[i];
    double error = most_of(curve);
    path_stretch_steepest(s, f->map->value, steepest);
    for (int i = 0; i < 3; i++)
        error += steepest[i] * wrong[i];
    for (int c = 0; c < s->form->count; c++)
        error += 0x1p-48 * fabs(f->map->value[c]);
    return error;
}

static path_piece linear(const path_end *from, const path_end *to, double error) {
    const double third = (to->value - from->value) / 3.0;
    return (path_piece){
        {from->t, to->t}, {from->value, from->value + third, to->value - third, to->value}, error};
}

static bool look(void *ctx, const path_end *from, const path_end *to, int depth, path_end *middle) {
    search *f = ctx;
    path_stretch s;
    path_piece piece = {{from->t, to->t}, {0.0}, INFINITY};
    bool located = false;
    f->counts.stretches++;
    if (path_stretch_of(f->map, from, to, &s, &located))
        piece.error = fit(f, &s, from, to, &piece);
    if (!(piece.error <= f->tolerance) && located && depth < PATH_DEPTH && f->room > 0 &&
        path_stretch_middle(&s, f->map->value, from, to, middle)) {
        f->room--;
        return true;
    }
    if (!(piece.error <= f->range))
        piece = linear(from, to, f->range);
    f->counts.doubtful += !(piece.error <= f->tolerance);
    f->out[f->count++] = piece;
    return false;
}

int path_pieces(const curved_map *m, const path_part *parts, int part_count, bool folded,
                const double range[2], double tolerance, path_piece out[PATH_PIECES],
                path_counts *counts) {
    search f = {.map = m,
                .tolerance = tolerance,
                .range = range[1] - range[0],
                .out = out,
                .room = PATH_PIECES - part_count};
    for (int i = 0; i < part_count; i++) {
        const path_part *part = &parts[i];
        if (!(part->end[0].t < part->end[1].t))
            continue;
        if (!folded)
            path_part_walk(part, look, &f);
        else
            out[f.count++] = linear(&part->end[0], &part->end[1], 0.0);
    }
    if (counts) {
        counts->paths += (uint64_t)part_count;
        counts->stretches += f.counts.stretches;
        counts->doubtful += f.counts.doubtful;
    }
    return f.count;
}
