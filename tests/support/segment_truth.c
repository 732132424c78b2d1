#include "tests/support/segment_truth.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef long double real;

enum { PIECES_MAX = 4096 };

static const real U = 0x1p-53L;

/* ---- Grids ---- */

static void cell_of(const ref_volume *v, uint64_t index, long cell[3]) {
    const uint64_t cx = (uint64_t)v->dims[0] - 1, cy = (uint64_t)v->dims[1] - 1;
    cell[0] = (long)(index % cx);
    cell[1] = (long)(index / cx % cy);
    cell[2] = (long)(index / cx / cy);
}

static void corners_of(const ref_volume *v, const long cell[3], real f[8]) {
    for (int n = 0; n < 8; n++) {
        const long x = cell[0] + (n & 1), y = cell[1] + (n >> 1 & 1), z = cell[2] + (n >> 2);
        f[n] = (real)v->samples[x + v->dims[0] * (y + v->dims[1] * z)];
    }
}

static size_t grid_pieces(const void *of, const ref_ray *r, truth_piece *out, size_t room) {
    static ref_visit visits[PIECES_MAX];
    const size_t n = ref_visits(of, r, NULL, visits, PIECES_MAX);
    size_t count = 0;
    for (size_t i = 0; i < n && i < PIECES_MAX; i++) {
        long cell[3];
        real f[8], sum = 0;
        cell_of(of, (uint64_t)visits[i].cell, cell);
        corners_of(of, cell, f);
        for (int k = 0; k < 8; k++)
            sum += f[k];
        if (isfinite(sum) && count < room)
            out[count++] = (truth_piece){(uint64_t)visits[i].cell,
                                         visits[i].t_in,
                                         visits[i].t_out,
                                         {2 * U * visits[i].t_in, 2 * U * visits[i].t_out}};
    }
    return n <= PIECES_MAX ? count : room;
}

static real grid_value(const void *of, const ref_ray *r, uint64_t index, real t, real *off) {
    const ref_volume *v = of;
    long cell[3];
    real f[8], least = INFINITY, most = -INFINITY, far = 0;
    cell_of(v, index, cell);
    corners_of(v, cell, f);
    for (int k = 0; k < 8; k++) {
        least = fminl(least, f[k]);
        most = fmaxl(most, f[k]);
    }
    for (int a = 0; a < 3; a++) {
        const real lo = v->axis[a][cell[a]], width = (real)v->axis[a][cell[a] + 1] - lo;
        const real at = ((real)r->o[a] + t * r->d[a] - lo) / width;
        far += (fabsl(t * r->d[a]) + fabsl(lo - (real)r->o[a])) / width;
        for (int k = 0; k < 4 >> a; k++)
            f[k] = f[2 * k] + (f[2 * k + 1] - f[2 * k]) * at;
    }
    *off = (most - least) * 8 * U * far + 16 * U * fmaxl(fabsl(least), fabsl(most));
    return f[0];
}

static void grid_range(const void *of, uint64_t index, double range[2]) {
    long cell[3];
    real f[8];
    cell_of(of, index, cell);
    corners_of(of, cell, f);
    range[0] = range[1] = (double)f[0];
    for (int k = 1; k < 8; k++) {
        range[0] = fmin(range[0], (double)f[k]);
        range[1] = fmax(range[1], (double)f[k]);
    }
}

static bool grid_share_face(const void *of, uint64_t a, uint64_t b) {
    long p[3], q[3], steps = 0;
    cell_of(of, a, p);
    cell_of(of, b, q);
    for (int i = 0; i < 3; i++)
        steps += labs(p[i] - q[i]);
    return steps == 1;
}

segment_truth segment_truth_grid(const ref_volume *v) {
    return (segment_truth){v, grid_pieces, grid_value, grid_range, grid_share_face};
}

/* ---- Meshes ---- */

/* Of the tet's vertices as the ray sees them: the largest of the sums of |d_a (p_a - o_a)|, and how
 * far they reach in t; their values. */
typedef struct extent {
    real terms, reach, range, largest;
} extent;

