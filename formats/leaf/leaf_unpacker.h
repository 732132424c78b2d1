/* leaf_unpacker.h - what one thread keeps while it loads payloads of a file: room for stored bytes,
 * decompressors, and shells of families. */
#ifndef FORMATS_LEAF_LEAF_UNPACKER_H
#define FORMATS_LEAF_LEAF_UNPACKER_H

#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_shells.h"

typedef struct leaf_unpacker leaf_unpacker;

/* leaf_unpacker_create() - make one for the payloads of f, which must outlive it. *out is NULL for
 * a raw file, which needs none. leaf_unpacker_share() - the same, with shells (leaf_shells.h) that
 * several unpackers share and that must outlive them. NULL: it keeps its own, if f has any. */
CHECKED status leaf_unpacker_create(mem *m, leaf_file *f, leaf_unpacker **out);
CHECKED status leaf_unpacker_share(mem *m, leaf_file *f, leaf_shells *shells, leaf_unpacker **out);
void leaf_unpacker_destroy(leaf_unpacker *u); /* NULL is fine */

/* leaf_unpacker_memory() - bytes that one takes from m.
 * leaf_unpackers_create() - one for each of `count` threads. */
size_t leaf_unpacker_memory(const leaf_file *f);
CHECKED status leaf_unpackers_create(mem *m, leaf_file *f, int count, leaf_unpacker ***out);
void leaf_unpackers_destroy(mem *m, leaf_unpacker **list, int count); /* NULL is fine */

/* leaf_unpacker_take() - returns the bytes that were read besides payloads since the last call: of
 * shells, and in another file. */
uint64_t leaf_unpacker_take(leaf_unpacker *u);

/* leaf_file_bytes_outside() - returns how many bytes of another file loading payload p takes. */
uint64_t leaf_file_bytes_outside(const leaf_file *f, uint32_t p);

/* leaf_file_rows() - returns how many rows the treelets of level 0 lie in, if those of a row are
 * best loaded one after the other, as they need the same chunks of another file: without room to
 * keep a chunk, it is unpacked anew for each. 0: any order is as good.
 * leaf_file_row() - the row of the treelet with payload p. */
uint32_t leaf_file_rows(const leaf_file *f);
uint32_t leaf_file_row(const leaf_file *f, uint32_t p);

/* leaf_file_check_implied() - of an implied payload whose treelet lies in another file: read that,
 * and check that all samples are the one value. Others are fine. payload, u: as of
 * leaf_file_load(); payload has the implied bytes, and keeps them unless it fails. */
CHECKED status leaf_file_check_implied(leaf_file *f, uint32_t p, leaf_unpacker *u, void *payload);

/* leaf_file_load() - read payload p's stored bytes, check them, and decode them into payload.
 *
 * payload   leaf_layout_payload_bytes(p) bytes, 64-byte aligned
 * u         of this thread; NULL for a raw file
 *
 * Of a payload whose samples lie in another file (outside_samples.h), read and check those.
 *
 * ST_CORRUPT names file, byte and treelet. Before use, a mesh's topology must pass
 * mesh_leaf_check_loaded(), positions mesh_leaf_check_moved(). Thread-safe. */
CHECKED status leaf_file_load(leaf_file *f, uint32_t p, leaf_unpacker *u, void *payload);

/* Another way to the stored bytes than leaf_file_fetch(), with the same contract: checked, in
 * memory that nobody else writes to. Thread-safe. */
typedef struct leaf_fetcher {
    status (*fetch)(void *ctx, uint32_t p, void *stored);
    void *ctx;
} leaf_fetcher;

/* leaf_file_helps() - whether payload q of an earlier or later set, of a compressed grid, spares
 * reading some of what p needs.
 * leaf_file_load_after() - leaf_file_load_by() into memory that has payload q, complete. Of a file
 * between steps (leaf_between.h) any payload of the treelet; what comes of loading is to be made.
 */
bool leaf_file_helps(const leaf_file *f, uint32_t p, uint32_t q);
CHECKED status leaf_file_load_after(leaf_file *f, uint32_t p, leaf_unpacker *u,
                                    const leaf_fetcher *by, uint32_t q, void *payload);

/* leaf_file_load_by() - leaf_file_load() with stored bytes from `by`; NULL: leaf_file_fetch(). */
CHECKED status leaf_file_load_by(leaf_file *f, uint32_t p, leaf_unpacker *u, const leaf_fetcher *by,
                                 void *payload);

#endif
