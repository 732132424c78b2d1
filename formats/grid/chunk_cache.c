#include "formats/grid/chunk_cache.h"

#include <pthread.h>
#include <string.h>

enum {
    SLOTS_MAX = 1 << 13, /* chunks at most */
    SLOTS_MORE = 64,     /* than have room together: those without a file need none */
    ROOM_MAX = 256 << 20,
    ROOM_SHARE = 4,        /* of what the job has left */
    STREAM_ROOM = 4 << 20, /* what codecs need besides: bzip2 most */
    READ_ROOM = 128 << 10, /* and reading a file */
    NONE = -1
};

typedef enum slot_state { ABSENT, MAKING, READY } slot_state;

typedef struct slot {
    slot_state state;
    int holders; /* 1 while it is made */
    uint32_t index[ORDER_AXES];
    uint8_t *numbers; /* NULL: the fill value */
    size_t bytes;     /* that it takes, or will need while it is made */
    int next;         /* of the same hash, or of those that are absent; NONE: the last */
    int older, newer; /* by when they were held last, of those that are not absent */
} slot;

struct chunk_cache {
    mem *m;
    mem own;         /* the budget of chunks and codecs */
    size_t reserved; /* of m; 0: m has no limit */
    const chunk_array *array;
    chunk_shape shape;
    chunk_home in;
    size_t need; /* bytes to make one */
    int count;   /* of slots, a power of 2 */
    pthread_mutex_t lock;
    pthread_cond_t change; /* a chunk has been made or released, or making it has failed */
    /* Guarded by the lock: */
    slot *slots;
    int *heads; /* of a hash, `count` of them */
    int absent, oldest, newest;
    size_t kept;   /* bytes of all slots */
    int active;    /* slots that are held */
    int alone;     /* threads that want the budget for themselves; others then wait */
    bool is_alone; /* one of them has it */
};

/* ---- its memory ---- */

/* What making a chunk takes: itself, what it was before its filters, its file, and a codec. */
static size_t need_of(const chunk_array *a, const chunk_shape *s) {
    const size_t both = a->filters.count ? 2 * s->room : s->room;
    const size_t codec = a->codec == ZARR_RAW      ? 0
                         : a->codec == ZARR_STREAM ? STREAM_ROOM
                                                   : s->coded;
    const size_t window = a->codec == ZARR_STREAM ? s->coded : 0;
    return both + codec + window + s->coded / 64 + READ_ROOM;
}

static status take_room(chunk_cache *c) {
    const size_t limit = c->m->limit, used = mem_used(c->m);
    size_t room = ROOM_MAX;
    if (limit)
        room = limit > used ? (limit - used) / ROOM_SHARE : 0;
    room = room < ROOM_MAX ? room : ROOM_MAX;
    room = room > c->need ? room : c->need;
    mem_init(&c->own, room);
    c->own.target = c->m->target;
    if (limit && !mem_reserve(c->m, room))
        return ST_NOMEM;
    c->reserved = limit ? room : 0;
    return ST_OK;
}

/* As many slots as chunks have room. */
static status make_slots(chunk_cache *c) {
    const size_t most = c->own.limit / c->shape.room + SLOTS_MORE;
    for (c->count = 1; c->count < SLOTS_MAX && (size_t)c->count < most;)
        c->count *= 2;
    c->slots = mem_array(c->m, (size_t)c->count, sizeof *c->slots);
    c->heads = mem_array(c->m, (size_t)c->count, sizeof *c->heads);
    if (!c->slots || !c->heads)
        return ST_NOMEM;
    c->oldest = c->newest = NONE;
    for (int i = 0; i < c->count; i++) {
        c->heads[i] = NONE;
        c->slots[i].next = i + 1 < c->count ? i + 1 : NONE;
    }
    return ST_OK;
}

status chunk_cache_create(mem *m, const chunk_array *a, const chunk_home *in, chunk_cache **out) {
    chunk_cache *c = mem_zalloc(m, sizeof *c);
    if (!c)
        return ST_NOMEM;
    *c = (chunk_cache){.m = m, .array = a};
    pthread_mutex_init(&c->lock, NULL); /* neither can fail on Linux */
    pthread_cond_init(&c->change, NULL);
    (void)chunk_array_measure(a, &c->shape);
    c->need = need_of(a, &c->shape);
    c->in = *in;
    c->in.path = mem_copy_text(m, in->path);
    c->in.trusted = mem_copy_text(m, in->trusted);
    status st = c->in.path && c->in.trusted ? take_room(c) : ST_NOMEM;
    if (st == ST_OK)
        st = make_slots(c);
    if (st != ST_OK) {
        chunk_cache_destroy(c);
        return st;
    }
    *out = c;
    return ST_OK;
}