static extent extent_of(const tet_ref_mesh *m, size_t tet, const ref_ray *r) {
    real dd = 0, lo = INFINITY, hi = -INFINITY, least = INFINITY, most = -INFINITY;
    extent e = {0};
    for (int a = 0; a < 3; a++)
        dd += (real)r->d[a] * r->d[a];
    for (int k = 0; k < 4; k++) {
        const uint32_t v = m->tets[tet][k];
        real along = 0, terms = 0;
        for (int a = 0; a < 3; a++) {
            const real term = r->d[a] * ((real)m->points[v][a] - r->o[a]);
            along += term;
            terms += fabsl(term);
        }
        e.terms = fmaxl(e.terms, terms / dd);
        lo = fminl(lo, along / dd);
        hi = fmaxl(hi, along / dd);
        least = fminl(least, m->values[v]);
        most = fmaxl(most, m->values[v]);
    }
    e.reach = hi - lo;
    e.range = most - least;
    e.largest = fmaxl(fabsl(least), fabsl(most));
    return e;
}

static real t_off(const extent *e) {
    return 0x1.01p-33L * e->reach + 10 * U * e->terms;
}

static size_t mesh_pieces(const void *of, const ref_ray *r, truth_piece *out, size_t room) {
    const tet_ref_mesh *m = of;
    size_t count = 0;
    for (size_t i = 0; i < m->tet_count && count < room; i++) {
        real t[2], f[2];
        if (!tet_ref_crossings(m, i, r, t, f))
            continue;
        const extent e = extent_of(m, i, r);
        const real off = t_off(&e);
        if (t[1] > -off)
            out[count++] = (truth_piece){i, fmaxl(t[0], 0), fmaxl(t[1], 0), {off, off}};
    }
    return count;
}

static real mesh_value(const void *of, const ref_ray *r, uint64_t tet, real at, real *off) {
    const tet_ref_mesh *m = of;
    const extent e = extent_of(m, tet, r);
    real t[2], f[2];
    *off = 0;
    if (!tet_ref_crossings(m, tet, r, t, f))
        return NAN;
    const real length = t[1] - t[0], error = 0x1.01p-33L * e.range + 16 * U * e.largest;
    /* Where t may be off by the whole length, the value may be either end's. */
    const real steep = length > 0 ? fminl(1, 2 * t_off(&e) / length) : 1;
    *off = error + steep * fabsl(f[1] - f[0]);
    const real s = length > 0 ? (at - t[0]) / length : 0;
    return f[0] + (f[1] - f[0]) * fminl(fmaxl(s, 0), 1);
}

static void mesh_range(const void *of, uint64_t tet, double range[2]) {
    const tet_ref_mesh *m = of;
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int k = 0; k < 4; k++) {
        range[0] = fmin(range[0], (double)m->values[m->tets[tet][k]]);
        range[1] = fmax(range[1], (double)m->values[m->tets[tet][k]]);
    }
}

static bool mesh_share_face(const void *of, uint64_t a, uint64_t b) {
    const tet_ref_mesh *m = of;
    int shared = 0;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            const uint32_t p = m->tets[a][i], q = m->tets[b][k];
            shared += m->values[p] == m->values[q] &&
                      memcmp(m->points[p], m->points[q], sizeof m->points[0]) == 0;
        }
    return shared == 3;
}

static bool share_none(const void *of, uint64_t a, uint64_t b) {
    (void)of, (void)a, (void)b;
    return false;
}

segment_truth segment_truth_mesh(const tet_ref_mesh *m, bool sound) {
    return (segment_truth){m, mesh_pieces, mesh_value, mesh_range,
                           sound ? mesh_share_face : share_none};
}

/* ---- The judge ---- */

static void fault(segment_tally *sum, const char *name, const ref_ray *r, uint64_t cell,
                  const char *what, real is, real bound) {
    if (sum->faults++ < 8)
        fprintf(stderr, "# %s: o = %a,%a,%a d = %a,%a,%a, cell %llu: %s: %.3Lg, bound %.3Lg\n",
                name, r->o[0], r->o[1], r->o[2], r->d[0], r->d[1], r->d[2],
                (unsigned long long)cell, what, is, bound);
}

/* The value as the piece has it, in long double. */
static real polynomial(const segment *s, real at) {
    real b[4];
    for (uint32_t i = 0; i <= s->degree; i++)
        b[i] = s->b[i];
    for (uint32_t left = s->degree; left > 0; left--)
        for (uint32_t i = 0; i < left; i++)
            b[i] += (b[i + 1] - b[i]) * at;
    return b[0];
}

