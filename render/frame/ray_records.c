#include "render/frame/ray_records.h"

enum { REFILL = 64 }; /* records that a reserve takes at a time */

status ray_records_init(ray_records *r, mem *m, size_t record_bytes, uint32_t most) {
    *r = (ray_records){.m = m,
                       .record_bytes = record_bytes,
                       .most = most,
                       .free_head = ray_records_none,
                       .unpromised = most};
    pthread_mutex_init(&r->lock, NULL);
    r->chunks = mem_array(m, most / RAY_RECORDS_CHUNK + 1, sizeof *r->chunks);
    return r->chunks ? ST_OK : ST_NOMEM;
}

void ray_records_release(ray_records *r) {
    for (uint32_t i = 0; i < r->made; i += RAY_RECORDS_CHUNK)
        mem_free(r->m, r->chunks[i / RAY_RECORDS_CHUNK]);
    mem_free(r->m, r->chunks);
    pthread_mutex_destroy(&r->lock);
}

size_t ray_records_bytes(size_t record_bytes, uint32_t most) {
    const size_t chunks = most / RAY_RECORDS_CHUNK + 1, overhead = 192;
    return chunks * (sizeof(char *) + overhead) + RAY_RECORDS_CHUNK * record_bytes;
}

bool ray_records_promise(ray_records *r, ray_reserve *own, uint32_t count) {
    if (own->promised >= count)
        return true;
    const uint32_t more = count - own->promised;
    pthread_mutex_lock(&r->lock);
    const bool there = r->unpromised >= more;
    if (there) {
        r->unpromised -= more;
        own->promised += more;
    }
    pthread_mutex_unlock(&r->lock);
    return there;
}

static void push(const ray_records *r, uint32_t *head, uint32_t i) {
    ray_records_at(r, i)->next = *head;
    *head = i;
}

static uint32_t pop(const ray_records *r, uint32_t *head) {
    const uint32_t i = *head;
    *head = ray_records_at(r, i)->next;
    return i;
}

bool ray_records_keep(ray_records *r, ray_reserve *own, uint32_t count) {
    if (own->promised <= count)
        return false;
    pthread_mutex_lock(&r->lock);
    r->unpromised += own->promised - count;
    own->promised = count;
    for (; own->count > own->promised; own->count--)
        push(r, &r->free_head, pop(r, &own->head));
    pthread_mutex_unlock(&r->lock);
    return true;
}

/* Under the lock. */
static status make_chunk(ray_records *r) {
    const uint32_t left = r->most - r->made,
                   count = left < RAY_RECORDS_CHUNK ? left : RAY_RECORDS_CHUNK;
    char *chunk = mem_alloc(r->m, count * r->record_bytes);
    if (!chunk)
        return ST_NOMEM;
    r->chunks[r->made / RAY_RECORDS_CHUNK] = chunk;
    r->made += count;
    return ST_OK;
}

/* Under the lock: find a record that no ray and no reserve has. Promises ensure that there is one.
 */
static status find(ray_records *r, uint32_t *i) {
    if (r->free_head != ray_records_none) {
        *i = pop(r, &r->free_head);
        return ST_OK;
    }
    const status st = r->begun < r->made ? ST_OK : make_chunk(r);
    if (st == ST_OK)
        *i = r->begun++;
    return st;
}

/* Fill the reserve with free records: as many as are promised to it, up to REFILL. */
static status refill(ray_records *r, ray_reserve *own) {
    const uint32_t count = own->promised < REFILL ? own->promised : REFILL;
    status st = ST_OK;
    pthread_mutex_lock(&r->lock);
    for (; own->count < count && st == ST_OK; own->count++) {
        uint32_t i = 0;
        st = find(r, &i);
        if (st != ST_OK)
            break;
        push(r, &own->head, i);
    }
    pthread_mutex_unlock(&r->lock);
    return st;
}

status ray_records_take(ray_records *r, ray_reserve *own, uint32_t *i) {
    const status st = own->count > 0 ? ST_OK : refill(r, own);
    if (st != ST_OK)
        return st;
    *i = pop(r, &own->head);
    own->count--;
    own->promised--;
    return ST_OK;
}

void ray_records_give(ray_records *r, ray_reserve *own, uint32_t i) {
    push(r, &own->head, i);
    own->count++;
    own->promised++;
}
