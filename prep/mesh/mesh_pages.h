/* mesh_pages.h - single elements of a spool, wherever it is: one thread's window on it.
 *
 * A spool held in memory is read directly. Of one in a file, pages are kept: a 4-way cache, the
 * oldest of a set going first.
 */
#ifndef PREP_MESH_MESH_PAGES_H
#define PREP_MESH_MESH_PAGES_H

#include <stddef.h>
#include <stdint.h>

#include "prep/mesh/mesh_spool.h"

enum { MESH_PAGES_LOG2 = 9, MESH_PAGES_WAYS = 4 }; /* elements of a page; pages of a set */

typedef struct mesh_pages {
    mesh_spool *spool;
    char *pages;
    uint64_t *tags; /* page number + 1; 0: empty */
    uint8_t *next;  /* of each set: the way to be replaced */
    uint32_t sets_log2;
    uint64_t first; /* of the spool, the element that is number 0 here; may be changed */
    status st;      /* of the last mesh_pages_at() that gave NULL */
} mesh_pages;

/* mesh_pages_least(), mesh_pages_memory() - bytes of the smallest window on a spool in a file;
 * bytes that a window with `room` at its disposal takes of it. */
uint64_t mesh_pages_least(const mesh_spool *s);
uint64_t mesh_pages_memory(const mesh_spool *s, uint64_t room);

/* mesh_pages_init() - s: ended; room >= mesh_pages_least(s) unless it is held in memory. */
CHECKED status mesh_pages_init(mesh_pages *p, mesh_spool *s, uint64_t room);
void mesh_pages_release(mesh_pages *p); /* zeroed is fine */

const void *mesh_pages_find(mesh_pages *p, uint64_t i);

/* mesh_pages_at() - element p->first + i < count, valid until the next call; NULL when it cannot be
 * read, see p->st. */
static inline const void *mesh_pages_at(mesh_pages *p, uint64_t i) {
    i += p->first;
    return mesh_spool_held(p->spool) ? mesh_spool_at(p->spool, i) : mesh_pages_find(p, i);
}

#endif
