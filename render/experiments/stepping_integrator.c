#include "render/experiments/stepping_integrator.h"
#include "render/experiments/stepping_batch.h"

static bool stepping_ask(const frame *f, ray_record *r, ray_question *q, ray_counters *counters) {
    if (stepping_ray_ask(f, stepping_ray_of(r), q))
        return true;
    stepping_ray_write(f, stepping_ray_of(r), counters);
    return false;
}

static void stepping_take(const frame *f, ray_record *const r[], const segment_columns *c,
                          bool stop[], void *scratch) {
    const stepping_look *look = stepping_look_of(f);
    stepping_batch *m = scratch;
    m->transfer = look->medium;
    m->step = look->step;
    m->inverse = 1.0 / look->step;
    for (unsigned i = 0; i < c->count; i++) {
        const stepping_ray *p = stepping_ray_of(r[c->ray[i]]);
        m->from[i] = p->from;
        m->to[i] = p->to;
    }
    stepping_batch_kernels[f->isa](m, c);
    for (unsigned i = 0; i < c->count; i++) {
        const double rgb[3] = {m->rgb[0][i], m->rgb[1][i], m->rgb[2][i]};
        if (m->through[i] != 1.0 && !stop[c->ray[i]])
            stop[c->ray[i]] =
                stepping_ray_join(look, stepping_ray_of(r[c->ray[i]]), rgb, m->through[i]);
    }
}

const integrator stepping_integrator = {.record_bytes = sizeof(stepping_ray),
                                        .begin = stepping_ray_begin,
                                        .ask = stepping_ask,
                                        .answer = stepping_ray_answer,
                                        .take_scratch = sizeof(stepping_batch),
                                        .take = stepping_take,
                                        .bundle = stepping_ray_bundle};
