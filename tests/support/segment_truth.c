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

static bool grid_share_face(const void *of, uint64_t a, uint64_t b) {
    long p[3], q[3], steps = 0;
    cell_of(of, a, p);
    cell_of(of, b, q);
    for (int i = 0; i < 3; i++)
        steps += labs(p[i] - q[i]);
    return steps == 1;
}

segment_truth segment_truth_grid(const ref_volume *v) {
    return (segment_truth){v, grid_pieces, grid_value, grid_share_face};
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

static void judge_order(segment_tally *sum, const segment_truth *truth, const char *name,
                        const ref_ray *r, const segment *a, const segment *b) {
    if (!(a->t0 < a->t1))
        fault(sum, name, r, a->cell, "no length", (real)a->t1 - a->t0, 0);
    if (!b)
        return;
    if (!(a->t0 <= b->t0))
        fault(sum, name, r, a->cell, "order", (real)b->t0 - a->t0, 0);
    if (!truth->share_face(truth->of, a->cell, b->cell))
        return;
    if (a->t1 != b->t0 || memcmp(&a->b[a->degree], &b->b[0], sizeof b->b[0]) != 0)
        fault(sum, name, r, a->cell, "does not adjoin", (real)a->b[a->degree] - b->b[0], 0);
    sum->faces++;
}

static const truth_piece *piece_of(const truth_piece *want, size_t count, uint64_t cell) {
    for (size_t i = 0; i < count; i++)
        if (want[i].cell == cell)
            return &want[i];
    return NULL;
}

void segment_judge(segment_tally *sum, const segment_truth *truth, const char *name,
                   const ref_ray *r, const segment *got, size_t count) {
    static truth_piece want[PIECES_MAX];
    static bool seen[PIECES_MAX];
    const size_t wanted = truth->pieces(truth->of, r, want, PIECES_MAX);
    real length = 0, true_length = 0, off = 0;
    memset(seen, 0, wanted * sizeof *seen);
    sum->rays++;
    sum->pieces += count;
    for (size_t i = 0; i < count; i++) {
        const truth_piece *w = piece_of(want, wanted, got[i].cell);
        judge_order(sum, truth, name, r, &got[i], i + 1 < count ? &got[i + 1] : NULL);
        length += (real)got[i].t1 - got[i].t0;
        if (!w) {
            fault(sum, name, r, got[i].cell, "the reference does not pass it", 0, 0);
            continue;
        }
        if (seen[w - want])
            fault(sum, name, r, got[i].cell, "twice", 0, 0);
        seen[w - want] = true;
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