static void judge_end(segment_tally *sum, const char *name, const ref_ray *r, uint64_t cell,
                      double got, real want, real off) {
    const real error = fabsl((real)got - want);
    if (!(error <= off))
        fault(sum, name, r, cell, "t", error, off);
    else if (off > 0)
        sum->worst_t = fmax(sum->worst_t, (double)(error / off));
}

static void judge_values(segment_tally *sum, const segment_truth *truth, const char *name,
                         const ref_ray *r, const segment *s) {
    for (int k = 0; k <= 8; k++) {
        const real at = k / 8.0L, t = s->t0 + at * ((real)s->t1 - s->t0);
        real off;
        const real want = truth->value(truth->of, r, s->cell, t, &off);
        const real error = fabsl(polynomial(s, at) - want);
        if (!(error <= off))
            fault(sum, name, r, s->cell, "value", error, off);
        else if (off > 0)
            sum->worst_value = fmax(sum->worst_value, (double)(error / off));
    }
    if (s->b[0] != segment_at(s, 0.0) || s->b[s->degree] != segment_at(s, 1.0))
        fault(sum, name, r, s->cell, "the polynomial's ends", 0, 0);
}

static const truth_piece *piece_of(const truth_piece *want, size_t count, uint64_t cell) {
    for (size_t i = 0; i < count; i++)
        if (want[i].cell == cell)
            return &want[i];
    return NULL;
}

/* Where the ray passes from one cell to the next through a face. */
static void judge_face(segment_tally *sum, const segment_truth *truth, const char *name,
                       const ref_ray *r, const segment *a, const segment *b,
                       const truth_piece *want_a, const truth_piece *want_b) {
    /* Of a face the reference has one t, too. */
    if (want_a->t1 != want_b->t0 || !truth->share_face(truth->of, a->cell, b->cell))
        return;
    if (a->t1 != b->t0 || memcmp(&a->b[a->degree], &b->b[0], sizeof b->b[0]) != 0)
        fault(sum, name, r, a->cell, "does not adjoin", (real)a->t1 - b->t0, 0);
    sum->faces++;
}

void segment_judge(segment_tally *sum, const segment_truth *truth, const char *name,
                   const ref_ray *r, const segment *got, size_t count,
                   const segments_error *error) {
    static truth_piece want[PIECES_MAX];
    static bool seen[PIECES_MAX];
    const size_t wanted = truth->pieces(truth->of, r, want, PIECES_MAX);
    real length = 0, true_length = 0, off = 0;
    memset(seen, 0, wanted * sizeof *seen);
    sum->rays++;
    sum->pieces += count;
    for (size_t i = 0; i < count; i++) {
        const truth_piece *w = piece_of(want, wanted, got[i].cell);
        const truth_piece *next = i + 1 < count ? piece_of(want, wanted, got[i + 1].cell) : NULL;
        length += (real)got[i].t1 - got[i].t0;
        if (!(got[i].t0 < got[i].t1) || (i > 0 && got[i - 1].t0 > got[i].t0))
            fault(sum, name, r, got[i].cell, "order", (real)got[i].t1 - got[i].t0, 0);
        if (!w) {
            fault(sum, name, r, got[i].cell, "the reference does not pass it", 0, 0);
            continue;
        }
        if (next)
            judge_face(sum, truth, name, r, &got[i], &got[i + 1], w, next);
        if (seen[w - want])
            fault(sum, name, r, got[i].cell, "twice", 0, 0);
        seen[w - want] = true;
        if (fmaxl(w->off[0], w->off[1]) > (1 + 0x1p-40L) * error->t)
            fault(sum, name, r, got[i].cell, "the ray's bound is less than its piece's", w->off[1],
                  error->t);
        judge_end(sum, name, r, got[i].cell, got[i].t0, w->t0, w->off[0]);
        judge_end(sum, name, r, got[i].cell, got[i].t1, w->t1, w->off[1]);
        judge_values(sum, truth, name, r, &got[i]);
    }
    for (size_t i = 0; i < wanted; i++) {
        const real has = want[i].t1 - want[i].t0, hidden = want[i].off[0] + want[i].off[1];
        true_length += has;
        off += hidden;
        if (!seen[i] && has > hidden)
            fault(sum, name, r, want[i].cell, "left out", has, hidden);
    }
    if (!(fabsl(length - true_length) <= off))
        fault(sum, name, r, 0, "sum of lengths", fabsl(length - true_length), off);
    else if (off > 0)
        sum->worst_sum = fmax(sum->worst_sum, (double)(fabsl(length - true_length) / off));
}
