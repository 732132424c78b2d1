#include "prep/mesh/mesh_pages.h"

#include <string.h>

enum { PAGE = 1 << MESH_PAGES_LOG2, SETS_LOG2_MIN = 4, SETS_LOG2_MAX = 20 };

static uint64_t bytes_of(const mesh_spool *s, uint32_t sets_log2) {
    uint64_t ways = (uint64_t)MESH_PAGES_WAYS << sets_log2;
    return ways * (PAGE * s->element + sizeof(uint64_t)) + (UINT64_C(1) << sets_log2) + 512;
}

/* log2 of the number of sets: no more pages than the spool has, and than fit into room. */
static uint32_t sets_for(const mesh_spool *s, uint64_t room) {
    uint32_t log2 = SETS_LOG2_MIN;
    while (log2 < SETS_LOG2_MAX && bytes_of(s, log2 + 1) <= room &&
           (uint64_t)MESH_PAGES_WAYS * PAGE << log2 < s->count)
        log2++;
    return log2;
}

uint64_t mesh_pages_least(const mesh_spool *s) {
    return bytes_of(s, SETS_LOG2_MIN);
}

uint64_t mesh_pages_memory(const mesh_spool *s, uint64_t room) {
    return bytes_of(s, sets_for(s, room));
}

status mesh_pages_init(mesh_pages *p, mesh_spool *s, uint64_t room) {
    *p = (mesh_pages){.spool = s};
    if (mesh_spool_held(s))
        return ST_OK;
    p->sets_log2 = sets_for(s, room);
    size_t sets = (size_t)1 << p->sets_log2;
    p->pages = mem_alloc(s->m, sets * MESH_PAGES_WAYS * PAGE * s->element);
    p->tags = mem_array(s->m, sets * MESH_PAGES_WAYS, sizeof *p->tags);
    p->next = mem_array(s->m, sets, sizeof *p->next);
    return p->pages && p->tags && p->next ? ST_OK : ST_NOMEM;
}

void mesh_pages_release(mesh_pages *p) {
    if (!p->spool)
        return;
    mem_free(p->spool->m, p->pages);
    mem_free(p->spool->m, p->tags);
    mem_free(p->spool->m, p->next);
    *p = (mesh_pages){0};
}

static char *read_page(mesh_pages *p, uint64_t page, size_t set) {
    size_t slot = set * MESH_PAGES_WAYS + p->next[set];
    char *to = p->pages + slot * PAGE * p->spool->element;
    uint64_t first = page << MESH_PAGES_LOG2, left = p->spool->count - first;
    p->tags[slot] = 0;
    p->st = mesh_spool_read(p->spool, first, left < PAGE ? (size_t)left : PAGE, to);
    if (p->st != ST_OK)
        return NULL;
    p->tags[slot] = page + 1;
    p->next[set] = (uint8_t)((p->next[set] + 1) % MESH_PAGES_WAYS);
    return to;
}

const void *mesh_pages_find(mesh_pages *p, uint64_t i) {
    uint64_t page = i >> MESH_PAGES_LOG2;
    /* Fibonacci hashing: neighbours go to different sets, and so do the layers of a lattice. */
    size_t set = (size_t)(page * UINT64_C(0x9e3779b97f4a7c15) >> (64 - p->sets_log2));
    const uint64_t *tags = &p->tags[set * MESH_PAGES_WAYS];
    size_t element = p->spool->element, in_page = (size_t)(i & (PAGE - 1)) * element;
    for (size_t way = 0; way < MESH_PAGES_WAYS; way++)
        if (tags[way] == page + 1)
            return p->pages + (set * MESH_PAGES_WAYS + way) * PAGE * element + in_page;
    const char *at = read_page(p, page, set);
    return at ? at + in_page : NULL;
}
