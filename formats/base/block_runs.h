/* block_runs.h - many blocks of nearly one size, for any number of threads: in runs of 2 MiB, which
 * the system may back by one large page each.
 *
 * Blocks that come and go with treelets are too large for the allocator to keep, and too small for
 * large pages: each of their pages would be a page fault of its own. A run goes back to the system
 * when its last block is freed.
 *
 * Where runs do not pay, a block comes from the mem by itself: within a budget, which blocks that
 * nobody uses must not take up; where blocks are few or large, or a single one is of quite another
 * size; and where the address sanitizer watches what is read behind a block's end.
 */
#ifndef FORMATS_BASE_BLOCK_RUNS_H
#define FORMATS_BASE_BLOCK_RUNS_H

#include "formats/base/mem.h"

typedef struct block_runs block_runs;

/* block_runs_create() - for about `count` blocks, most of them of `bytes`, 1 or more. Runs count as
 * in use of m. */
CHECKED status block_runs_create(mem *m, size_t bytes, size_t count, block_runs **out);

/* block_runs_destroy() - all blocks must have been freed. NULL is fine. */
void block_runs_destroy(block_runs *s);

/* block_runs_alloc() - returns a block of `bytes`, 1 or more, aligned to 64 bytes; or NULL, as
 * mem_alloc() does. Thread-safe.
 * block_runs_free() - free a block that was allocated with as many bytes. Thread-safe. */
void *block_runs_alloc(block_runs *s, size_t bytes);
void block_runs_free(block_runs *s, void *block, size_t bytes);

#endif
