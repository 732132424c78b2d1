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
        if (!c->asks[i] || !q->state || q->tracer != tr || turn_of(c->record[i]) != turn)
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
        const ray_question *q = &c->question[i];
        r->blocked = q->state  ? q->state->blocked
                     : q->walk ? q->walk->blocked
                               : q->extreme->blocked;
        return;
    }
    f->integrator->answer(f, r, result);
    c->asks[i] = f->integrator->ask(f, r, &c->question[i], counters);
}

enum { WALK_AHEAD = 64 }; /* pieces: more saves time */

/* The ray's pieces, one after the other, or its greatest value. */
static trace_result walk(const frame *f, ray_company *c, unsigned i, ray_counters *counters) {
    ray_question *q = &c->question[i];
    segment ahead[WALK_AHEAD], piece;
    segments_result result;
    if (!q->walk)
        return extreme_next(q->tracer, &q->ray, i > 0 ? q[-1].extreme : NULL, q->extreme, counters);
    segments_move(q->walk, ahead, WALK_AHEAD);
    do
        result = segments_next(q->tracer, &q->ray, q->walk, &piece, counters);
    while (result == SEGMENTS_SOME && f->integrator->pass(f, c->record[i], &piece));
    segments_move(q->walk, q->kept, WALK_KEPT);
    return result == SEGMENTS_BLOCKED ? TRACE_BLOCKED : TRACE_MISS;
}

/* Those whose turn it is together, as far as they ask for hits. */
static void answer_together(const frame *f, ray_company *c, unsigned first, ray_batch *b,
                            void *scratch, ray_counters *counters) {
    gather(c, first, b);
    ray_batch_next(c->question[first].tracer, f->kernels, b, scratch, counters);
    for (unsigned k = 0; k < b->count; k++) {
        *c->question[c->asked[k]].state = b->states[k];
        go_on(f, c, c->asked[k], b->results[k], counters);
    }
}

/* The others whose turn it is. */
static void answer_one_by_one(const frame *f, ray_company *c, unsigned first,
                              ray_counters *counters) {
    const uint32_t turn = turn_of(c->record[first]);
    for (unsigned i = first; i < c->count; i++)
        if (c->asks[i] && !c->question[i].state && turn_of(c->record[i]) == turn)
            go_on(f, c, i, walk(f, c, i, counters), counters);
}

void ray_advance(const frame *f, ray_company *c, ray_batch *b, void *scratch,
                 ray_counters *counters) {
    for (unsigned i = 0; i < c->count; i++) {
        c->blocked[i] = false;
        c->question[i].extreme = NULL;
        c->asks[i] = f->integrator->ask(f, c->record[i], &c->question[i], counters);
    }
    for (unsigned first = next_of(c); first < c->count; first = next_of(c)) {
        if (c->question[first].state)
            answer_together(f, c, first, b, scratch, counters);
        else
            answer_one_by_one(f, c, first, counters);
    }
}
