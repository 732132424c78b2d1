/* leaf_unpacker.h - what one thread keeps while it loads payloads of a file: room for stored bytes,
 * decompressors, and the shells of the families that it met last. */
#ifndef FORMATS_LEAF_LEAF_UNPACKER_H
#define FORMATS_LEAF_LEAF_UNPACKER_H

#include "formats/leaf/leaf_file.h"

typedef struct leaf_unpacker leaf_unpacker;

/* leaf_unpacker_create() - for the payloads of f, which must outlive it. Raw files need none: NULL.
 */
CHECKED status leaf_unpacker_create(mem *m, leaf_file *f, leaf_unpacker **out);
void leaf_unpacker_destroy(leaf_unpacker *u); /* NULL is fine */

/* leaf_unpacker_memory() - bytes that one takes from m.
 * leaf_unpackers_create() - one for each of `count` threads. */
size_t leaf_unpacker_memory(const leaf_file *f);
CHECKED status leaf_unpackers_create(mem *m, leaf_file *f, int count, leaf_unpacker ***out);
void leaf_unpackers_destroy(mem *m, leaf_unpacker **list, int count); /* NULL is fine */

/* leaf_unpacker_take() - take the count of bytes of shells that were read since the last call. */
uint64_t leaf_unpacker_take(leaf_unpacker *u);

/* leaf_unpacker_room() - room for the stored bytes of any payload.
 * leaf_unpacker_decode() - decode payload p from its stored bytes, which were checked. shells: read
 * from the file, if need be. ST_CORRUPT names file, byte and payload. */
void *leaf_unpacker_room(leaf_unpacker *u);
CHECKED status leaf_unpacker_decode(leaf_unpacker *u, uint32_t p, const void *stored,
                                    void *payload);

#endif
