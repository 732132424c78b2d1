/* import_limits.h - how much memory and time an importer may take, its library included.
 *
 * Memory: RLIMIT_DATA, not RLIMIT_AS: it counts what is allocated, in all ways, and neither mapped
 * files nor room that is only set aside (an allocator sets aside 64 MiB a thread). Libraries
 * allocate beside the budget of --memory, mostly little, at worst as much again for a block packed
 * and unpacked; so the limit is twice the budget and some more on top of what the program has at
 * its start. It does not hold back honest files, but stops what would fill the machine.
 *
 * Time: CPU time without a slice done. Waiting for a pipe or a disk takes none. Whoever wants
 * another limit sets RLIMIT_CPU (ulimit -t), which is then of all of the import.
 */
#ifndef PREP_IMPORT_IMPORT_LIMITS_H
#define PREP_IMPORT_IMPORT_LIMITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Seconds of CPU without progress: some, and one for each MiB of what was opened, since a library
 * may read all of it before the first slice. */
enum { IMPORT_SECONDS = 600 };

/* import_limits_begin() - budget: of --memory. seconds: IMPORT_SECONDS, or what a test has. */
void import_limits_begin(size_t budget, uint32_t seconds);

/* import_limits_progress() - the time starts anew; import_limits_opened() - so many bytes more are
 * to be read. Any thread. */
void import_limits_progress(void);
void import_limits_opened(uint64_t bytes);

/* import_limits_refused() - by allocators: so many bytes were not given. Sizes that no machine has
 * are a file's fault, and do not count. Any thread. */
void import_limits_refused(size_t bytes);

/* import_limits_short() - whether memory was refused before, or there is none now; *bytes: the
 * first that was refused, 0: not known. A signal's handler may call it. */
bool import_limits_short(size_t *bytes);

#endif
