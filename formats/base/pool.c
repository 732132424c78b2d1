#include "formats/base/pool.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/thread.h"

typedef struct worker {
    pool *owner;
    int index;
    pthread_t thread;
} worker;

struct pool {
    mem *m;
    int threads; /* with the caller */
    int started;
    worker *workers;
    pool_run_host run; /* runs work on the caller's threads; NULL: use workers */
    void *host;
    pthread_mutex_t lock;
    pthread_cond_t wake, idle;
    /* The running loop. lock guards all but the atomics. */
    uint64_t generation;
    int busy;
    bool quit;
    pool_body body;
    void *ctx;
    size_t count;
    atomic_size_t next;
    atomic_bool failed;
    size_t failed_index;
    status_note note;
};

static void note_failure(pool *p, size_t index, status st) {
    pthread_mutex_lock(&p->lock);
    if (index < p->failed_index) {
        p->failed_index = index;
        status_note_take(&p->note, st);
    }
    atomic_store(&p->failed, true);
    pthread_mutex_unlock(&p->lock);
}

static void take_indices(pool *p, int self) {
    while (!atomic_load_explicit(&p->failed, memory_order_relaxed)) {
        size_t index = atomic_fetch_add(&p->next, 1);
        if (index >= p->count)
            return;
        status st = p->body(p->ctx, index, self);
        if (st != ST_OK)
            note_failure(p, index, st);
    }
}

static void *work(void *arg) {
    worker *self = arg;
    pool *p = self->owner;
    uint64_t seen = 0;
    pthread_mutex_lock(&p->lock);
    for (;;) {
        while (!p->quit && p->generation == seen)
            pthread_cond_wait(&p->wake, &p->lock);
        if (p->quit)
            break;
        seen = p->generation;
        pthread_mutex_unlock(&p->lock);
        take_indices(p, self->index);
        pthread_mutex_lock(&p->lock);
        if (--p->busy == 0)
            pthread_cond_signal(&p->idle);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

/* Make a pool without workers. */
static pool *pool_make(mem *m, int threads) {
    pool *p = mem_zalloc(m, sizeof *p);
    if (!p)
        return NULL;
    p->m = m;
    p->threads = threads < 1 ? 1 : threads;
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->wake, NULL);
    pthread_cond_init(&p->idle, NULL);
    return p;
}

status pool_create_host(mem *m, int threads, pool_run_host run, void *host, pool **out) {
    pool *p = pool_make(m, threads);
    if (!p)
        return ST_NOMEM;
    p->run = run;
    p->host = host;
    *out = p;
    return ST_OK;
}

status pool_create(mem *m, int threads, pool **out) {
    pool *p = pool_make(m, threads);
    if (!p)
        return ST_NOMEM;
    status st = ST_NOMEM;
    p->workers = mem_array(m, (size_t)p->threads, sizeof *p->workers);
    if (!p->workers)
        goto fail;
    for (; p->started < p->threads - 1; p->started++) {
        worker *w = &p->workers[p->started];
        w->owner = p;
        w->index = p->started + 1;
        char what[64];
        snprintf(what, sizeof what, "thread %d of %d", w->index + 1, p->threads);
        st = thread_start(&w->thread, work, w, what);
        if (st != ST_OK)
            goto fail;
    }
    *out = p;
    return ST_OK;
fail:
    pool_destroy(p);
    return st;
}

void pool_destroy(pool *p) {
    if (!p)
        return;
    pthread_mutex_lock(&p->lock);
    p->quit = true;
    pthread_cond_broadcast(&p->wake);
    pthread_mutex_unlock(&p->lock);
    for (int i = 0; i < p->started; i++)
        pthread_join(p->workers[i].thread, NULL);
    pthread_cond_destroy(&p->idle);
    pthread_cond_destroy(&p->wake);
    pthread_mutex_destroy(&p->lock);
    mem_free(p->m, p->workers);
    mem_free(p->m, p);
}

int pool_threads(const pool *p) {
    return p->threads;
}

static void work_for_host(void *arg, int index) {
    take_indices(arg, index);
}

/* Run all of a loop's indices, on all threads. */
static void share_out(pool *p) {
    if (p->run) {
        p->run(p->host, p->threads, work_for_host, p);
        return;
    }
    take_indices(p, 0);
    pthread_mutex_lock(&p->lock);
    while (p->busy > 0)
        pthread_cond_wait(&p->idle, &p->lock);
    pthread_mutex_unlock(&p->lock);
}

status pool_run(pool *p, size_t count, pool_body body, void *ctx) {
    return pool_run_range(p, 0, count, body, ctx);
}

status pool_run_range(pool *p, size_t first, size_t end, pool_body body, void *ctx) {
    pthread_mutex_lock(&p->lock);
    p->body = body;
    p->ctx = ctx;
    p->count = end;
    p->failed_index = SIZE_MAX;
    atomic_store(&p->next, first);
    atomic_store(&p->failed, false);
    p->busy = p->started;
    p->generation++;
    pthread_cond_broadcast(&p->wake);
    pthread_mutex_unlock(&p->lock);

    share_out(p);
    return atomic_load(&p->failed) ? status_note_raise(&p->note) : ST_OK;
}

int pool_default_threads(void) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    if (sched_getaffinity(0, sizeof cpus, &cpus) != 0)
        return 1;
    int count = CPU_COUNT(&cpus);
    return count > 0 ? count : 1;
}
