/* mem.h - the one allocator: counted, budgeted, with a high-water mark.
 *
 * A `mem` is a budget that a job (a conversion, an open volume) passes to everything it creates.
 * Blocks are aligned to 64 bytes, for SIMD kernels and cache lines. All functions are thread-safe,
 * except where this is said.
 */
#ifndef FORMATS_BASE_MEM_H
#define FORMATS_BASE_MEM_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "formats/base/status.h"

typedef struct mem {
    atomic_size_t used; /* bytes in blocks not yet freed, book-keeping included */
    atomic_size_t peak; /* the most that `used` ever was */
    size_t limit;       /* bytes; 0: no limit */
    size_t lent;        /* bytes by which mem_lend_half() has lowered the limit */
    const struct file_guard_target *target; /* the job's target, see file_guard.h; NULL: none */
} mem;

void mem_init(mem *m, size_t limit);

/* mem_alloc(), mem_zalloc() - allocate size bytes (at least 1); mem_zalloc() zeroes them.
 * Return NULL when the budget or the system has no room. The description then says what was asked
 * for, and the caller returns ST_NOMEM. */
void *mem_alloc(mem *m, size_t size);
void *mem_zalloc(mem *m, size_t size);

/* mem_array() - count elements of size bytes each, zeroed; NULL on overflow too. */
void *mem_array(mem *m, size_t count, size_t size);

/* mem_grow() - make room for one more element behind the count elements of size bytes of an array.
 * array: the address of the pointer to it, NULL at first. *room: how many elements it has room for.
 * A full array moves to one of twice the room, at first `least`. ST_NOMEM: nothing has changed. */
CHECKED status mem_grow(mem *m, void *array, size_t size, size_t count, size_t least, size_t *room);

/* mem_copy_text() - a copy of a string, counted in the budget. */
char *mem_copy_text(mem *m, const char *text);

/* mem_free() - NULL is fine. */
void mem_free(mem *m, void *block);

/* mem_zlib_alloc(), mem_zlib_free() - zalloc and zfree of a z_stream whose opaque is a mem. */
void *mem_zlib_alloc(void *m, unsigned count, unsigned size);
void mem_zlib_free(void *m, void *block);

/* mem_reserve() - count bytes as in use that nobody has allocated: for a budget of its own that a
 * part of the job gets, beyond which that part does not go. False: the budget has no room; the
 * description says so. mem_unreserve() - end that. */
CHECKED bool mem_reserve(mem *m, size_t bytes);
void mem_unreserve(mem *m, size_t bytes);

/* mem_lend_half() - lower the limit by half, and return that half, for a process that helps; less
 * than half where so much is in use that a quarter of the rest would not be left.
 * mem_take_back() - raise it again, when that process has ended. Both only while a single thread
 * uses m. */
size_t mem_lend_half(mem *m);
void mem_take_back(mem *m, size_t lent);

/* mem_map() - map zeros, for memory that is counted elsewhere, from a multiple of MEM_LARGE_PAGE
 * on; in large pages where the system has them. NULL: it has no room. The caller unmaps it, in
 * whole. */
enum { MEM_LARGE_PAGE = 2 << 20 };
void *mem_map(size_t bytes);

/* mem_room() - whether the system would give this process so many bytes now, whatever the budgets
 * say. For libraries that fail without a reason. A signal handler may call it. */
bool mem_room(size_t bytes);

/* mem_used(), mem_peak() - bytes in use now, and at most so far. */
size_t mem_used(const mem *m);
size_t mem_peak(const mem *m);

#endif
