#include "render/medium_batch.h"

#include <string.h>

void medium_batch_single(medium_batch *m, const segment_columns *pieces, unsigned i) {
    const medium_rule rule = {
        m->transfer, m->share, m->per_length[i], m->drop, {m->t_error[i], m->value_error[i]}};
    segment piece = {.t0 = pieces->t0[i], .t1 = pieces->t1[i], .degree = (uint32_t)pieces->degree};
    for (int k = 0; k <= pieces->degree; k++)
        piece.b[k] = pieces->b[k][i];
    const medium_stretch seen = medium_of_piece(&rule, &piece);
    for (int c = 0; c < 3; c++)
        m->rgb[c][i] = seen.rgb[c];
    m->through[i] = seen.through;
    m->rgb_error[i] = seen.rgb_error;
    m->through_error[i] = seen.through_error;
    m->seen[i] = seen.through != 1.0 || seen.through_error != 0.0 || seen.rgb_error != 0.0;
}

static void medium_batch_scalar(medium_batch *m, const segment_columns *pieces) {
    for (unsigned i = 0; i < pieces->count; i++)
        medium_batch_single(m, pieces, i);
}

#if defined __x86_64__ || defined __i386__
void medium_batch_sse42(medium_batch *m, const segment_columns *pieces);
void medium_batch_avx2(medium_batch *m, const segment_columns *pieces);
void medium_batch_avx512(medium_batch *m, const segment_columns *pieces);
#endif

medium_batch_fn medium_batch_for(cpu_isa isa) {
    switch (isa) {
#if defined __x86_64__ || defined __i386__
    case CPU_AVX512: return medium_batch_avx512;
    case CPU_AVX2: return medium_batch_avx2;
    case CPU_SSE42: return medium_batch_sse42;
#endif
    default: return medium_batch_scalar;
    }
}
