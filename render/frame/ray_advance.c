#include "render/frame/ray_advance.h"

/* Returns the turn of a ray; the least is answered first. Legs to lights come before the leg from
 * the eye, so that all rays look for their next surface together. */
static uint32_t turn_of(const ray_record *r) {
    return (uint32_t)(uint16_t)(r->leg - 1) << 16 | r->volume;
}

/* Returns the number of a ray with the least turn; c->count: no ray asks. */
static unsigned next_of(const ray_group *c) {
    unsigned next = c->count;
    for (unsigned i = 0; i < c->count; i++)
        if (c->asks[i] && (next == c->count || turn_of(c->record[i]) < turn_of(c->record[next])))
            next = i;
    return next;
}

/* Put the questions of all rays with the same turn as `first` into the batch. */
static void gather(ray_group *c, unsigned first, ray_batch *b) {
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

/* The treelet that a question waits for. */
static uint32_t absent_of(const ray_question *q) {
    return q->state     ? q->state->blocked
           : q->walk    ? q->walk->blocked
           : q->extreme ? q->extreme->blocked
                        : q->missed;
}

/* Tell ray i the answer, and let it go on to its next question. */
static void go_on(const frame *f, ray_group *c, unsigned i, trace_result result,
                  ray_counters *counters) {
    ray_record *r = c->record[i];
    c->blocked[i] = result == TRACE_BLOCKED;
    if (c->blocked[i]) {
        c->asks[i] = false;
        r->blocked = absent_of(&c->question[i]);
        return;
    }
    f->integrator->answer(f, r, result);
    c->asks[i] = f->integrator->ask(f, r, &c->question[i], counters);
}

size_t ray_pieces_bytes(const integrator *by) {
    return (sizeof(ray_pieces) + by->take_scratch + 63) / 64 * 64;
}

static void take(void *ctx, segment_batch *b) {
    ray_pieces *p = ctx;
    p->f->integrator->take(p->f, p->record, &b->columns, b->stop, p->scratch);
}

/* Gather all rays with the same turn as `first` that ask for pieces. */
static void gather_walkers(ray_group *c, unsigned first, ray_pieces *p) {
    segment_batch *b = &p->batch;
    const tracer *tr = c->question[first].tracer;
    const uint32_t turn = turn_of(c->record[first]);
    b->count = 0;
    for (unsigned i = first; i < c->count; i++) {
        const ray_question *q = &c->question[i];
        if (!c->asks[i] || q->state || !q->walk || q->tracer != tr || turn_of(c->record[i]) != turn)
            continue;
        b->rays[b->count] = q->ray;
        b->state[b->count] = q->walk;
        b->kept[b->count] = q->kept;
        p->record[b->count] = c->record[i];
        c->asked[b->count++] = (uint8_t)i;
    }
}

/* Answer rays of one turn that ask for pieces. */
static void walk_together(const frame *f, ray_group *c, unsigned first, ray_pieces *p,
                          void *scratch, ray_counters *counters) {
    segment_batch *b = &p->batch;
    p->f = f;
    gather_walkers(c, first, p);
    b->take = take;
    b->ctx = p;
    counters->objects += b->count;
    segment_batch_walk(c->question[first].tracer, b, scratch, counters);
    for (unsigned k = 0; k < b->count; k++)
        go_on(f, c, c->asked[k],
              b->result[k] == SEGMENTS_BLOCKED && !b->stop[k] ? TRACE_BLOCKED : TRACE_MISS,
              counters);
}

/* Answer rays of one turn that ask for hits. */
static void answer_together(const frame *f, ray_group *c, unsigned first, ray_batch *b,
                            void *scratch, ray_counters *counters) {
    gather(c, first, b);
    counters->objects += b->count;
    ray_batch_next(c->question[first].tracer, b, scratch, counters);
    for (unsigned k = 0; k < b->count; k++) {
        *c->question[c->asked[k]].state = b->states[k];
        go_on(f, c, c->asked[k], b->results[k], counters);
    }
}

/* Answer rays of one turn that ask for the greatest value on their ways. */
static void search_together(const frame *f, ray_group *c, unsigned first, ray_pieces *p,
                            void *scratch, ray_counters *counters) {
    extreme_batch *b = &p->extremes;
    const tracer *tr = c->question[first].tracer;
    const uint32_t turn = turn_of(c->record[first]);
    b->count = 0;
    for (unsigned i = first; i < c->count; i++) {
        const ray_question *q = &c->question[i];
        if (!c->asks[i] || q->state || q->walk || !q->extreme || q->tracer != tr ||
            turn_of(c->record[i]) != turn)
            continue;
        b->rays[b->count] = q->ray;
        b->state[b->count] = q->extreme;
        c->asked[b->count++] = (uint8_t)i;
    }
    counters->objects += b->count;
    extreme_batch_next(tr, b, scratch, counters);
    for (unsigned k = 0; k < b->count; k++)
        go_on(f, c, c->asked[k], b->result[k], counters);
}

void ray_advance(const frame *f, ray_group *c, ray_batch *b, ray_pieces *pieces, void *scratch,
                 ray_counters *counters) {
    for (unsigned i = 0; i < c->count; i++) {
        c->blocked[i] = false;
        c->question[i].extreme = NULL;
        c->question[i].objects.count = 0;
        c->asks[i] = f->integrator->ask(f, c->record[i], &c->question[i], counters);
    }
    for (unsigned first = next_of(c); first < c->count; first = next_of(c)) {
        if (c->question[first].state)
            answer_together(f, c, first, b, scratch, counters);
        else if (c->question[first].walk)
            walk_together(f, c, first, pieces, scratch, counters);
        else if (c->question[first].extreme)
            search_together(f, c, first, pieces, scratch, counters);
        else
            go_on(f, c, first, TRACE_BLOCKED, counters);
    }
}
