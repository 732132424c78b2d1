#include "render/ray_advance.h"

/* Whose turn it is first: what lights let through comes before the next surface, so that all get
 * there together. */
static uint32_t turn_of(const ray_record *r) {
    return (uint32_t)(uint16_t)(r->leg - 1) << 16 | r->volume;
}

/* The number of a ray whose turn it is; count: none asks. */
static unsigned next_of(const ray_company *c) {
    unsigned next = c->count;
    for (unsigned i = 0; i < c->count; i++)
        if (c->asks[i] && (next == c->count || turn_of(c->record[i]) < turn_of(c->record[next])))
            next = i;
    return next;
}

/* Put the questions of all those whose turn it is, too, into the batch. */
static void gather(ray_company *c, unsigned first, ray_batch *b) {
    const tracer *tr = c->question[first].tracer;
    const uint32_t turn = turn_of(c->record[first]);
    b->count = 0;
    for (unsigned i = first; i < c->count; i++) {
        const ray_question *q = &c->question[i];
        if (!c->asks[i] || q->tracer != tr || turn_of(c->record[i]) != turn)
            continue;
        b->rays[b->count] = q->ray;
        b->states[b->count] = *q->state;
        c->asked[b->count++] = (uint8_t)i;
    }
}

/* Tell ray i the answer, and let it go on to its next question. */
static void go_on(const frame *f, ray_company *c, unsigned i, trace_result result,
                  ray_counters *counters) {
    ray_record *r = c->record[i];
    c->blocked[i] = result == TRACE_BLOCKED;
    if (c->blocked[i]) {
        c->asks[i] = false;
        r->blocked = c->question[i].state->blocked;
        return;
    }
    f->integrator->answer(f, r, result);
    c->asks[i] = f->integrator->ask(f, r, &c->question[i], counters);
}

void ray_advance(const frame *f, ray_company *c, ray_batch *b, void *scratch,
                 ray_counters *counters) {
    for (unsigned i = 0; i < c->count; i++) {
        c->blocked[i] = false;
        c->asks[i] = f->integrator->ask(f, c->record[i], &c->question[i], counters);
    }
    for (unsigned first = next_of(c); first < c->count; first = next_of(c)) {
        gather(c, first, b);
        ray_batch_next(c->question[first].tracer, f->kernels, b, scratch, counters);
        for (unsigned k = 0; k < b->count; k++) {
            *c->question[c->asked[k]].state = b->states[k];
            go_on(f, c, c->asked[k], b->results[k], counters);
        }
    }
}
