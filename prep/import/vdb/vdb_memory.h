/* vdb_memory.h - what C++ allocates in this program is counted in a budget.
 *
 * vdb_new.cpp replaces operator new, which OpenVDB and the standard library use, by one that asks
 * here first and throws std::bad_alloc when there is no room. Any thread.
 */
#ifndef PREP_IMPORT_VDB_VDB_MEMORY_H
#define PREP_IMPORT_VDB_VDB_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#else
#include "formats/base/mem.h"

/* vdb_memory_join() - from now on count in this budget, which what is allocated so far is added to.
 * NULL: in none, as at first; what is still allocated is taken from the budget. No other thread
 * allocates meanwhile. */
void vdb_memory_join(mem *m);
#endif

/* vdb_memory_take() - false: no room, which is noted (import_limits.h). */
bool vdb_memory_take(size_t bytes);
void vdb_memory_give(size_t bytes);

#ifdef __cplusplus
}
#endif
#endif
