/* import_limits.h - limits memory and CPU time of an importer, its library included.
 *
 * Memory: by RLIMIT_DATA, not RLIMIT_AS. It counts all allocations, but neither mapped files nor
 * space that is only reserved (an allocator reserves 64 MiB per thread). Libraries allocate outside
 * of the budget of --memory: mostly little, at worst as much again for a block packed and unpacked.
 * So the limit is twice the budget and some more, on top of what the program has at its start.
 * Honest files never reach it, but what would fill the machine is stopped.
 *
 * Time: CPU time without a finished slice. Waiting for a pipe or a disk takes none. For another
 * limit, set RLIMIT_CPU (ulimit -t), which then applies to the whole import.
 */
#ifndef PREP_IMPORT_IMPORT_LIMITS_H
#define PREP_IMPORT_IMPORT_LIMITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Allowed CPU seconds without progress. Each MiB of opened files adds one: a library may read all
 * of it before the first slice. */
enum { IMPORT_SECONDS = 600 };

/* import_limits_begin() - budget: of --memory. seconds: IMPORT_SECONDS, or a test's own. */
void import_limits_begin(size_t budget, uint32_t seconds);

/* import_limits_progress() - restart the clock. import_limits_opened() - this many more bytes are
 * to be read. Any thread. */
void import_limits_progress(void);
void import_limits_opened(uint64_t bytes);

/* import_limits_refused() - allocators report that they refused so many bytes. Sizes that no
 * machine has are ignored: they are a file's fault. Any thread. */
void import_limits_refused(size_t bytes);

/* import_limits_short() - returns whether memory was refused before, or there is none now. *bytes:
 * the first size refused; 0: unknown. Safe in a signal handler. */
bool import_limits_short(size_t *bytes);

#endif
