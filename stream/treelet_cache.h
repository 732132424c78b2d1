/* treelet_cache.h - treelets in memory that are not drawn now: of another isovalue or time step.
 *
 * They are found by id and set, and evicted oldest first. The cache only links treelets: it neither
 * allocates nor frees them.
 */
#ifndef STREAM_TREELET_CACHE_H
#define STREAM_TREELET_CACHE_H

#include "formats/base/mem.h"
#include "stream/treelet.h"

typedef struct treelet_cache {
    treelet **of; /* per id: the first treelet of its list */
    treelet *oldest, *newest;
} treelet_cache;

/* treelet_cache_init() - make a cache for ids below count. s->of is NULL if there is no memory. */
void treelet_cache_init(treelet_cache *s, mem *m, uint32_t count);
void treelet_cache_release(treelet_cache *s, mem *m);

/* treelet_cache_put() - add a treelet as the newest. */
void treelet_cache_put(treelet_cache *s, treelet *tr);

/* treelet_cache_find() - returns the treelet of this id and set, or NULL. */
treelet *treelet_cache_find(const treelet_cache *s, uint32_t id, uint32_t set);

/* treelet_cache_remove() - unlink a treelet. */
void treelet_cache_remove(treelet_cache *s, treelet *tr);

#endif
