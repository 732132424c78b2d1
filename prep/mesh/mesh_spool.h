/* mesh_spool.h - a growing array of small elements, in memory while there is room, else in a
 * scratch file.
 *
 * One thread puts elements. When all are there, any number of threads may read. In memory they lie
 * in chunks of 2^MESH_SPOOL_LOG2 elements, in a file one after the other.
 */
#ifndef PREP_MESH_MESH_SPOOL_H
#define PREP_MESH_MESH_SPOOL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/file.h"
#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/base/work_folder.h"

enum { MESH_SPOOL_LOG2 = 14 };

typedef struct mesh_spool mesh_spool;
struct mesh_spool {
    mem *m;
    const char *beside;
    size_t element;        /* bytes */
    size_t ceiling;        /* bytes that m may have in use; above, no further chunk is held; 0:
                              any */
    mesh_spool *first_out; /* goes to its file before this spool does; may be NULL */
    uint64_t count;
    char **chunks;
    size_t chunk_count, chunk_room;
    out_file *file;    /* NULL: all is in memory */
    work_folder *work; /* where its file is kept for another run; NULL: nowhere */
    work_file which;
    out_file *copy; /* of a spool in memory: a file there that holds `copied` elements of it */
    uint64_t copied;
    const progress *p; /* asked while much is written or read; may be NULL */
};

/* mesh_spool_init() - an empty spool. beside: path beside which a scratch file may lie; kept by
 * reference. mesh_spool_release() - free everything; a zeroed struct is fine. */
void mesh_spool_init(mesh_spool *s, mem *m, const char *beside, size_t element, size_t ceiling);
void mesh_spool_release(mesh_spool *s);

/* mesh_spool_buffers() - least bytes that a spool holds while it grows. */
size_t mesh_spool_buffers(size_t element);

/* mesh_spool_append() - put elements behind the last one. mesh_spool_put() - put them from index
 * `at` on. Gaps are zeros until they are filled. */
CHECKED status mesh_spool_append(mesh_spool *s, const void *elements, size_t count);
CHECKED status mesh_spool_put(mesh_spool *s, uint64_t at, const void *elements, size_t count);

/* mesh_spool_spill() - move everything to a file, if it is not in one. */
CHECKED status mesh_spool_spill(mesh_spool *s);

/* Another run can go on with a spool whose file is in a work folder: call mesh_spool_keep_in() when
 * it is empty. Elements never change once they are saved.
 * mesh_spool_store() - write what is in memory alone to the file, before a state is saved.
 * mesh_spool_unstore() - empty the file again, which no state needs, if all is in memory.
 * mesh_spool_file() - that file, for work_folder_save().
 * mesh_spool_keep() - save how much it holds; or load that into an empty one: into memory where it
 * was, unless that is above the ceiling. ST_CORRUPT: its file is too short. */
void mesh_spool_keep_in(mesh_spool *s, work_folder *work, work_file which);
CHECKED status mesh_spool_store(mesh_spool *s);
void mesh_spool_unstore(mesh_spool *s);
out_file *mesh_spool_file(const mesh_spool *s);
CHECKED status mesh_spool_keep(mesh_spool *s, state_io *io);

static inline bool mesh_spool_held(const mesh_spool *s) {
    return !s->file;
}

/* mesh_spool_at() - element i < count of a spool held in memory. */
static inline const void *mesh_spool_at(const mesh_spool *s, uint64_t i) {
    return s->chunks[i >> MESH_SPOOL_LOG2] + (i & ((1u << MESH_SPOOL_LOG2) - 1)) * s->element;
}

/* mesh_spool_read() - copy elements [first, first + count), which must be below s->count. Many
 * threads may call this once nothing more is put. */
CHECKED status mesh_spool_read(mesh_spool *s, uint64_t first, size_t count, void *to);

/* mesh_spool_forget() - free memory of elements before this one, which are not read again. */
void mesh_spool_forget(mesh_spool *s, uint64_t before);

#endif
