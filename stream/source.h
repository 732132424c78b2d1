/* source.h - where treelet payloads come from: backends that give the same bytes.
 *
 *   mapped  the file is mapped once; a load populates the treelet's pages with MADV_POPULATE_READ
 *           (which reports an error instead of raising SIGBUS) and checks them; an eviction gives
 *           them back with MADV_DONTNEED; raw payloads of grids only. Of a file in memory
 *           (leaf_file_open_memory()): its bytes are checked and used in place, where they are
 *           aligned to LEAF_ALIGN
 *   arena   a load reads (and decompresses) into a buffer of our own
 *
 * Somebody may write to the file at any time. What the arena checked stays as it was. Mapped bytes
 * may change after the check, so nothing may follow an index, an offset or a count that it read
 * there: samples and codes of a grid are numbers to compare and to compute with, and no more. A
 * mesh's payloads hold indices, so they are always read by the arena. What became of the whole file
 * says volume_check_file().
 *
 * Thread-safe: any number of loads at once, each with a scratch of its own.
 */
#ifndef STREAM_SOURCE_H
#define STREAM_SOURCE_H

#include "formats/leaf/leaf_file.h"

typedef enum source_kind { SOURCE_AUTO, SOURCE_MAPPED, SOURCE_ARENA } source_kind;

typedef struct source source;

/* source_open() - AUTO is the arena (stream/README.md says why), but for raw payloads in memory;
 * MAPPED is the arena for a mesh. ST_UNSUPPORTED when mapped is asked for compressed payloads. The
 * file stays the caller's and must outlive the source. */
CHECKED status source_open(mem *m, leaf_file *f, source_kind kind, source **out);
void source_close(source *s); /* NULL is fine */

/* What a worker owns while it loads: room for compressed bytes. */
typedef struct source_scratch {
    void *stored;
} source_scratch;
CHECKED status source_scratch_init(source *s, source_scratch *scratch);
void source_scratch_release(source *s, source_scratch *scratch);

/* source_load() - make payload p (of the directory) resident and checked: *payload points at its
 * bytes until source_evict(). ST_CORRUPT names it. */
CHECKED status source_load(source *s, uint32_t p, source_scratch *scratch, const void **payload);
void source_evict(source *s, uint32_t p, const void *payload);

/* source_read() - bytes from `from` on of a payload that leaf_file_is_raw(), unchecked, by either
 * backend. */
CHECKED status source_read(source *s, uint32_t p, uint32_t from, uint32_t bytes, void *to);

/* source_overhead_bytes() - what a loaded payload costs at most beside its bytes. */
size_t source_overhead_bytes(const source *s);

#endif
