#include "render/medium/medium_batch.h"

#include <string.h>

void medium_batch_put(medium_batch *m, unsigned i, const medium_stretch *seen) {
    for (int c = 0; c < 3; c++)
        m->rgb[c][i] = seen->rgb[c];
    m->through[i] = seen->through;
    m->rgb_error[i] = seen->rgb_error;
    m->through_error[i] = seen->through_error;
    m->seen[i] = seen->through != 1.0 || seen->through_error != 0.0 || seen->rgb_error != 0.0;
}

void medium_batch_single(medium_batch *m, const segment_columns *pieces, unsigned i) {
    const medium_rule rule = {
        m->transfer, m->share, m->per_length[i], m->drop, {m->t_error[i], m->value_error[i]}};
    segment piece = {.t0 = pieces->t0[i],
                     .t1 = pieces->t1[i],
                     .spread = pieces->spread[i],
                     .degree = (uint32_t)pieces->degree};
    for (int k = 0; k <= pieces->degree; k++)
        piece.b[k] = pieces->b[k][i];
    const medium_stretch seen = medium_of_piece(&rule, &piece);
    medium_batch_put(m, i, &seen);
    m->alone++;
}

static medium_stretch stretch_of(const medium_stretch_list *s, unsigned i) {
    return (medium_stretch){{s->rgb[0][i], s->rgb[1][i], s->rgb[2][i]},
                            s->through[i],
                            s->rgb_error[i],
                            s->through_error[i]};
}

void medium_batch_join(medium_batch *m, const segment_columns *pieces) {
    const medium_cuts *c = &m->cuts;
    const medium_stretch_list *s = &c->stretches;
    for (unsigned n = 0, i = 0; n < c->count; n++) {
        const unsigned piece = c->piece[n];
        medium_stretch seen = medium_nothing();
        for (; i < c->end[n]; i++) {
            const medium_stretch next = stretch_of(s, i);
            medium_join(&seen, &next, m->transfer->most_rgb);
        }
        medium_add_ends(m->transfer, m->t_error[piece], &seen);
        if (c->lost[n])
            medium_batch_single(m, pieces, piece);
        else
            medium_batch_put(m, piece, &seen);
    }
    m->cut += c->cuts.count;
    m->stretches += s->count;
    m->stepped += s->stepped;
}

static void medium_batch_scalar(medium_batch *m, const segment_columns *pieces) {
    for (unsigned i = 0; i < pieces->count; i++)
        medium_batch_single(m, pieces, i);
}

CPU_KERNELS(medium_batch_fn, medium_batch_kernels, medium_batch_scalar, medium_batch);
