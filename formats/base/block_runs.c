#include "formats/base/block_runs.h"

#include <pthread.h>
#include <stdint.h>
#include <sys/mman.h>

#include "formats/base/fault.h"

enum { LINE = 64, RUN = MEM_LARGE_PAGE };

/* Runs pay for blocks of which eight or more share one, and from so many bytes together on. */
enum { BLOCK_MAX = RUN / 8, FROM = 16 << 20 };

#ifdef __SANITIZE_ADDRESS__
enum { WATCHED = 1 };
#else
enum { WATCHED = 0 };
#endif

typedef struct free_block {
    struct free_block *next;
} free_block;

/* The head of a run, which begins at a multiple of RUN. */
typedef struct run {
    _Alignas(LINE) struct run *before, *after; /* in the list of runs with room */
    free_block *freed;
    uint32_t begun, used; /* blocks that were ever in use; that are now */
} run;

struct block_runs {
    mem *m;
    pthread_mutex_t lock;
    run *roomy;    /* runs with room */
    size_t bytes;  /* of a block */
    uint32_t each; /* blocks in a run; 0: there are no runs */
};

status block_runs_create(mem *m, size_t bytes, size_t count, block_runs **out) {
    block_runs *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->bytes = (bytes + LINE - 1) / LINE * LINE;
    if (!m->limit && !WATCHED && s->bytes <= BLOCK_MAX && count >= FROM / s->bytes)
        s->each = (uint32_t)((RUN - sizeof(run)) / s->bytes);
    pthread_mutex_init(&s->lock, NULL);
    *out = s;
    return ST_OK;
}

void block_runs_destroy(block_runs *s) {
    if (!s)
        return;
    pthread_mutex_destroy(&s->lock);
    mem_free(s->m, s);
}

static bool is_in_run(const block_runs *s, size_t bytes) {
    return s->each > 0 && bytes <= s->bytes && bytes > s->bytes / 2;
}

static void put_first(block_runs *s, run *r) {
    r->before = NULL;
    r->after = s->roomy;
    if (r->after)
        r->after->before = r;
    s->roomy = r;
}

static void take_out(block_runs *s, run *r) {
    if (r->before)
        r->before->after = r->after;
    else
        s->roomy = r->after;
    if (r->after)
        r->after->before = r->before;
}

/* Make a run with room. Needs the lock. */
static bool add_run(block_runs *s) {
    if (!mem_reserve(s->m, RUN))
        return false;
    run *r = mem_map(RUN);
    if (!r) {
        mem_unreserve(s->m, RUN);
        (void)status_describe(ST_NOMEM, "no room for %d bytes: the system has no memory left", RUN);
        return false;
    }
    put_first(s, r);
    return true;
}

/* Take a block out of the first run with room. Needs the lock. */
static void *take_block(block_runs *s) {
    run *r = s->roomy;
    free_block *block = r->freed;
    if (block)
        r->freed = block->next;
    else
        block = (free_block *)((char *)(r + 1) + r->begun++ * s->bytes);
    if (++r->used == s->each)
        take_out(s, r);
    return block;
}

void *block_runs_alloc(block_runs *s, size_t bytes) {
    if (!is_in_run(s, bytes))
        return mem_alloc(s->m, bytes);
    if (fault_hit(FAULT_ALLOC)) {
        (void)status_describe(ST_NOMEM, "no room for %zu bytes", s->bytes);
        return NULL;
    }
    pthread_mutex_lock(&s->lock);
    void *block = s->roomy || add_run(s) ? take_block(s) : NULL;
    pthread_mutex_unlock(&s->lock);
    return block;
}

void block_runs_free(block_runs *s, void *block, size_t bytes) {
    if (!is_in_run(s, bytes)) {
        mem_free(s->m, block);
        return;
    }
    run *r = (run *)((uintptr_t)block / RUN * RUN);
    free_block *freed = block;
    pthread_mutex_lock(&s->lock);
    freed->next = r->freed;
    r->freed = freed;
    if (r->used-- == s->each)
        put_first(s, r);
    const bool empty = r->used == 0;
    if (empty)
        take_out(s, r);
    pthread_mutex_unlock(&s->lock);
    if (!empty)
        return;
    (void)munmap(r, RUN);
    mem_unreserve(s->m, RUN);
}
