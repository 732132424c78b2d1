/* treelet_cache.h - treelets that are resident and not drawn: of another isovalue, of another time
 * step.
 *
 * Found by id and set, given up oldest first. Holds nothing but links: no memory comes or goes.
 */
#ifndef STREAM_TREELET_CACHE_H
#define STREAM_TREELET_CACHE_H

#include "formats/base/mem.h"
#include "stream/treelet.h"

typedef struct treelet_cache {
    treelet **of; /* an id: the first of its list */
    treelet *oldest, *newest;
} treelet_cache;

/* treelet_cache_init() - for ids below count; NULL in *of when there is no memory. */
void treelet_cache_init(treelet_cache *s, mem *m, uint32_t count);
void treelet_cache_release(treelet_cache *s, mem *m);

/* treelet_cache_put() - as the newest. */
void treelet_cache_put(treelet_cache *s, treelet *tr);

/* treelet_cache_find() - the treelet of this id and set, or NULL; treelet_cache_remove() - take it
 * away. */
treelet *treelet_cache_find(const treelet_cache *s, uint32_t id, uint32_t set);
void treelet_cache_remove(treelet_cache *s, treelet *tr);

#endif
