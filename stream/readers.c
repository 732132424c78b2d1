#include "stream/readers.h"

#include <pthread.h>
#include <stdio.h>

#include "formats/base/thread.h"

typedef struct reader {
    struct reader *next;
    pthread_t thread;
} reader;

struct readers {
    mem *m;
    pthread_mutex_t lock;
    pthread_cond_t work, rested; /* there is something to read; a thread ended a read */
    /* Guarded by lock: */
    reader *threads;
    reader_customer *customers;
    uint64_t turns;
    int started;
    bool quit;
};

static bool comes_before(const reader_customer *a, const reader_customer *b) {
    return a->priority != b->priority ? a->priority < b->priority : a->served < b->served;
}

/* Returns the most urgent customer, or NULL if none waits. Needs the lock. */
static reader_customer *next_customer(readers *r) {
    reader_customer *first = NULL;
    for (reader_customer *c = r->customers; c; c = c->next)
        if (c->waiting && (!first || comes_before(c, first)))
            first = c;
    return first;
}

/* Let a customer do one read. Needs the lock, and releases it during the read. */
static void serve(readers *r, reader_customer *c) {
    c->served = ++r->turns;
    c->busy++;
    pthread_mutex_unlock(&r->lock);
    c->read(c->ctx);
    pthread_mutex_lock(&r->lock);
    c->busy--;
    pthread_cond_broadcast(&r->rested);
}

static void *read_for_customers(void *arg) {
    readers *r = arg;
    pthread_mutex_lock(&r->lock);
    while (!r->quit) {
        reader_customer *c = next_customer(r);
        if (c)
            serve(r, c);
        else
            pthread_cond_wait(&r->work, &r->lock);
    }
    pthread_mutex_unlock(&r->lock);
    return NULL;
}

status readers_create(mem *m, readers **out) {
    readers *r = mem_zalloc(m, sizeof *r);
    if (!r)
        return ST_NOMEM;
    r->m = m;
    pthread_mutex_init(&r->lock, NULL);
    pthread_cond_init(&r->work, NULL);
    pthread_cond_init(&r->rested, NULL);
    *out = r;
    return ST_OK;
}

void readers_destroy(readers *r) {
    if (!r)
        return;
    pthread_mutex_lock(&r->lock);
    r->quit = true;
    pthread_cond_broadcast(&r->work);
    pthread_mutex_unlock(&r->lock);
    for (reader *t = r->threads, *next; t; t = next) {
        next = t->next;
        pthread_join(t->thread, NULL);
        mem_free(r->m, t);
    }
    pthread_cond_destroy(&r->rested);
    pthread_cond_destroy(&r->work);
    pthread_mutex_destroy(&r->lock);
    mem_free(r->m, r);
}

/* Start one more thread, of `wanted`. Needs the lock. */
static status start_reader(readers *r, int wanted) {
    char what[64];
    snprintf(what, sizeof what, "loader thread %d of %d", r->started + 1, wanted);
    reader *t = mem_zalloc(r->m, sizeof *t);
    if (!t)
        return ST_NOMEM;
    const status st = thread_start(&t->thread, read_for_customers, r, what);
    if (st != ST_OK) {
        mem_free(r->m, t);
        return st;
    }
    t->next = r->threads;
    r->threads = t;
    r->started++;
    return ST_OK;
}

status readers_join(readers *r, reader_customer *c, int threads) {
    status st = ST_OK;
    pthread_mutex_lock(&r->lock);
    while (r->started < threads && st == ST_OK)
        st = start_reader(r, threads);
    if (st == ST_OK) {
        c->next = r->customers;
        r->customers = c;
    }
    pthread_mutex_unlock(&r->lock);
    return st;
}

void readers_leave(readers *r, reader_customer *c) {
    pthread_mutex_lock(&r->lock);
    for (reader_customer **at = &r->customers; *at; at = &(*at)->next)
        if (*at == c) {
            *at = c->next;
            break;
        }
    while (c->busy > 0)
        pthread_cond_wait(&r->rested, &r->lock);
    pthread_mutex_unlock(&r->lock);
}

void readers_tell(readers *r, reader_customer *c, bool waiting, uint64_t priority) {
    pthread_mutex_lock(&r->lock);
    c->waiting = waiting;
    c->priority = priority;
    if (waiting)
        pthread_cond_signal(&r->work);
    pthread_mutex_unlock(&r->lock);
}
