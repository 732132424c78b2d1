/* chunk_cache.h - decoded chunks of an array (chunk_array.h), kept for several threads that read
 * boxes of it: a chunk is often larger than a box, and the boxes around it come soon.
 *
 * A chunk moves ABSENT -> MAKING -> READY, and back to ABSENT when it makes room. Threads that want
 * one in MAKING wait. One that is held stays. Of the others, the one not needed for longest goes.
 *
 * Memory: the cache has a budget of its own, taken from the job's: also chunks on their way, and
 * what their codecs need, stay within. Where one alone is more than what the cache may keep, chunks
 * are made one at a time, and none is kept.
 */
#ifndef FORMATS_GRID_CHUNK_CACHE_H
#define FORMATS_GRID_CHUNK_CACHE_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/chunk_array.h"

typedef struct chunk_cache chunk_cache;

/* chunk_cache_create() - *a must outlive it, and so must the table and the file of *in, which is
 * copied, with its paths. Takes a quarter of the room that m has left, at most 256 MiB, at least
 * what one chunk needs: ST_NOMEM. */
CHECKED status chunk_cache_create(mem *m, const chunk_array *a, const chunk_home *in,
                                  chunk_cache **out);
void chunk_cache_destroy(chunk_cache *c); /* NULL is fine */

const chunk_shape *chunk_cache_shape(const chunk_cache *c);

/* chunk_cache_gather() - chunk_array_gather() from the cache. read: the bytes that were read of
 * files are added. Thread-safe. */
CHECKED status chunk_cache_gather(chunk_cache *c, const uint32_t first[ORDER_AXES],
                                  const uint32_t end[ORDER_AXES], void *out, uint64_t *read);

#endif
