/* mesh_pages.h - one thread's window on a spool, to read single elements wherever it is held.
 *
 * A spool in memory is read directly. Of a spool in a file, pages are cached: 4-way, and the oldest
 * page of a set is replaced.
 */
#ifndef PREP_MESH_MESH_PAGES_H
#define PREP_MESH_MESH_PAGES_H

#include <stddef.h>
#include <stdint.h>

#include "prep/mesh/mesh_spool.h"

enum { MESH_PAGES_LOG2 = 9, MESH_PAGES_WAYS = 4 }; /* elements per page; pages per set */

typedef struct mesh_pages {
    mesh_spool *spool;
    char *pages;
    uint64_t *tags; /* page number + 1; 0: empty */
    uint8_t *next;  /* per set: the way to replace next */
    uint32_t sets_log2;
    uint64_t first; /* element of the spool that is number 0 here; may be changed */
    status st;      /* of the last mesh_pages_at() that returned NULL */
} mesh_pages;

/* mesh_pages_least() - bytes of the smallest window on a spool in a file. mesh_pages_memory() -
 * bytes that a window takes of `room`. */
uint64_t mesh_pages_least(const mesh_spool *s);
uint64_t mesh_pages_memory(const mesh_spool *s, uint64_t room);

/* mesh_pages_init() - s: complete; room >= mesh_pages_least(s) unless it is held in memory. */
CHECKED status mesh_pages_init(mesh_pages *p, mesh_spool *s, uint64_t room);
void mesh_pages_release(mesh_pages *p); /* a zeroed struct is fine */

const void *mesh_pages_find(mesh_pages *p, uint64_t i);

/* mesh_pages_at() - element p->first + i < count, valid until the next call. NULL: it cannot be
 * read, see p->st. */
static inline const void *mesh_pages_at(mesh_pages *p, uint64_t i) {
    i += p->first;
    return mesh_spool_held(p->spool) ? mesh_spool_at(p->spool, i) : mesh_pages_find(p, i);
}

#endif
