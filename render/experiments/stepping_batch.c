#include "render/experiments/stepping_batch.h"

#include <math.h>

#include "formats/base/portable_math.h"

/* A piece's polynomial by powers of s. */
static void powers_of(const segment_columns *c, unsigned i, double power[4]) {
    const double b0 = c->b[0][i], b1 = c->b[1][i];
    power[0] = b0;
    if (c->degree == 1) {
        power[1] = b1 - b0;
        power[2] = power[3] = 0.0;
        return;
    }
    const double b2 = c->b[2][i], b3 = c->b[3][i];
    power[1] = 3.0 * (b1 - b0);
    power[2] = 3.0 * ((b2 - b1) - (b1 - b0));
    power[3] = (b3 - b0) - 3.0 * (b2 - b1);
}

static void take_sample(stepping_batch *m, unsigned i, double value, double length) {
    const transfer_span *s = &m->transfer->span[transfer_find(m->transfer, value)];
    const double w = (value - s->base) * s->inverse;
    const double k = (1.0 - w) * s->k[0] + w * s->k[1];
    const double through = portable_exp(0.0 - k * length), share = m->through[i] * (1.0 - through);
    for (int c = 0; c < 3; c++)
        m->rgb[c][i] = m->rgb[c][i] + share * ((1.0 - w) * s->rgb[0][c] + w * s->rgb[1][c]);
    m->through[i] = m->through[i] * through;
}

static void take_piece(stepping_batch *m, const segment_columns *c, unsigned i) {
    const double rounder = PORTABLE_ROUNDER, from = m->from[i], to = m->to[i];
    const double t0 = c->t0[i], t1 = c->t1[i], shrink = 1.0 / (t1 - t0);
    double power[4];
    powers_of(c, i, power);
    m->through[i] = 1.0;
    m->rgb[0][i] = m->rgb[1][i] = m->rgb[2][i] = 0.0;
    double n = fmax((((t0 - from) * m->inverse - 0.5) + rounder) - rounder, 0.0);
    for (;; n += 1.0) {
        const double begin = from + n * m->step, end = fmin(from + (n + 1.0) * m->step, to);
        const double t = 0.5 * (begin + end);
        if (!(begin < to && t < t1))
            break;
        if (t < t0)
            continue;
        const double s = (t - t0) * shrink;
        take_sample(m, i, power[0] + s * (power[1] + s * (power[2] + s * power[3])), end - begin);
    }
}

static void stepping_batch_scalar(stepping_batch *m, const segment_columns *pieces) {
    for (unsigned i = 0; i < pieces->count; i++)
        take_piece(m, pieces, i);
}

CPU_KERNELS(stepping_batch_fn, stepping_batch_kernels, stepping_batch_scalar, stepping_batch);
