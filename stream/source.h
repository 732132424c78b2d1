/* source.h - where treelet payloads come from: backends that give the same bytes.
 *
 *   mapped  the file is mapped once; a load populates the treelet's pages with MADV_POPULATE_READ
 *           (which reports an error instead of raising SIGBUS). Raw payloads of grids are checked
 *           and used in place; an eviction gives their pages back with MADV_DONTNEED. All others
 *           are copied, checked and decoded in memory of our own; their pages are given back at
 *           once
 *   arena   a load reads (and decodes) into memory of our own
 *
 * The bytes of a file in memory (leaf_file_open_memory()) are checked and used in place like mapped
 * ones, if they are aligned to LEAF_ALIGN; otherwise the arena reads them.
 *
 * Another process may write to the file at any time. What was checked in memory of our own does not
 * change. Mapped bytes may change after their check, so no index, offset or count is read there:
 * samples and codes of a grid are only compared and computed with. A mesh's payloads hold indices,
 * and compressed ones hold sizes and offsets: these are copied first. volume_check_file() tells
 * whether the whole file has changed.
 *
 * Of a file between the steps of another (leaf_between.h), payloads are made in memory of our own,
 * from bytes that are read.
 *
 * Thread-safe: any number of loads at once, each with an unpacker of its own.
 */
#ifndef STREAM_SOURCE_H
#define STREAM_SOURCE_H

#include "formats/leaf/leaf_unpacker.h"

typedef enum source_kind { SOURCE_AUTO, SOURCE_MAPPED, SOURCE_ARENA } source_kind;

typedef struct source source;

/* Payloads in so many bytes of memory lie elsewhere now. */
typedef struct source_move {
    uintptr_t from;
    size_t bytes;
    ptrdiff_t by;
} source_move;

/* source_open() - AUTO means the mapping for raw payloads of grids, if m has no limit, the program
 * handles SIGBUS (bus_error.h) and the system maps the file; else the arena (stream/README.md says
 * why). The caller keeps the file,
 * which must outlive the source. */
CHECKED status source_open(mem *m, leaf_file *f, source_kind kind, source **out);
void source_close(source *s); /* NULL is fine */

/* source_load() - load and check payload p of the directory. u: this thread's, of the source's
 * file. *payload points at its bytes until source_evict(). The message of ST_CORRUPT names the
 * payload.
 */
CHECKED status source_load(source *s, uint32_t p, leaf_unpacker *u, const void **payload);
void source_evict(source *s, uint32_t p, const void *payload);

/* source_load_after() - the same of a payload that another set's, q, helps with
 * (leaf_file_helps()), given that one's bytes. */
CHECKED status source_load_after(source *s, uint32_t p, leaf_unpacker *u, uint32_t q,
                                 const void *from, const void **payload);

/* source_load_into() - the same, into memory of the caller's: leaf_layout_payload_bytes(p) bytes,
 * 64-byte aligned. */
CHECKED status source_load_into(source *s, uint32_t p, leaf_unpacker *u, void *payload);

/* source_read() - read `bytes` bytes of payload p from byte `from` on, without a check. For either
 * backend; leaf_file_is_raw() must be true of p. */
CHECKED status source_read(source *s, uint32_t p, uint32_t from, uint32_t bytes, void *to);

/* source_extend() - call it when the file has more segments (leaf_file_exchange()): map those, too.
 * Loaded payloads may then lie elsewhere: source_moved() returns where. Only while nothing is
 * loaded. On failure nothing has changed. */
CHECKED status source_extend(source *s, source_move *move);
static inline const void *source_moved(const source_move *move, const void *payload) {
    return (uintptr_t)payload - move->from < move->bytes ? (const uint8_t *)payload + move->by
                                                         : payload;
}

/* source_ahead() - ask the system to read the bytes of these payloads of leaf_file_stores(), which
 * will be loaded soon.
 * Does not wait for them. Sorts the list; a payload may occur more than once. */
void source_ahead(source *s, uint32_t payloads[], uint32_t count);

/* source_overhead_bytes() - returns the most memory of a loaded payload beside its bytes. */
size_t source_overhead_bytes(const source *s);

#endif
