/* mem.h - the one allocator: counted, budgeted, with a high-water mark.
 *
 * A `mem` is a budget that a job (a conversion, an open volume) hands to everything it creates.
 * Blocks are aligned to 64 bytes, as SIMD kernels and cache lines want. All functions are
 * thread-safe.
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
    size_t limit;       /* 0: no limit */
    size_t lent;        /* by which it is lower than at first */
    const struct file_guard_target *target; /* of the job, see file_guard.h; NULL: none */
} mem;

void mem_init(mem *m, size_t limit);

/* mem_alloc(), mem_zalloc() - size bytes (at least 1), the second zeroed.
 * NULL when the budget or the system has no room; the description says what was asked for, and the
 * caller returns ST_NOMEM. */
void *mem_alloc(mem *m, size_t size);
void *mem_zalloc(mem *m, size_t size);

/* mem_array() - count elements of size bytes each, zeroed; NULL on overflow too. */
void *mem_array(mem *m, size_t count, size_t size);

/* mem_grow() - room for one more behind the count elements of size bytes of an array that grows.
 * array: the address of the pointer to it, NULL at first; *room: for how many it has room. When it
 * is full it moves to one of twice the room, at first `least`. ST_NOMEM: all is as it was. */
CHECKED status mem_grow(mem *m, void *array, size_t size, size_t count, size_t least, size_t *room);

/* mem_copy_text() - a copy of a string in the budget. */
char *mem_copy_text(mem *m, const char *text);

/* mem_free() - NULL is fine. */
void mem_free(mem *m, void *block);

/* mem_zlib_alloc(), mem_zlib_free() - zalloc and zfree of a z_stream whose opaque is a mem. */
void *mem_zlib_alloc(void *m, unsigned count, unsigned size);
void mem_zlib_free(void *m, void *block);

/* mem_lend_half() - half of the limit, which is lower from now on, for a process that helps;
 * mem_take_back() - it has ended. By the thread that uses m alone. */
size_t mem_lend_half(mem *m);
void mem_take_back(mem *m, size_t lent);

/* mem_room() - whether the system would give this process so many bytes now, whatever the budgets
 * say: for libraries that fail without a reason. A signal's handler may call it. */
bool mem_room(size_t bytes);

/* mem_used(), mem_peak() - bytes now, and at most. */
size_t mem_used(const mem *m);
size_t mem_peak(const mem *m);

#endif