void chunk_cache_destroy(chunk_cache *c) {
    if (!c)
        return;
    for (int i = 0; c->slots && i < c->count; i++)
        mem_free(&c->own, c->slots[i].numbers);
    mem_free(c->m, c->slots);
    mem_free(c->m, c->heads);
    mem_free(c->m, (char *)(uintptr_t)c->in.path);
    mem_free(c->m, (char *)(uintptr_t)c->in.trusted);
    mem_unreserve(c->m, c->reserved);
    pthread_cond_destroy(&c->change);
    pthread_mutex_destroy(&c->lock);
    mem_free(c->m, c);
}

const chunk_shape *chunk_cache_shape(const chunk_cache *c) {
    return &c->shape;
}

/* ---- slots; all of it with the lock held ---- */

static int *head_of(const chunk_cache *c, const uint32_t index[ORDER_AXES]) {
    uint32_t sum = 0;
    for (int r = 0; r < ORDER_AXES; r++)
        sum = (sum ^ index[r]) * 2654435761U;
    return &c->heads[(sum >> 16 ^ sum) & (uint32_t)(c->count - 1)];
}

static slot *find(chunk_cache *c, const uint32_t index[ORDER_AXES]) {
    int i = *head_of(c, index);
    while (i != NONE && memcmp(c->slots[i].index, index, sizeof c->slots[i].index) != 0)
        i = c->slots[i].next;
    return i == NONE ? NULL : &c->slots[i];
}

/* Take a slot out of the order of use, or put it at its newest end. */
static void take_out(chunk_cache *c, const slot *s) {
    *(s->older == NONE ? &c->oldest : &c->slots[s->older].newer) = s->newer;
    *(s->newer == NONE ? &c->newest : &c->slots[s->newer].older) = s->older;
}

static void put_newest(chunk_cache *c, slot *s) {
    const int i = (int)(s - c->slots);
    s->older = c->newest;
    s->newer = NONE;
    *(c->newest == NONE ? &c->oldest : &c->slots[c->newest].newer) = i;
    c->newest = i;
}

/* Forget a chunk. */
static void clear(chunk_cache *c, slot *s) {
    const int i = (int)(s - c->slots);
    int *at = head_of(c, s->index);
    while (*at != i)
        at = &c->slots[*at].next;
    *at = s->next;
    take_out(c, s);
    mem_free(&c->own, s->numbers);
    c->kept -= s->bytes;
    *s = (slot){.state = ABSENT, .next = c->absent};
    c->absent = i;
}

/* Forget the chunk that was not needed for longest; false: all that are there are held. */
static bool evict(chunk_cache *c) {
    int i = c->oldest;
    while (i != NONE && (c->slots[i].state != READY || c->slots[i].holders > 0))
        i = c->slots[i].newer;
    if (i != NONE)
        clear(c, &c->slots[i]);
    return i != NONE;
}

/* Whether a slot is absent, or can be. */
static bool has_absent(chunk_cache *c) {
    return c->absent != NONE || evict(c);
}

/* Begin to make a chunk that will take so many bytes, in a slot that is absent. */
static slot *add(chunk_cache *c, const uint32_t index[ORDER_AXES], size_t bytes) {
    const int i = c->absent;
    slot *s = &c->slots[i];
    int *head = head_of(c, index);
    c->absent = s->next;
    *s = (slot){.state = MAKING, .holders = 1, .bytes = bytes, .next = *head};
    memcpy(s->index, index, sizeof s->index);
    *head = i;
    put_newest(c, s);
    c->kept += bytes;
    c->active++;
    return s;
}

/* Make room for one more; false: there is none before somebody lets go. */
static bool make_room(chunk_cache *c) {
    while (c->kept + c->need > c->own.limit && evict(c)) {}
    if (c->kept + c->need > c->own.limit && c->active > 0)
        return false;
    return has_absent(c);
}

static void hold_slot(chunk_cache *c, slot *s) {
    c->active += s->holders++ == 0;
    take_out(c, s);
    put_newest(c, s);
}

