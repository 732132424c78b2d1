#include "render/door/live_steps.h"

#include "formats/leaf/leaf_live.h"

struct live_steps {
    mem *m;
    leaf_file *file;
    pthread_mutex_t lock;
    pthread_cond_t let_go; /* of a step, or of writing */
    /* Guarded by lock: */
    live_hold *holds;
    bool writing;     /* one writer at a time */
    uint32_t current; /* changes only where a writer ends */
};

status live_steps_create(mem *m, leaf_file *f, live_steps **out) {
    live_steps *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (live_steps){.m = m, .file = f};
    pthread_mutex_init(&s->lock, NULL);
    pthread_cond_init(&s->let_go, NULL);
    *out = s;
    return ST_OK;
}

void live_steps_destroy(live_steps *s) {
    if (!s)
        return;
    pthread_cond_destroy(&s->let_go);
    pthread_mutex_destroy(&s->lock);
    mem_free(s->m, s);
}

void live_steps_hold(live_steps *s, live_hold *h) {
    if (!s)
        return;
    pthread_mutex_lock(&s->lock);
    *h = (live_hold){.next = s->holds, .of = s, .step = s->current, .by = pthread_self()};
    s->holds = h;
    pthread_mutex_unlock(&s->lock);
}

void live_steps_let_go(live_hold *h) {
    live_steps *s = h->of;
    if (!s)
        return;
    pthread_mutex_lock(&s->lock);
    live_hold **at = &s->holds;
    while (*at != h)
        at = &(*at)->next;
    *at = h->next;
    h->of = NULL;
    pthread_cond_broadcast(&s->let_go);
    pthread_mutex_unlock(&s->lock);
}

/* Returns a hold of a step: one of this thread, if there is any. Needs the lock. */
static const live_hold *held(const live_steps *s, uint32_t step) {
    const live_hold *found = NULL;
    for (const live_hold *h = s->holds; h; h = h->next)
        if (h->step == step && (!found || pthread_equal(h->by, pthread_self())))
            found = h;
    return found;
}

/* A writer that waits is none yet: another thread whose own frame all wait for must hear of that.
 */
status live_steps_begin(live_steps *s, uint32_t *step) {
    status st = ST_OK;
    pthread_mutex_lock(&s->lock);
    for (;;) {
        const live_hold *h = held(s, !s->current);
        if (h && pthread_equal(h->by, pthread_self()))
            st = status_describe(ST_USAGE, "a frame that this thread has begun shows the step "
                                           "before the current one: end it first");
        if (st != ST_OK || (!h && !s->writing))
            break;
        pthread_cond_wait(&s->let_go, &s->lock);
    }
    *step = !s->current;
    s->writing = s->writing || st == ST_OK;
    pthread_mutex_unlock(&s->lock);
    return st;
}

void live_steps_end(live_steps *s, uint32_t step, bool show) {
    pthread_mutex_lock(&s->lock);
    s->current = show ? step : s->current;
    s->writing = false;
    pthread_cond_broadcast(&s->let_go);
    pthread_mutex_unlock(&s->lock);
}

status live_steps_put(live_steps *s, const live_region *r) {
    uint32_t step;
    status st = live_steps_begin(s, &step);
    if (st != ST_OK)
        return st;
    st = leaf_live_put(s->file, step, r);
    live_steps_end(s, step, false);
    return st;
}

status live_steps_commit(live_steps *s, double time) {
    uint32_t step;
    status st = live_steps_begin(s, &step);
    if (st != ST_OK)
        return st;
    st = leaf_live_finish(s->file, step, time);
    live_steps_end(s, step, st == ST_OK);
    return st;
}
