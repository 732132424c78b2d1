#include "formats/leaf/leaf_shells.h"

#include <pthread.h>
#include <string.h>

enum { MOST = 256 };

typedef struct shell {
    void *samples;
    uint32_t p; /* its payload; LEAF_NO_TREELET: none */
    int holders;
    bool made;     /* else the first holder decodes it */
    uint64_t used; /* when it was held last */
} shell;

struct leaf_shells {
    mem *m;
    pthread_mutex_t lock;
    pthread_cond_t change; /* a decode has succeeded or failed */
    shell *list;
    int count;
    size_t bytes; /* of a shell */
    uint64_t clock;
};

static size_t shell_bytes(const leaf_layout *l) {
    return leaf_layout_shell_max(l) * sample_size(l->type);
}

/* A thread holds one, and another while it copies that. */
static int count_of(const leaf_layout *l, int threads, size_t bytes) {
    const size_t fitting = bytes / shell_bytes(l);
    const int count = fitting < MOST ? (int)fitting : MOST;
    const int least = l->sets > 1 ? 2 * threads : threads;
    return count > least ? count : least;
}

size_t leaf_shells_memory(const leaf_layout *l, int threads, size_t bytes) {
    if (!l->shells)
        return 0;
    return sizeof(leaf_shells) + 256 +
           (size_t)count_of(l, threads, bytes) * (shell_bytes(l) + sizeof(shell) + 128);
}

status leaf_shells_create(mem *m, const leaf_layout *l, int threads, size_t bytes,
                          leaf_shells **out) {
    *out = NULL;
    if (!l->shells)
        return ST_OK;
    leaf_shells *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    pthread_mutex_init(&s->lock, NULL);
    pthread_cond_init(&s->change, NULL);
    s->count = count_of(l, threads, bytes);
    s->bytes = shell_bytes(l);
    s->list = mem_array(m, (size_t)s->count, sizeof *s->list);
    status st = s->list ? ST_OK : ST_NOMEM;
    for (int i = 0; i < s->count && st == ST_OK; i++) {
        s->list[i].p = LEAF_NO_TREELET;
        s->list[i].samples = mem_alloc(m, shell_bytes(l));
        st = s->list[i].samples ? ST_OK : ST_NOMEM;
    }
    if (st != ST_OK) {
        leaf_shells_destroy(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

void leaf_shells_destroy(leaf_shells *s) {
    if (!s)
        return;
    for (int i = 0; s->list && i < s->count; i++)
        mem_free(s->m, s->list[i].samples);
    mem_free(s->m, s->list);
    pthread_cond_destroy(&s->change);
    pthread_mutex_destroy(&s->lock);
    mem_free(s->m, s);
}

/* The place of payload p; else the one that makes room for it. There is always one, as there are
 * enough for what all threads hold. Needs the lock. */
static shell *place_of(leaf_shells *s, uint32_t p) {
    shell *best = NULL;
    for (int i = 0; i < s->count; i++) {
        shell *at = &s->list[i];
        if (at->p == p)
            return at;
        if (at->holders == 0 && (!best || at->used < best->used))
            best = at;
    }
    return best;
}

bool leaf_shells_hold(leaf_shells *s, uint32_t p, void **samples) {
    pthread_mutex_lock(&s->lock);
    shell *at = place_of(s, p);
    while (at->p == p && !at->made && at->holders > 0) {
        pthread_cond_wait(&s->change, &s->lock);
        at = place_of(s, p);
    }
    const bool made = at->p == p && at->made;
    at->p = p;
    at->made = made;
    at->holders++;
    at->used = ++s->clock;
    *samples = at->samples;
    pthread_mutex_unlock(&s->lock);
    return made;
}

void leaf_shells_release(leaf_shells *s, uint32_t p, bool made) {
    pthread_mutex_lock(&s->lock);
    shell *at = place_of(s, p);
    at->made = made;
    at->holders--;
    if (!made)
        at->p = LEAF_NO_TREELET;
    pthread_mutex_unlock(&s->lock);
    pthread_cond_broadcast(&s->change);
}

/* The place of payload p, if it is there, decoded. Needs the lock. */
static shell *find_made(leaf_shells *s, uint32_t p) {
    for (int i = 0; i < s->count; i++)
        if (s->list[i].p == p)
            return s->list[i].made ? &s->list[i] : NULL;
    return NULL;
}

bool leaf_shells_copy(leaf_shells *s, uint32_t p, void *samples) {
    pthread_mutex_lock(&s->lock);
    shell *at = find_made(s, p);
    if (at)
        at->holders++;
    pthread_mutex_unlock(&s->lock);
    if (!at)
        return false;
    memcpy(samples, at->samples, s->bytes);
    leaf_shells_release(s, p, true);
    return true;
}
