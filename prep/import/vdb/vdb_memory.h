/* vdb_memory.h - counts all C++ allocations of this program in a budget.
 *
 * vdb_new.cpp replaces operator new, which OpenVDB and the standard library use. It asks here
 * first, and throws std::bad_alloc if there is no room. Any thread.
 */
#ifndef PREP_IMPORT_VDB_VDB_MEMORY_H
#define PREP_IMPORT_VDB_VDB_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#else
#include "formats/base/mem.h"

/* vdb_memory_join() - count all allocations in this budget, also existing ones. NULL: count in no
 * budget, as at first; existing allocations are subtracted from the old one. No other thread may
 * allocate meanwhile. */
void vdb_memory_join(mem *m);
#endif

/* vdb_memory_take() - returns false if there is no room; this is noted (import_limits.h). */
bool vdb_memory_take(size_t bytes);
void vdb_memory_give(size_t bytes);

#ifdef __cplusplus
}
#endif
#endif
