/* state_io.h - a job's state on its way to a file or back.
 *
 * A part of a job has one function that passes all of its state to state_io_bytes(), whichever way
 * it goes: so what is saved is what is loaded. The file holds numbers as this machine has them, and
 * is of no use to other programs.
 *
 *      0  64  head: magic, version, sequence, size, checksum of the rest, share, its own checksum
 *     64   .  the state
 */
#ifndef FORMATS_BASE_STATE_IO_H
#define FORMATS_BASE_STATE_IO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct state_io state_io;

/* Handles a part's state. */
typedef status (*state_io_part)(void *ctx, state_io *s);

/* What is known of a file without its state. */
typedef struct state_io_head {
    uint64_t sequence; /* the higher, the later it was saved */
    double share;      /* of the job that is done, 0 to 1 */
} state_io_head;

/* state_io_memory() - bytes that each of the calls below takes for a while. */
size_t state_io_memory(void);

/* state_io_look() - whether there is a whole and unchanged state in this file. Reads all of it. */
CHECKED status state_io_look(mem *m, const char *path, state_io_head *head, bool *found);

/* state_io_save() - write a state, over what the file holds, and wait until it is on the disk.
 * Until then, the file holds none. state_io_load() - read one that was found, or its beginning.
 * ST_CORRUPT: the part asks for more than was saved. */
CHECKED status state_io_save(mem *m, const char *path, const state_io_head *head,
                             state_io_part part, void *ctx);
CHECKED status state_io_load(mem *m, const char *path, state_io_part part, void *ctx);

/* state_io_loads() - which way it goes.
 * state_io_bytes() - save these bytes, or load as many.
 * state_io_end() - all has been passed: ST_CORRUPT if more was saved.
 * state_io_fault() - ST_CORRUPT: what was loaded makes no sense. */
bool state_io_loads(const state_io *s);
CHECKED status state_io_bytes(state_io *s, void *bytes, size_t size);
CHECKED status state_io_end(const state_io *s);
status state_io_fault(const state_io *s);

/* STATE_IO() - the same for a variable. */
#define STATE_IO(s, variable) state_io_bytes(s, &(variable), sizeof(variable))

#endif