/* Find the chunk in a slot, held; or a slot to make it in, whose state is MAKING. Waits. */
static slot *take(chunk_cache *c, const uint32_t index[ORDER_AXES]) {
    for (;; pthread_cond_wait(&c->change, &c->lock)) {
        slot *s = c->alone > 0 ? NULL : find(c, index);
        if (s && s->state == READY) {
            hold_slot(c, s);
            return s;
        }
        if (!s && c->alone == 0 && make_room(c))
            return add(c, index, c->need);
    }
}

/* Let go of a slot. */
static void let_go(chunk_cache *c, slot *s) {
    c->active -= --s->holders == 0;
    pthread_cond_broadcast(&c->change);
}

/* Wait until nobody else holds or makes anything, and drop all that is kept. Others then wait. */
static void begin_alone(chunk_cache *c) {
    c->alone++;
    while (c->active > 0 || c->is_alone)
        pthread_cond_wait(&c->change, &c->lock);
    c->is_alone = true;
    while (evict(c)) {}
}

static void end_alone(chunk_cache *c) {
    c->alone--;
    c->is_alone = false;
    pthread_cond_broadcast(&c->change);
}

/* ---- chunks ---- */

/* Read a chunk. *numbers: NULL where it has no file. Without the lock. */
static status make(chunk_cache *c, const uint32_t index[ORDER_AXES], uint8_t **numbers,
                   uint64_t *read) {
    const bool filtered = c->array->filters.count > 0;
    bool there = false;
    uint8_t *chunk = mem_alloc(&c->own, c->shape.room);
    uint8_t *coded = filtered ? mem_alloc(&c->own, c->shape.room) : NULL;
    const status st = chunk && (coded || !filtered)
                          ? chunk_array_read(&c->own, c->array, &c->shape, &c->in, index, chunk,
                                             coded, &there, read)
                          : ST_NOMEM;
    mem_free(&c->own, coded);
    if (st != ST_OK || !there) {
        mem_free(&c->own, chunk);
        chunk = NULL;
    }
    *numbers = chunk;
    return st;
}

/* End what take() began. */
static void settle(chunk_cache *c, slot *s, uint8_t *numbers, status st) {
    c->kept -= s->bytes;
    s->bytes = numbers ? c->shape.room : 0;
    c->kept += s->bytes;
    s->numbers = numbers;
    s->state = READY;
    if (st != ST_OK) {
        let_go(c, s);
        clear(c, s);
    }
    pthread_cond_broadcast(&c->change);
}

/* Make a chunk in a slot that take() gave. */
static status fill(chunk_cache *c, slot *s, const uint32_t index[ORDER_AXES], uint64_t *read) {
    uint8_t *numbers;
    pthread_mutex_unlock(&c->lock);
    status st = make(c, index, &numbers, read);
    pthread_mutex_lock(&c->lock);
    settle(c, s, numbers, st);
    return st;
}

/* Hold a chunk. If there was no room for it beside others, it gets the whole budget. */
static status hold(chunk_cache *c, const uint32_t index[ORDER_AXES], slot **out, uint64_t *read) {
    pthread_mutex_lock(&c->lock);
    slot *s = take(c, index);
    status st = s->state == READY ? ST_OK : fill(c, s, index, read);
    if (st == ST_NOMEM && (c->kept > 0 || c->active > 0 || c->alone > 0)) {
        begin_alone(c);
        s = add(c, index, 0); /* all slots are absent */
        st = fill(c, s, index, read);
        end_alone(c);
    }
    pthread_mutex_unlock(&c->lock);
    *out = s;
    return st;
}

/* One thread's way through a box. */
typedef struct visit {
    chunk_cache *c;
    slot *held;
    uint64_t *read;
} visit;

static status hold_chunk(void *ctx, const uint32_t index[ORDER_AXES], const uint8_t **numbers) {
    visit *v = ctx;
    const status st = hold(v->c, index, &v->held, v->read);
    *numbers = st == ST_OK ? v->held->numbers : NULL;
    return st;
}

static void release_chunk(void *ctx, const uint32_t index[ORDER_AXES]) {
    visit *v = ctx;
    (void)index;
    pthread_mutex_lock(&v->c->lock);
    let_go(v->c, v->held);
    pthread_mutex_unlock(&v->c->lock);
}

status chunk_cache_gather(chunk_cache *c, const uint32_t first[ORDER_AXES],
                          const uint32_t end[ORDER_AXES], void *out, uint64_t *read) {
    visit v = {.c = c, .read = read};
    const chunk_supply from = {hold_chunk, release_chunk, &v};
    return chunk_array_gather(c->array, &c->shape, first, end, &from, out);
}
